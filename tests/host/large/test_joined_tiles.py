import functools

import numpy as np
import pytest

from splatline.contract.presets import RGB24
from splatline.contract.raster import Raster
from splatline.contract.variants import CONFIGS
from splatline.host.large import plan
from splatline.host.large.draw_parts import Drawing, draw_part, draw_parts, frames_of, join_parts
from splatline.host.large.joined_tiles import tiles_of
from splatline.host.large.plan import make_plan
from splatline.host.visibility.view import fit_view
from splatline.sim import golden
from tests.host.large.test_draw_parts import hills, write_las

SIZE = 700, 540
"""Larger than a tile of ``rgb24`` in both directions."""

WIDE = CONFIGS["wide2048"]


@pytest.fixture(scope="module")
def settled(tmp_path_factory):
    path = write_las(tmp_path_factory.mktemp("tiles") / "a.laz", *hills(40_000, 8))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plan, "PART_POINTS", 15_000)
        fit = functools.partial(fit_view, size=SIZE, up="z", zoom=1.3)
        return make_plan([path], None, fit, 16)


def assembled(picture, sample):
    """The whole raster of a sample, from golden's tiles without their guard bands."""
    lines = []
    for row in picture.map_rows(list):
        band = []
        for tile in row:
            frame = tile.frames[sample]
            if frame is None:
                width, height = tile.tile.size
                raster = Raster.background(width, height, picture.config)
            else:
                raster = golden.render(frame)
            band.append(raster.part(*tile.tile.own))
        lines.append(band)
    depth = np.block([[raster.depth for raster in band] for band in lines])
    colour = np.concatenate(
        [np.concatenate([raster.colour for raster in band], axis=1) for band in lines]
    )
    return Raster(depth, colour, picture.config)


@pytest.mark.parametrize("samples", [1, 4])
@pytest.mark.parametrize("close", [False, True], ids=["", "closed"])
def test_tiles_of_parts_are_the_picture_of_one_wide_engine(settled, samples, close, monkeypatch):
    """Of one engine, whose tiles are as small as another's."""
    drawing = Drawing(config=WIDE, samples=samples, close_specks=close)
    whole = frames_of(settled, drawing, draw_parts(settled, drawing))
    monkeypatch.setattr(Drawing, "in_tiles", lambda self, plan: True)
    monkeypatch.setattr("splatline.host.picture_tiles.grid.MOST_LINES", 200)
    joined = draw_parts(settled, drawing)
    picture = tiles_of(settled, drawing, joined)
    assert picture.grid.rows == 3
    for sample, frame in enumerate(whole):
        assert assembled(picture, sample).mismatches(golden.render(frame)) == 0
    assert picture.counts["points"] == 40_000
    assert picture.counts["words_twice"] > 0
    assert picture.counts["elements"] == whole[0].counts["elements"]
    if close:
        closed = sum(frame.counts["specks"] for frame in whole)
        assert picture.counts["specks"] == closed > 0


def test_parts_of_tiles_may_be_joined_in_any_order(settled):
    drawing = Drawing(config=RGB24)
    assert drawing.in_tiles(settled)
    first, second, third = (draw_part(settled, part, drawing) for part in settled.parts)
    one = tiles_of(settled, drawing, join_parts([first, join_parts([second, third])]))
    other = tiles_of(settled, drawing, join_parts([join_parts([third, first]), second]))
    assert one.counts["tiles"] >= 2
    assert assembled(one, 0).mismatches(assembled(other, 0)) == 0
    assert one.counts == other.counts
    assert assembled(one, 0).drawn.mean() > 0.2
