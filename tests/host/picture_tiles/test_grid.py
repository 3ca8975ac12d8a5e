"""Where the tiles of a picture lie."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from splatline.contract.errors import InputError
from splatline.contract.presets import PAPER
from splatline.contract.variants import CONFIGS
from splatline.host.encode.sort_by_line import PERIOD
from splatline.host.encode.tile import GUARD_COLUMNS, GUARD_LINES, HEM, whole_image
from splatline.host.picture_tiles.grid import MOST_SIDE, Grid


@given(
    st.integers(1, 400),
    st.integers(1, 300),
    st.sampled_from([48, 64, 80, 512]),
    st.integers(GUARD_LINES + 1, 90),
)
def test_each_pixel_is_in_one_tile_and_frames_begin_at_whole_periods(width, height, across, down):
    grid = Grid.of(width, height, PAPER, (across, down))
    seen = np.zeros((height, width), int)
    for number in range(grid.rows):
        row = grid.row(number)
        assert len(row) == grid.columns
        for tile in row:
            assert tile.origin_x % PERIOD == 0
            assert tile.size[0] <= across
            assert tile.size[1] <= down
            seen[tile.place] += 1
            frame = np.zeros(tile.size[::-1])
            assert seen[tile.place].shape == frame[tile.own].shape
    assert (seen == 1).all()


def test_a_guard_band_holds_what_begins_beside_a_tile():
    """A word reaches seven columns and three lines further. Both tiles have a hem there."""
    assert GUARD_COLUMNS >= 2 * HEM + 7
    assert GUARD_COLUMNS % PERIOD == 0
    assert GUARD_LINES >= 2 * HEM + 3


@pytest.mark.parametrize("name", ["paper", "wide2048", "plane-4096"])
def test_tiles_are_as_wide_as_the_engine_and_of_bounded_height(name):
    config = CONFIGS[name]
    grid = Grid.of(16384, 16384, config, None)
    assert (grid.frame_width, grid.frame_height) == (config.max_width, 512)


def test_a_picture_that_fits_is_one_tile_without_a_guard_band():
    grid = Grid.of(512, 300, PAPER, None)
    assert (grid.rows, grid.columns) == (1, 1)
    assert grid.row(0) == [whole_image(512, 300)]


@pytest.mark.parametrize(
    ("size", "frame_size", "message"),
    [
        ((MOST_SIDE + 1, 5), None, "at most 65536 pixels"),
        ((600, 600), (1024, 512), "does not fit paper"),
        ((600, 600), (40, 512), "no room for a guard band"),
        ((600, 600), (32, 512), "no room for a guard band"),
        ((600, 600), (512, 24), "no room for a guard band"),
    ],
)
def test_grids_that_cannot_be_are_refused(size, frame_size, message):
    with pytest.raises(InputError, match=message):
        Grid.of(*size, PAPER, frame_size)
