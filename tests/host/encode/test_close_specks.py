"""Specks are closed: pinholes, and pixels that are seen through."""

import dataclasses

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.contract.presets import PAPER, PLANE, RGB24, SWIFT
from splatline.host.cloud.spacing import splat_radii
from splatline.host.encode.close_specks import close_specks
from splatline.host.encode.owners import as_encoded
from splatline.host.encode.sort_by_line import sort_by_line
from splatline.host.encode.write_words import ONE_PIXEL
from splatline.host.pipeline import make_frame, make_frames, total_counts
from splatline.host.scenes.scenes import load_scene
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.materials import find_materials, material_tables
from splatline.host.visibility.view import fit_view
from splatline.sim import golden
from splatline.sim.reference.wholeness import pinholes, see_through, wholeness
from tests.support.clouds import cloud_of, sphere

SHAPES = pytest.mark.parametrize(
    ("config", "quality"),
    [(RGB24, "exact"), (RGB24, "fast"), (PAPER, "paper"), (PLANE, "exact"), (SWIFT, "exact")],
    ids=lambda value: getattr(value, "name", value),
)


def tables():
    """The tables of an engine of ``rgb24``."""
    materials = find_materials(sphere(20), 1 << RGB24.material_bits)
    return material_tables(materials, Lighting(), RGB24, 0.5)


def frame_of_pixels(depth):
    """A frame that draws an image of depths, each pixel by a word of its own look."""
    y, x = np.nonzero(depth < RGB24.background_depth)
    words = np.full(len(y), 1 | ONE_PIXEL << RGB24.scans.lsb, np.uint64)
    for field, value in ((RGB24.diffuse, 3 * x + y), (RGB24.x, x), (RGB24.z, depth[y, x])):
        words |= (value & field.mask).astype(np.uint64) << np.uint64(field.lsb)
    height, width = depth.shape
    stream, _ = sort_by_line(as_encoded(words, y + 4, height), RGB24)
    return Frame(stream, tables(), width, height, RGB24)


def ragged(config, quality, seed=4, **options):
    """A frame of discs that are too small to close the surface."""
    cloud = load_scene("knot").cloud
    radii = 0.55 * splat_radii(cloud)
    view = fit_view(cloud, size=(170, 130), orbit=(40 * seed, 20))
    return make_frame(cloud, view, radii=radii, config=config, quality=quality, **options)


def specks(raster):
    """Where a raster is not whole, by the measures of ``bench surface``."""
    depth = raster.depth / (raster.config.background_depth - 1)
    return pinholes(raster.drawn) | see_through(depth, raster.drawn)


@SHAPES
def test_a_picture_has_fewer_specks_and_is_else_the_same(config, quality):
    frame = ragged(config, quality)
    before, closed = golden.render(frame), close_specks(frame)
    after = golden.render(closed)
    found = specks(before)
    assert found.sum() > 30
    changed = before.differs(after)
    # Some specks are found where others were closed; what is further away is of a small area.
    assert changed[found].all()
    assert found.sum() <= changed.sum() <= 1.5 * found.sum()
    near = sum(np.roll(found, (y, x), (0, 1)) for y in (-1, 0, 1) for x in (-1, 0, 1)) > 0
    assert not (changed & before.drawn)[~near].any()
    assert closed.counts["specks"] == changed.sum()
    assert sum(wholeness(after).values()) < 0.25 * sum(wholeness(before).values())
    assert (after.depth[changed] < before.depth[changed]).all()


@SHAPES
def test_a_closed_pixel_has_depth_and_colour_of_a_neighbour(config, quality):
    frame = ragged(config, quality, seed=2)
    before, after = golden.render(frame), golden.render(close_specks(frame))
    lines, columns = np.nonzero(before.differs(after))
    assert len(lines) > 30
    for y, x in zip(lines, columns, strict=True):
        # Of the second round a neighbour's neighbour may be the source, and of an area a speck's.
        around = before.part(slice(max(y - 4, 0), y + 5), slice(max(x - 4, 0), x + 5))
        same = (around.colour == after.colour[y, x]).all(axis=2)
        assert (same & (around.depth == after.depth[y, x])).any()


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("size", [(40, 30), (3, 90), (1, 8), (8, 1), (1, 1)])
def test_what_is_closed_first_is_what_the_measure_finds(seed, size):
    rng = np.random.default_rng(seed)
    depth = rng.choice([20, 44, 45, 46, 70, 95, RGB24.background_depth - 1], size[::-1])
    depth[rng.random(depth.shape) < 0.1 * (seed % 3)] = RGB24.background_depth
    frame = frame_of_pixels(depth)
    before, after = golden.render(frame), golden.render(close_specks(frame))
    assert np.array_equal(before.depth, depth)
    changed = before.differs(after)
    assert changed[specks(before)].all()
    assert not specks(before).any() or changed.sum() > 0


def test_the_neighbour_is_the_one_of_median_depth():
    depth = np.full((5, 5), RGB24.background_depth)
    depth[1:4, 1:4] = [[10, 20, 30], [40, RGB24.background_depth, 60], [70, 80, 90]]
    after = golden.render(close_specks(frame_of_pixels(depth)))
    assert after.depth[2, 2] == 40
    depth[2, 2] = 200
    assert golden.render(close_specks(frame_of_pixels(depth))).depth[2, 2] == 40
    depth[2, 2] = 74  # 24 behind the median of all, 60: not far enough
    assert golden.render(close_specks(frame_of_pixels(depth))).depth[2, 2] == 74


def test_the_border_of_a_part_stays_as_it_is():
    """A straight edge, a corner and a line of pixels are no specks."""
    depth = np.full((12, 12), RGB24.background_depth)
    depth[2:8, 2:8] = 100
    depth[4:, 10] = 50
    depth[8:11, 2:8] = 300
    frame = frame_of_pixels(depth)
    closed = close_specks(frame)
    assert closed.counts["specks"] == 0
    assert closed.codewords is frame.codewords


def test_only_the_own_pixels_of_a_tile_are_closed():
    frame = ragged(RGB24, "exact")
    own = slice(30, 90), slice(20, 120)
    whole, part = close_specks(frame), close_specks(frame, own)
    before, all_closed, some = map(golden.render, (frame, whole, part))
    changed = before.differs(some)
    assert changed[own].sum() == changed.sum() == part.counts["specks"] > 10
    assert all_closed.part(*own).mismatches(some.part(*own)) == 0


def test_the_counts_are_those_of_the_longer_stream():
    frame = ragged(RGB24, "exact")
    closed = close_specks(frame)
    more = len(closed.codewords) - len(frame.codewords)
    assert closed.counts["codewords"] == len(closed.codewords)
    assert more >= closed.counts["specks"] > 0
    control = closed.counts["control_words"] - frame.counts["control_words"]
    assert more == closed.counts["specks"] + control
    assert closed.counts["bits_sent"] == {"table": 64 * len(closed.codewords)}
    assert closed.counts["elements"] == frame.counts["elements"]


def test_each_sample_of_a_picture_is_closed():
    cloud = load_scene("knot").cloud
    view, radii = fit_view(cloud, size=(96, 64)), 0.55 * splat_radii(cloud)
    frames = make_frames(cloud, view, 4, radii=radii, close_specks=True)
    plain = make_frames(cloud, view, 4, radii=radii)
    assert all(frame.counts["specks"] > 0 for frame in frames)
    assert total_counts(frames)["specks"] == sum(frame.counts["specks"] for frame in frames)
    for frame, other in zip(frames, plain, strict=True):
        wanted = golden.render(close_specks(other))
        assert golden.render(frame).mismatches(wanted) == 0
        assert "close" in frame.counts["seconds"]
        assert "specks" not in other.counts


def test_nothing_stays_nothing():
    cloud = cloud_of(np.zeros((1, 3)), np.eye(3)[:1])
    view = dataclasses.replace(fit_view(sphere(20), size=(40, 30)), eye=np.array([0.0, 0.0, 1e6]))
    frame = make_frame(cloud, view, radii=np.ones(1), may_be_empty=True, close_specks=True)
    assert frame.counts["specks"] == 0
    assert len(frame.codewords) == 1


def test_a_stream_that_is_cut_short_is_refused():
    frame = ragged(RGB24, "exact")
    with pytest.raises(InputError, match="no end-of-frame word"):
        close_specks(dataclasses.replace(frame, codewords=frame.codewords[:-1]))


def test_shapes_of_the_rom_are_refused():
    config = PAPER.with_shapes()
    with pytest.raises(InputError, match="take --shapes table"):
        make_frame(sphere(20), fit_view(sphere(20)), radii=np.full(20, 0.1), config=config,
                   quality="paper", shapes="rom", close_specks=True)  # fmt: skip
