"""Headers that promise more than the file holds, of every format."""

import gzip
import io
import resource
import struct
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.readers import read_cloud
from tests.host.files.cloud_files import COLOURS, POSITIONS
from tests.host.files.e57_files import colours, coordinates, e57
from tests.host.files.good_files import good_file
from tests.host.files.kinds import ply_of, read
from tests.host.files.las_files import las, laz
from tests.host.files.mesh_files import glb, obj, off, stl

XYZ = ["float x", "float y", "float z"]


def changed(data, place, form, value):
    """The bytes with a number at a place."""
    data = bytearray(data)
    struct.pack_into(form, data, place, value)
    return bytes(data)


def pcd_of(count="1", points="60", form="ascii", size="4"):
    return (
        f"FIELDS x y z a\nSIZE 4 4 4 {size}\nTYPE F F F U\nCOUNT 1 1 1 {count}\n"
        f"WIDTH {points}\nHEIGHT 1\nPOINTS {points}\nDATA {form}\n" + "1 2 3 4\n" * 40
    ).encode()


def lzf_bomb():
    head = pcd_of(points="100000000", form="binary_compressed").split(b"compressed\n")[0]
    return head + b"compressed\n" + np.array([40, 1_600_000_000], "<u4").tobytes() + bytes(40)


def npy_of(shape):
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        stream, {"shape": shape, "fortran_order": False, "descr": "<f8"}
    )
    return stream.getvalue() + bytes(240)


def npz_of(shape):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("points.npy", npy_of(shape))
    return stream.getvalue()


BOMBS = {
    "count.pcd": pcd_of(count="93144081"),
    "count_binary.pcd": pcd_of(count="93144081", form="binary"),
    "count_compressed.pcd": pcd_of(count="93144081", form="binary_compressed"),
    "points.pcd": pcd_of(points="9000000000"),
    "points_binary.pcd": pcd_of(points="9" * 30, form="binary"),
    "lzf.pcd": lzf_bomb(),
    "rows.ply": ply_of(10**12, XYZ),
    "rows_binary.ply": ply_of(10**12, XYZ, kind="binary_little_endian"),
    "digits.ply": ply_of("9" * 400, XYZ),
    "faces.ply": ply_of(1, XYZ).replace(
        b"end_header", b"element face 99999999999\nproperty list uchar int v\nend_header"
    ),
    "lists.ply": ply_of(2**31, [*XYZ, "list uint double a"], kind="binary_big_endian"),
    "shape.npy": npy_of((10**11, 3)),
    "wide.npy": npy_of((3, 10**11)),
    "negative.npy": npy_of((-5, 3)),
    "header.npy": b"\x93NUMPY\x02\x00\xff\xff\xff\xff" + bytes(200),
    "shape.npz": npz_of((10**11, 3)),
    "zeros.ply.gz": gzip.compress(bytes(1 << 27)),
    "count.pts": b"99999999999999\n1 2 3\n4 5 6\n",
    "rows.ptx": b"100000000\n100000000\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    b"1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 1 1 1\n",
    "rows.off": off().replace(b"\n8 6 0\n", b"\n99999999999 6 0\n"),
    "faces.off": off().replace(b"\n8 6 0\n", b"\n8 99999999999 0\n"),
    "corners.off": off().replace(b"\n4 0 1 3 2\n", b"\n99999999999 0 1 3 2\n"),
    "index.off": off().replace(b"\n4 0 1 3 2\n", b"\n4 0 1 3 99999999999\n"),
    "index.obj": obj().replace(b"f 1 2 4\n", b"f 1 2 99999999999\n"),
    "faces.stl": changed(stl(), 80, "<I", 0xFFFFFFFF),
    "count.glb": glb(count=10**11),
    "rows.las": changed(las(7), 247, "<Q", 1 << 40),
    "rows_short.las": changed(las(0), 107, "<I", 0xFFFFFFFF),
    "start.las": changed(las(7), 96, "<I", 0xFFFFFFF0),
    "records.las": changed(las(7), 100, "<I", 0xFFFFFFFF),
    "rows.laz": changed(laz(las(7)), 247, "<Q", 1 << 40),
    "rows.e57": e57(coordinates(POSITIONS) | colours(COLOURS), count=10**12),
}


@pytest.fixture(scope="module", autouse=True)
def _readers(tmp_path_factory):
    """Libraries that are loaded at first use take memory of their own."""
    for suffix in (".glb", ".laz", ".e57"):
        read_cloud(good_file(tmp_path_factory.mktemp("good"), suffix))


@pytest.mark.parametrize("name", BOMBS)
def test_a_promise_that_the_file_does_not_hold_takes_no_memory(tmp_path, name):
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[0]
    now = int(pages) * resource.getpagesize()
    before = time.process_time()
    resource.setrlimit(resource.RLIMIT_AS, (now + (200 << 20), hard))
    try:
        with pytest.raises(InputError) as caught:
            read(tmp_path, name, BOMBS[name])
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
    assert time.process_time() - before < 1.0
    message = str(caught.value)
    assert "\n" not in message
    assert "memory" not in message
    assert any(word in message for word in ("damaged", "truncated"))
