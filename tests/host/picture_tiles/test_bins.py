"""The splats of a tile: all that give it a word are among them."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from splatline.contract.presets import PAPER, PLANE
from splatline.host.encode.encode import encode
from splatline.host.picture_tiles.bins import bins_of_row
from splatline.host.picture_tiles.grid import Grid
from splatline.host.visibility.splats import SPLAT, Splats
from splatline.host.visibility.view import View

WIDTH, HEIGHT = 300, 170


def random_splats(seed, focal, largest):
    """Splats in and about a picture, most of them small, at any slant, in three chunks."""
    rng = np.random.default_rng(seed)
    data = np.zeros(150, SPLAT)
    data["column"] = rng.uniform(-30, WIDTH + 30, 150)
    data["line"] = rng.uniform(-30, HEIGHT + 30, 150)
    some = rng.random(150) < 0.5  # near the borders of tiles
    data["column"][some] = rng.integers(0, 20, some.sum()) * 8 + rng.uniform(-9, 9, some.sum())
    data["diameter"] = np.exp(rng.uniform(np.log(0.2), np.log(largest), 150))
    data["slope_x"], data["slope_y"] = rng.normal(0, 2, (2, 150))
    data["depth"] = rng.uniform(1, 3, 150)
    data["look"] = rng.integers(0, 1 << 20, 150)
    cuts = np.array([0, 40, 40, 150])
    nearest = np.array([1.0, np.inf, 1.0])
    return Splats(data, cuts[:-1], cuts[1:], nearest, (1.0, 3.0), {})


def words_of(encoded):
    words, lines = encoded.together()
    rows = words[:, np.newaxis] if words.ndim == 1 else words
    return sorted(tuple(row) for row in np.column_stack([rows, lines]).tolist())


@example(3, 60.0, 900.0, "exact", True)  # a disc that reaches far beyond its radius
@example(3, 60.0, 900.0, "plane", True)
@settings(max_examples=50)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([60.0, 300.0, 5000.0]),
    st.sampled_from([8.0, 40.0, 900.0]),
    st.sampled_from(["exact", "fast", "paper", "plane"]),
    st.booleans(),
)
def test_a_tile_has_the_words_that_all_splats_would_give_it(seed, focal, largest, quality, nearest):
    splats = random_splats(seed, focal, largest)
    view = View(np.zeros(3), np.eye(3), focal, WIDTH, HEIGHT, 0.01)
    config, quality = (PLANE, "exact") if quality == "plane" else (PAPER, quality)
    grid = Grid.of(WIDTH, HEIGHT, config, (64, 48))
    options = {"nearest_pixel": nearest}
    total = 0
    for number in range(grid.rows):
        for own in bins_of_row(splats, view, grid, number):
            here = words_of(encode(own.splats, view, config, quality, tile=own.tile, **options))
            assert here == words_of(encode(splats, view, config, quality, tile=own.tile, **options))
            assert (splats.data[own.slots] == own.splats.data).all()
            total += len(here)
    assert total >= sum(encode(splats, view, config, quality, **options).counts.ravel())


def test_a_row_without_splats_has_empty_bins():
    view = View(np.zeros(3), np.eye(3), 300.0, WIDTH, HEIGHT, 0.01)
    grid = Grid.of(WIDTH, HEIGHT, PAPER, (64, 48))
    splats = random_splats(1, 300.0, 1.0)
    splats.data["line"] = 20.0
    bins = bins_of_row(splats, view, grid, 3)
    assert [len(own.splats) for own in bins] == [0] * grid.columns


@pytest.mark.parametrize("diameter", [0.5, 6.0])
def test_a_small_splat_away_from_borders_is_in_one_tile_alone(diameter):
    view = View(np.zeros(3), np.eye(3), 300.0, WIDTH, HEIGHT, 0.01)
    grid = Grid.of(WIDTH, HEIGHT, PAPER, (64, 48))
    splats = random_splats(1, 300.0, 1.0)
    splats.data["column"], splats.data["line"] = 24.0, 12.0
    splats.data["diameter"] = diameter
    counts = [len(own.splats) for number in range(grid.rows)
              for own in bins_of_row(splats, view, grid, number)]  # fmt: skip
    assert sum(counts) == len(splats)
