"""Bytes of the protocol."""

import io
import struct

import numpy as np
import pytest
from PIL import Image

from splatline.view.outputs import Picture, SavedFile
from splatline.view.server.png import png_bytes
from splatline.view.server.protocol import file_bytes, picture_bytes

RGBA = np.random.default_rng(1).integers(0, 256, (5, 7, 4), np.uint8)


@pytest.mark.parametrize(("refined", "second"), [(False, False), (True, False), (True, True)])
def test_a_picture_is_a_header_and_raw_pixels(refined, second):
    data = picture_bytes(Picture(3, RGBA, refined, second), png=False)
    kind = 2 if second else 1
    assert struct.unpack("<8I", data[:32]) == (0x4C505330, kind, 3, 7, 5, 0, refined, 7 * 5 * 4)
    assert data[32:] == RGBA.tobytes()


def test_elsewhere_it_is_a_png_without_alpha():
    data = picture_bytes(Picture(1, RGBA, True), png=True)
    header = struct.unpack("<8I", data[:32])
    assert header[5:] == (1, 1, len(data) - 32)
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(data[32:]))), RGBA[..., :3])


@pytest.mark.parametrize("size", [(1, 1), (1, 300), (64, 3)])
def test_pngs_of_any_size_are_read(size):
    rgb = np.random.default_rng(2).integers(0, 256, (*size, 3), np.uint8)
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(png_bytes(rgb)))), rgb)


def test_a_file_has_kind_3():
    data = file_bytes(SavedFile("a.png", "image/png", b"12345"))
    assert struct.unpack("<8I", data[:32]) == (0x4C505330, 3, 0, 0, 0, 0, 0, 5)
    assert data[32:] == b"12345"
