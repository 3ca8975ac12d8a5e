"""Pictures of a live cloud are those of ``splatline render``, fast and of any size."""

import dataclasses

import numpy as np
import pytest

from splatline.contract.presets import PRESETS
from splatline.plots.figure import depth_levels, rgb_levels
from splatline.sim.golden.multisample import average
from splatline.view.draw import Settings, draw
from splatline.view.outputs import Superseded
from splatline.view.pixels import rgba_bytes
from tests.view.views import SIZE, ball


@pytest.fixture(scope="module")
def camera(live):
    return ball().home(live, SIZE)


@pytest.mark.parametrize("samples", [1, 4, 16])
@pytest.mark.parametrize("preset", ["paper", "rgb24", "plane"])
@pytest.mark.parametrize("background", [(23 / 255, 26 / 255, 31 / 255), (1.0, 0.3, 0.0)])
def test_the_bytes_are_those_of_the_png(live, camera, samples, preset, background):
    settings = Settings(preset=PRESETS[preset], samples=samples, background=background)
    drawing = draw(live, camera, SIZE, settings)
    mean = average(drawing.rasters)
    assert np.array_equal(drawing.rgba[..., :3], rgb_levels(mean.to_rgb(background)))
    assert (drawing.rgba[..., 3] == 255).all()
    assert np.array_equal(drawing.depth_rgba[..., 0], depth_levels(mean) >> 8)
    assert len(np.unique(drawing.depth_rgba)) > 20


def test_a_background_beyond_white_is_cut_off(live, camera):
    drawing = draw(live, camera, SIZE)
    bytes_ = rgba_bytes(drawing.rasters, (1.5, -0.5, 0.5))
    assert bytes_[0, 0].tolist() == [255, 0, 128, 255]


def test_what_a_picture_took_is_told(live, camera):
    for size in (SIZE, (600, 80)):
        drawing = draw(live, camera, size)
        assert drawing.golden_seconds > 0.0
        assert {"project", "encode", "sort"} <= set(drawing.counts["seconds"])


def test_depth_and_camera_give_back_the_point(live, camera):
    """What is drawn at a pixel lies on the ball, at a depth's step and a pixel's width."""
    size = (256, 256)
    drawing = draw(live, camera, size, Settings(preset=PRESETS["plane"]))
    rows, columns = np.nonzero(drawing.rasters[0].drawn)
    for line, column in list(zip(rows.tolist(), columns.tolist(), strict=True))[::500]:
        depth = drawing.depth_at(column, line)
        point = camera.point_at((column + 0.5, line + 0.5), depth, size)
        assert np.linalg.norm(np.asarray(point) - live.cloud.origin) == pytest.approx(1.0, abs=0.12)
    assert drawing.depth_at(0, 0) is None
    with pytest.raises(IndexError):
        drawing.depth_at(256, 0)
    with pytest.raises(IndexError):
        drawing.depth_at(0, -1)


def test_nothing_in_view_is_a_picture_of_background(live, camera):
    away = dataclasses.replace(camera, target=(1e4, 0.0, 0.0), distance=1.0)
    for size in (SIZE, (600, 80)):
        drawing = draw(live, away, size, Settings(background=(1.0, 1.0, 1.0)))
        assert (drawing.rgba == 255).all()
        assert drawing.depth_at(0, 0) is None


@pytest.mark.parametrize("size", [SIZE, (600, 80)])
def test_drawing_ends_when_it_is_not_needed_any_more(live, camera, size):
    def check():
        nonlocal calls
        calls += 1
        if calls == 3:
            raise Superseded

    calls = 0
    with pytest.raises(Superseded):
        draw(live, camera, size, Settings(samples=16), check=check)
    assert calls == 3
