"""A cloud, and how it is written in every format."""

import numpy as np
import pytest
from plyfile import PlyData, PlyElement
from pypcd4 import PointCloud

COUNT = 60
RNG = np.random.default_rng(1)
POSITIONS = RNG.normal(size=(COUNT, 3)).astype(np.float32)
NORMALS = RNG.normal(size=(COUNT, 3)).astype(np.float32)
NORMALS /= np.linalg.norm(NORMALS, axis=1, keepdims=True)
COLOURS = RNG.integers(2, 256, (COUNT, 3), np.uint8)

FACES = {
    "triangles": [[0, 1, 2], [2, 3, 4]],
    "mixed": [[0, 1, 2], [2, 3, 4, 5]],
}


def places(cloud):
    return cloud.positions + cloud.origin


def assert_is_the_cloud(cloud):
    """What every format must give back of POSITIONS, NORMALS and COLOURS."""
    assert places(cloud) == pytest.approx(POSITIONS.astype(float), abs=1e-6)
    assert cloud.normals == pytest.approx(NORMALS, abs=1e-6)
    assert np.array_equal(cloud.colours, COLOURS)
    assert not cloud.two_sided.any()
    assert cloud.dropped == {"non_finite": 0}
    assert cloud.positions.dtype == np.float64
    assert cloud.normals.dtype == np.float32
    assert cloud.colours.dtype == np.uint8


def vertices(positions=POSITIONS, normals=NORMALS, colours=COLOURS):
    names = [(name, positions.dtype) for name in "xyz"]
    columns = list(positions.T)
    if normals is not None:
        names += [(name, "f4") for name in ("nx", "ny", "nz")]
        columns += list(normals.T)
    if colours is not None:
        names += [(name, colours.dtype) for name in ("red", "green", "blue")]
        columns += list(colours.T)
    rows = np.empty(len(positions), names)
    for (name, _), column in zip(names, columns, strict=True):
        rows[name] = column
    return rows


def write_ply(path, rows=None, *, faces=None, text=False, byte_order="<"):
    elements = [PlyElement.describe(vertices() if rows is None else rows, "vertex")]
    if faces is not None:
        listed = np.empty(len(faces), [("vertex_indices", object)])
        listed["vertex_indices"] = [np.array(face, np.int32) for face in faces]
        elements.append(PlyElement.describe(listed, "face"))
    PlyData(elements, text=text, byte_order="=" if text else byte_order).write(str(path))
    return path


def write_pcd(path, encoding):
    packed = COLOURS.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
    fields = ("x", "y", "z", "normal_x", "normal_y", "normal_z", "rgb")
    columns = [*POSITIONS.T, *NORMALS.T, packed]
    types = (*[np.float32] * 6, np.uint32)
    PointCloud.from_points(columns, fields, types).save(path, encoding)
    return path


def write_text(path, *columns, header="", delimiter=" "):
    np.savetxt(path, np.column_stack(columns), "%.9g", delimiter, header=header, comments="")
    return path
