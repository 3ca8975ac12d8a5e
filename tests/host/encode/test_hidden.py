"""What is left out as hidden, with a depth pyramid made by hand: never too much, and enough."""

import dataclasses

import numpy as np
import pytest

from splatline.contract.config import BLOCK, ROWS
from splatline.contract.presets import PAPER, PLANE
from splatline.host.encode import encode as encode_module
from splatline.host.encode import encode_planes as encode_planes_module
from splatline.host.encode.splat_loop import DRAWN, HIDDEN
from splatline.host.visibility.footprint import FLAT
from splatline.host.visibility.occlusion import Pyramid
from splatline.host.visibility.view import View
from tests.support.splats import picture_of, splats_of

WIDTH, HEIGHT = 64, 48
ROWS_OF_CELLS, CELLS_OF_ROW = HEIGHT // ROWS, WIDTH // BLOCK
LIMITS = 0.5, 2.0
SIZES = [(2.6, 90.0), (12.0, 3000.0), (40.0, 1e5)]
"""Largest diameter, and a focal length at which few of them are seen in perspective. Those that are
count as visible."""
CASES = [(PAPER, quality) for quality in ("paper", "fast", "exact")] + [(PLANE, "exact")]


def view_of(focal):
    return View(np.zeros(3), np.eye(3), focal, WIDTH, HEIGHT, 0.01)


def is_hidden(splat, view, config, quality, bound, monkeypatch):
    """Return whether the encoder leaves a splat out that is behind these bounds."""
    bound = np.asarray(bound, np.int32)
    coarse = bound.max(keepdims=True).repeat(2, 0)  # 12 x 8 cells are 2 x 1 groups

    def made_by_hand(*_):
        return Pyramid(bound, np.zeros(bound.shape, np.uint32), bound.copy(), coarse)

    for module in (encode_module, encode_planes_module):
        monkeypatch.setattr(module, "new_pyramid", made_by_hand)
    marks = np.zeros(1, np.uint8)
    found = encode_module.encode(
        splat, view, config, quality, nearest_pixel=True, skip_hidden=True, marks=marks
    )
    drawn = DRAWN if found.elements else 0
    assert marks[0] == (HIDDEN if found.hidden else drawn)
    return found.hidden == 1


def depths_by_cell(splat, view, config, quality):
    """Return the nearest depth that its words draw in each cell, and background elsewhere."""
    words = encode_module.encode(splat, view, config, quality, nearest_pixel=True)
    depth = picture_of(words, WIDTH, HEIGHT, config).depth
    return depth.reshape(ROWS_OF_CELLS, ROWS, CELLS_OF_ROW, BLOCK).min(axis=(1, 3))


def random_splat(rng, largest):
    """Return a splat in the image or just beside it."""
    diameter = rng.uniform(0.0, largest)
    slopes = rng.normal(size=2) * 10.0 ** rng.uniform(-2.5, 0.5, 2)
    place = rng.uniform(-3, (WIDTH + 3, HEIGHT + 3))
    splat = splats_of(*place, diameter, slope=slopes)
    splat.data["depth"] = rng.uniform(0.9, 1.4)
    return dataclasses.replace(splat, depth_range=LIMITS)


@pytest.mark.parametrize(("config", "quality"), CASES)
@pytest.mark.parametrize(("largest", "focal"), SIZES)
def test_a_splat_with_a_pixel_that_shows_is_not_hidden(
    config, quality, largest, focal, monkeypatch
):
    rng = np.random.default_rng(int(largest))
    view, tried = view_of(focal), 0
    for _ in range(150):
        splat = random_splat(rng, largest)
        depth = depths_by_cell(splat, view, config, quality)
        for row, column in np.argwhere(depth < config.background_depth):
            bound = np.full(depth.shape, -1)
            bound[row, column] = depth[row, column]  # one that is as near is not before it
            assert not is_hidden(splat, view, config, quality, bound, monkeypatch), splat.data
            tried += 1
    assert tried > 100


@pytest.mark.parametrize(("config", "quality"), CASES)
@pytest.mark.parametrize(("largest", "focal"), SIZES[:2])  # the others touch too many cells
def test_a_splat_behind_all_that_it_may_touch_is_hidden(
    config, quality, largest, focal, monkeypatch
):
    """Its disc lies in the rectangle of its radius and what a shape may add, and in the depth of
    that rectangle's corners. A slope's rounding and the rest are 8 of 512 levels at most."""
    rng = np.random.default_rng(int(largest) + 1)
    view, background = view_of(focal), config.background_depth
    tried = 0
    for _ in range(150):
        splat = random_splat(rng, largest)
        values = splat.data[0]
        column, line, distance = (float(values[name]) for name in ("column", "line", "depth"))
        if quality != "paper" and float(values["diameter"]) ** 2 / 4 / focal > FLAT:
            continue
        reach = 0.5 * float(values["diameter"]) * 1.1 + (0.1 if quality == "exact" else 5.1)
        slopes = abs(values["slope_x"]) + abs(values["slope_y"])
        nearest = distance - distance * float(slopes) * reach / focal
        depth = (nearest - LIMITS[0]) / (LIMITS[1] - LIMITS[0]) * background
        bound = np.full((ROWS_OF_CELLS, CELLS_OF_ROW), background)
        top, bottom = (int(max(at, 0.0)) // ROWS for at in (line - reach, line + reach))
        left, right = (int(max(at, 0.0)) // BLOCK for at in (column - reach, column + reach))
        bound[top : bottom + 1, left : right + 1] = int(depth - background / 64)
        assert is_hidden(splat, view, config, quality, bound, monkeypatch), splat.data
        tried += 1
    assert tried > 100
