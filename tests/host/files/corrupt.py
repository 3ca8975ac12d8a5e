"""Whole cloud files of every format, and ways to corrupt them."""

import gzip
import io
import random
import zipfile
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from pypcd4 import Encoding

from tests.host.files.cloud_files import (
    COLOURS,
    FACES,
    NORMALS,
    POSITIONS,
    write_pcd,
    write_ply,
    write_text,
)
from tests.host.files.e57_files import colours, coordinates, e57, paged, unpaged
from tests.host.files.gaussian_files import gaussians, ply_bytes
from tests.host.files.kinds import compressed_pcd, ptx
from tests.host.files.las_files import las, las_with_normals, laz
from tests.host.files.mesh_files import COLOURS as MESH_COLOURS
from tests.host.files.mesh_files import CORNERS, glb, obj, off, stl, text_stl, textured_obj

WORDS = (
    b"nan -nan(ind) inf 1e39 -1 0 1 99999999999 4294967295 2147483648 property element list uchar"
    b" double float int ascii binary binary_compressed COUNT SIZE TYPE POINTS x rgb nx _ , ; # //"
    b' " \0 \xff \xef\xbb\xbf'
).split(b" ")
BLANKS = (b"\n", b"\r", b" ", b"\t", b"\r\n")


@dataclass(frozen=True)
class Sample:
    """A whole file.

    Parameters
    ----------
    name
        Its name, with the suffix of its format.
    data
        Its bytes, before they are packed.
    header
        Number of the bytes that say what the others are.
    packed
        ``gzip``, ``zip``, ``e57`` (pages with checksums), or nothing.
    """

    name: str
    data: bytes
    header: int
    packed: str = ""

    def pack(self, data: bytes) -> bytes:
        """Return the bytes of the file."""
        if self.packed == "gzip":
            return gzip.compress(data, 1)
        if self.packed == "e57":
            return paged(data)
        if self.packed == "zip":
            stream = io.BytesIO()
            with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
                archive.writestr("points.npy", data)
                archive.writestr("rgb.npy", array_bytes(COLOURS))
            return stream.getvalue()
        return data


def array_bytes(array) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def whole_files() -> list[Sample]:
    """Return a file of every kind that is read."""
    found = []
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a"

        def add(name, end, packed=""):
            data = path.read_bytes()
            found.append(Sample(name, data, data.index(end) + len(end) if end else 40, packed))

        for kind in ({"text": True}, {"byte_order": "<"}, {"byte_order": ">"}):
            for faces in (None, "triangles", "mixed"):
                write_ply(path, faces=FACES.get(faces), **kind)
                add("a.ply", b"end_header\n")
        add("a.ply.gz", b"end_header\n", "gzip")
        for encoding in (Encoding.ASCII, Encoding.BINARY):
            write_pcd(path, encoding)
            add("a.pcd", encoding.value.encode() + b"\n")
        path.write_bytes(compressed_pcd())
        add("a.pcd", b"compressed\n")
        write_text(path, POSITIONS)
        for name in ("a.xyz", "a.txt", "a.asc"):
            add(name, b"")
        add("a.xyz.gz", b"", "gzip")
        write_text(path, POSITIONS, NORMALS)
        add("a.xyzn", b"")
        write_text(path, POSITIONS, COLOURS)
        add("a.xyzrgb", b"")
        write_text(path, POSITIONS, COLOURS, header="//X Y Z R G B")
        add("a.txt", b"\n")
        write_text(path, POSITIONS, COLOURS, header='"x [m]";"y [m]";"z [m]";r;g;b', delimiter=";")
        add("a.csv", b"\n")
        write_text(path, POSITIONS, NORMALS, COLOURS, header="x,y,z,nx,ny,nz,r,g,b", delimiter=",")
        add("a.csv", b"\n")
        write_text(path, POSITIONS, np.arange(60), COLOURS, header="60")
        add("a.pts", b"\n")
        path.write_bytes(path.read_text().encode("utf-16"))
        add("a.txt", b"")
    found += [Sample("a.las", las(form), 375) for form in (0, 3, 7)]
    found += [Sample("a.laz", laz(data), 900) for data in (las(3), las(8), las_with_normals())]
    splats = ply_bytes(gaussians(opacity=np.full(60, 5.0)))
    found.append(Sample("a.ply", splats, splats.index(b"end_header") + 11))
    found += [Sample("a.obj", obj(MESH_COLOURS), 60), Sample("a.obj", textured_obj(), 60)]
    found += [
        Sample("a.stl", stl(), 84),
        Sample("a.stl", text_stl(), 60),
        Sample("a.off", off(), 20),
    ]
    meshes = glb(), glb(colours=MESH_COLOURS, normals=CORNERS)
    found += [Sample("a.glb", data, data.index(b"BIN")) for data in meshes]
    grid = ptx(POSITIONS, np.arange(60), COLOURS).encode()
    found += [Sample("a.ptx", grid, 100), Sample("a.ptx.gz", grid, 100, "gzip")]
    scan = e57(coordinates(POSITIONS) | colours(COLOURS))
    found += [Sample("a.e57", scan, 48), Sample("a.e57", unpaged(scan), 80, "e57")]
    rows = np.empty(len(POSITIONS), [(name, "f4") for name in "xyz"])
    for name, column in zip("xyz", POSITIONS.T, strict=True):
        rows[name] = column
    arrays = (POSITIONS, rows, np.hstack([POSITIONS, COLOURS]))
    found += [Sample("a.npy", array_bytes(array), 128) for array in arrays]
    found.append(Sample("a.npz", array_bytes(POSITIONS), 128, "zip"))
    packed = found[-1].pack(found[-1].data)
    found.append(Sample("a.npz", packed, 60))
    # The end of an archive is its table of contents.
    found.append(Sample("a.npz", packed, len(packed)))
    return found


def corrupt(sample: Sample, rng: random.Random, in_header: bool) -> bytes:
    """Return the sample's file with one to four faults."""
    data = bytearray(sample.data)
    end = min(sample.header, len(data)) if in_header else len(data)
    for _ in range(rng.choice((1, 1, 2, 4))):
        end = max(1, min(end, len(data)))
        if not data:
            break
        place = rng.randrange(min(end, len(data)))
        length = rng.choice((1, 1, 2, 4, 16, 200))
        rng.choice(FAULTS)(data, place, length, rng)
    return sample.pack(bytes(data))


def _flip(data, place, length, rng):
    data[place] ^= 1 << rng.randrange(8)


def _random_bytes(data, place, length, rng):
    data[place : place + length] = rng.randbytes(min(length, len(data) - place))


def _delete(data, place, length, rng):
    del data[place : place + length]


def _repeat(data, place, length, rng):
    data[place:place] = data[place : place + length] * rng.choice((1, 1, 3))


def _cut(data, place, length, rng):
    del data[place:]


def _word(data, place, length, rng):
    data[place : place + rng.choice((0, 1, 4))] = rng.choice((*WORDS, *BLANKS))


def _digits(data, place, length, rng):
    """Change a number that is written in digits."""
    digits = [i for i in range(place, min(place + 60, len(data))) if 48 <= data[i] <= 57]
    if digits:
        place = rng.choice(digits)
        data[place : place + 1] = rng.choice((b"9", b"0", b"99999", b"-1", b"12345678901", b""))


def _move(data, place, length, rng):
    piece = bytes(data[place : place + length])
    del data[place : place + length]
    other = rng.randrange(len(data) + 1)
    data[other:other] = piece


FAULTS = (_flip, _random_bytes, _delete, _repeat, _cut, _word, _digits, _move)
