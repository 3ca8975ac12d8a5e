"""A PNG written by rows, read by Pillow."""

import zlib

import numpy as np
import png
import pytest
from PIL import Image

from splatline.contract.errors import InputError
from splatline.plots import png_rows as png_rows_module
from splatline.plots.png_rows import pack_band, png_rows


@pytest.mark.parametrize("cuts", [[40], [1, 2, 39], [13, 13, 14]])
@pytest.mark.parametrize("grey", [False, True])
def test_rows_in_any_parts_are_the_picture(tmp_path, cuts, grey):
    rng = np.random.default_rng(1)
    shape, most, kind = ((40, 30), 65536, np.uint16) if grey else ((40, 30, 3), 256, np.uint8)
    picture = rng.integers(0, most, shape).astype(kind)
    with png_rows(tmp_path / "a.png", 30, 40, grey=grey) as rows:
        for part in np.split(picture, np.cumsum(cuts)):
            if len(part):
                rows.write(pack_band(part))
        assert not (tmp_path / "a.png").exists()
    assert np.array_equal(np.asarray(Image.open(tmp_path / "a.png")), picture)
    _, _, lines, _ = png.Reader(
        bytes=(tmp_path / "a.png").read_bytes()
    ).read()  # it tests the checksum
    assert np.array_equal(np.vstack(list(lines)).reshape(shape), picture)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


@pytest.mark.parametrize("lengths", [(0, 5), (7, 0), (1, 1), (70_000, 3), (5, 400_000)])
def test_the_checksum_of_bands_is_that_of_all_rows(lengths):
    one, other = (np.random.default_rng(n).bytes(n) for n in lengths)
    joined = png_rows_module._joined_adler(zlib.adler32(one), zlib.adler32(other), len(other))
    assert joined == zlib.adler32(one + other)


def test_a_picture_that_is_not_finished_leaves_the_old_file(tmp_path):
    path = tmp_path / "a.png"
    path.write_bytes(b"old")
    with pytest.raises(ZeroDivisionError), png_rows(path, 30, 40) as rows:
        rows.write(pack_band(np.zeros((5, 30, 3), np.uint8)))
        raise ZeroDivisionError
    assert path.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.png"]


def test_a_full_disc_is_one_line():
    noise = np.random.default_rng(2).integers(0, 256, (400, 300, 3)).astype(np.uint8)
    with (
        pytest.raises(InputError, match=r"/dev/full: cannot be written: No space left"),
        png_rows("/dev/full", 300, 400) as rows,
    ):
        rows.write(pack_band(noise))


def test_errors_of_others_are_not_taken_for_the_file_s(tmp_path):
    with pytest.raises(FileNotFoundError), png_rows(tmp_path / "a.png", 3, 4):
        (tmp_path / "other").read_bytes()
    assert not list(tmp_path.iterdir())
