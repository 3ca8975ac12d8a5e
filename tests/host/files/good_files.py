"""A whole file of any format."""

import numpy as np
from pypcd4 import Encoding

from tests.host.files.cloud_files import (
    COLOURS,
    NORMALS,
    POSITIONS,
    write_pcd,
    write_ply,
    write_text,
)
from tests.host.files.e57_files import colours, coordinates, e57
from tests.host.files.kinds import ptx
from tests.host.files.las_files import las, laz
from tests.host.files.mesh_files import glb, obj, off, stl

MADE = {
    ".las": lambda: las(7),
    ".laz": lambda: laz(las(7)),
    ".ptx": lambda: ptx(POSITIONS, NORMALS[:, 0], COLOURS).encode()[:-1],
    ".obj": lambda: obj()[:-1],
    ".stl": stl,
    ".off": off,
    ".glb": glb,
    ".e57": lambda: e57(coordinates(POSITIONS) | colours(COLOURS)),
}


def good_file(folder, suffix):
    """A whole file of any format, with no line end that a text could lose unnoticed."""
    path = folder / f"whole{suffix}"
    if suffix in MADE:
        path.write_bytes(MADE[suffix]())
    elif suffix == ".ply":
        write_ply(path)
    elif suffix == ".pcd":
        write_pcd(path, Encoding.BINARY)
    elif suffix == ".npz":
        np.savez_compressed(path, points=POSITIONS, normals=NORMALS)
    else:
        write_text(path, POSITIONS, NORMALS)
    return path
