"""The words of a tile: those of the whole image that touch it, moved to its frame."""

import numpy as np
import pytest

from splatline.contract.presets import RGB24
from splatline.host.encode.encode import encode
from splatline.host.encode.tile import HEM, Tile, first_part
from splatline.host.visibility.splats import SPLAT, Splats
from splatline.host.visibility.view import View
from splatline.sim import golden

WIDTH, HEIGHT = 400, 200

TILES = [Tile(0, 0, 64, 40), Tile(48, 32, 112, 72), Tile(96, 0, 160, 40), Tile(336, 160, 400, 200)]


def dense(count=120_000):
    """Splats of five to nine pixels, everywhere."""
    rng = np.random.default_rng(6)
    data = np.zeros(count, SPLAT)
    data["column"] = rng.uniform(-4, WIDTH + 4, count)
    data["line"] = rng.uniform(-4, HEIGHT + 4, count)
    data["diameter"] = rng.uniform(5.0, 9.0, count)
    data["slope_x"], data["slope_y"] = rng.normal(0, 0.3, (2, count))
    data["depth"] = rng.uniform(1, 3, count)
    data["look"] = np.arange(count) % (1 << 21)
    return Splats.of(data)


def found(quality, tile=None):
    """Words without X, with columns and lines of the whole image, and rows of their blocks."""
    view = View(np.zeros(3), np.eye(3), 800.0, WIDTH, HEIGHT, 0.01)
    words, lines = encode(dense(), view, RGB24, quality, tile=tile).together()
    fields = golden.decode(words, RGB24)
    first, last = golden.block_rows(fields)
    bare = words & ~np.uint64(RGB24.x.mask << RGB24.x.lsb)
    x, y = (tile.origin_x, tile.origin_y) if tile else (0, 0)
    assert (lines >= 0).all()
    return bare, fields["x"].astype(int) + x, lines.astype(int) + y, first, last


def keys(bare, columns, lines):
    return set(zip(bare.tolist(), columns.tolist(), lines.tolist(), strict=True))


@pytest.mark.parametrize("tile", TILES)
@pytest.mark.parametrize("quality", ["exact", "fast", "paper"])
def test_each_word_with_a_pixel_in_a_tile_is_in_its_frame(quality, tile):
    bare, columns, lines, first, last = found(quality)
    # What the frame draws whole begins a hem before the tile's own pixels, and ends with the frame.
    left, top = (max(place.start - HEM, 0) for place in tile.place[::-1])
    rows = lines[:, np.newaxis] - 4 + np.arange(8)
    across = (columns[:, np.newaxis] + last >= left) & (columns[:, np.newaxis] + first < tile.right)
    touches = (first <= last) & across & (top <= rows) & (rows < tile.bottom)
    wanted = touches.any(axis=1)
    if left:  # words that reach as far as can be are tested too
        assert (wanted & (columns == left - 7)).any()
    if top and quality != "exact":
        assert (wanted & (lines == top - 3)).any()
    own = found(quality, tile)
    here = keys(*own[:3])
    assert keys(bare[wanted], columns[wanted], lines[wanted]) <= here
    assert here <= keys(bare, columns, lines)
    assert (own[1] < tile.right).all()
    # No word is sent whose block does not touch it.
    assert (own[1] >= left - 7).all()
    assert ((own[2] >= top - 3) & (own[2] < tile.bottom + 4)).all()


@pytest.mark.parametrize("length", [1, 3, 8])
def test_the_first_part_is_the_one_that_reaches(length):
    for least in range(-5, 40):
        parts = [start for start in range(2, 80, length) if start + length > least]
        assert first_part(2, length, least) == parts[0]
