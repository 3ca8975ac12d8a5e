"""A picture in tiles is bit for bit that of one engine of its size."""

import dataclasses
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label

from splatline.contract.errors import InputError
from splatline.contract.presets import PAPER, PLANE, RGB24, SWIFT_PLANE
from splatline.contract.raster import Raster
from splatline.contract.variants import CONFIGS
from splatline.host.picture_tiles.frames import tile_picture
from splatline.host.pipeline import make_frame, make_frames, total_counts
from splatline.host.shading.materials import find_materials
from splatline.host.visibility.view import fit_view
from splatline.sim import golden
from tests.support.clouds import cloud_of, sphere


def sheet(seed, count=900, spread=1.0):
    """Points of a rough surface with normals of any direction, and radii from dots to sheets."""
    rng = np.random.default_rng(seed)
    positions = rng.uniform(-1, 1, (count, 3)) * (spread, 1.0, 0.6)
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    colours = rng.integers(0, 2, (count, 3)) * 255
    return cloud_of(positions, normals, colours.astype(np.uint8), two_sided=True)


def radii_of(seed, count, largest):
    rng = np.random.default_rng(seed)
    return np.exp(rng.uniform(np.log(1e-3), np.log(largest), count))


def drawn_in_tiles(picture):
    """Return the raster of each sample, put together from the tiles, and the frames' number."""
    grid, config = picture.grid, picture.config
    rasters, frames = None, 0
    for row in picture.rows():
        for each in row:
            if rasters is None:
                rasters = [Raster.background(grid.width, grid.height, config) for _ in each.frames]
            place = each.tile.place
            for raster, frame in zip(rasters, each.frames, strict=True):
                if frame is not None:
                    frames += 1
                    own = golden.render(frame).part(*each.tile.own)
                    raster.depth[place], raster.colour[place] = own.depth, own.colour
    return rasters, frames


def assert_same(cloud, view, config, wide=None, samples=1, frame_size=(64, 40), **options):
    """Compare tiles with the frames of one engine, whose X may be wider; return the counts.

    A view that shows nothing is refused alike.
    """
    materials = find_materials(cloud, 8)
    common = {"materials": materials, **options}
    in_tiles = {"config": config, "frame_size": frame_size, **common}
    try:
        whole = make_frames(cloud, view, samples, config=wide or config, **common)
    except InputError as error:
        with pytest.raises(InputError, match=re.escape(str(error))):
            drawn_in_tiles(tile_picture(cloud, view, samples, **in_tiles))
        return {}, 0
    picture = tile_picture(cloud, view, samples, **in_tiles)
    rasters, frames = drawn_in_tiles(picture)
    for raster, frame in zip(rasters, whole, strict=True):
        wanted = golden.render(frame)
        assert np.array_equal(raster.depth, wanted.depth)
        assert np.array_equal(raster.colour, wanted.colour)
    counts, of_whole = picture.counts, total_counts(whole)
    assert counts["depth_range"] == of_whole["depth_range"]
    assert counts.get("specks") == of_whole.get("specks")
    if "hidden" not in options.get("skips", ()):
        assert counts["elements"] == of_whole["elements"]
        assert counts["culled"] == of_whole["culled"]
        once = counts["codewords"] - counts["control_words"] - counts["words_twice"]
        assert once == of_whole["codewords"] - of_whole["control_words"]
    return counts, frames


SKIPS = (
    {"outside", "facing_away", "no_pixel", "overdrawn"},
    {"outside"},  # every point is a pixel at least
    {"outside", "no_pixel", "hidden"},
)


@settings(max_examples=12)
@given(
    st.integers(0, 10_000),
    st.sampled_from(["exact", "fast", "paper", "plane", "swift-plane"]),
    st.sampled_from([1, 1, 4]),
    st.sampled_from([0.7, 1.0, 4.0, 25.0]),
    st.sampled_from([0.02, 0.3, 3.0]),
    st.sampled_from(SKIPS),
    st.sampled_from([None, (0.0, 3000.0), (2.0, 2.2)]),
    st.booleans(),
)
def test_tiles_draw_the_picture_of_one_engine(
    seed, quality, samples, zoom, largest, skips, depth_range, close
):
    config = {"plane": PLANE, "swift-plane": SWIFT_PLANE}.get(quality, RGB24)
    quality = "exact" if config.plane else quality
    cloud = sheet(seed)
    view = fit_view(cloud, size=(330, 170), zoom=zoom, orbit=(seed % 360, 20))
    radii = radii_of(seed, len(cloud), largest)
    assert_same(
        cloud, view, config, samples=samples, radii=radii, quality=quality, skips=skips,
        depth_range=depth_range, close_specks=close, cover=1.0 + close * 0.32,
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("preset", [RGB24, PLANE], ids=lambda config: config.name)
def test_specks_are_closed_across_the_borders_of_tiles(preset, seed):
    """Small tiles, so that many specks lie at a border, and some touch across it."""
    cloud = sheet(seed, count=4000)
    view = fit_view(cloud, size=(330, 170), orbit=(50 * seed, 20))
    options = {"radii": np.full(len(cloud), 0.025), "close_specks": True}
    counts, _ = assert_same(cloud, view, preset, frame_size=(48, 32), **options)
    assert counts["specks"] > 500


@pytest.mark.parametrize("quality", ["exact", "fast"])
def test_small_areas_are_closed_across_the_borders_of_tiles(quality):
    """A flat sheet of discs with gaps, seen aslant."""
    rng = np.random.default_rng(2)
    positions = rng.uniform(-1, 1, (9000, 3)) * (1.0, 1.0, 0.0)
    cloud = cloud_of(positions, np.tile([0.0, 0.0, 1.0], (9000, 1)), two_sided=True)
    view = fit_view(cloud, size=(330, 170), orbit=(20, 15))
    options = {"radii": np.full(9000, 0.019), "quality": quality}
    before, after = (
        golden.render(make_frame(cloud, view, **options, close_specks=close)).drawn
        for close in (False, True)
    )
    areas, _ = label(~before)
    sizes = np.bincount(areas.ravel())[areas]
    # About as many columns are beside a border as are not.
    assert np.count_nonzero(after & ~before & (sizes > 2)) > 100
    assert_same(cloud, view, RGB24, frame_size=(48, 32), close_specks=True, **options)


@pytest.mark.parametrize("quality", ["exact", "fast", "paper", "plane"])
@pytest.mark.parametrize("ahead", [0.0, 0.4])
def test_discs_that_reach_the_eye_are_drawn_whole(quality, ahead):
    config = PLANE if quality == "plane" else PAPER
    cloud = sheet(5)
    view = fit_view(cloud, size=(330, 170))
    # The eye is amid the points, and many discs reach behind it.
    view = dataclasses.replace(view, eye=ahead * view.axes[2], near=0.01)
    options = {
        "radii": radii_of(5, len(cloud), 2.0),
        "quality": "exact" if config.plane else quality,
    }
    assert_same(cloud, view, config, skips={"outside"}, **options)


@pytest.mark.parametrize("quality", ["exact", "fast", "paper"])
def test_equal_depths_are_drawn_in_the_order_of_the_whole_picture(quality):
    cloud = sheet(9, count=6000)
    view = fit_view(cloud, size=(330, 170))
    options = {"radii": np.full(len(cloud), 0.02), "quality": quality, "skips": {"outside"}}
    # All depths are one, so that the order alone decides.
    counts, _ = assert_same(cloud, view, RGB24, depth_range=(0.0, 1e9), **options)
    assert counts["codewords"] > 6000


@pytest.mark.parametrize("preset", [RGB24, PAPER], ids=lambda config: config.name)
@pytest.mark.parametrize("quality", ["exact", "paper"])
def test_a_512_column_engine_draws_what_one_of_4096_columns_would(preset, quality):
    wide = preset.replace(x_bits=12, line_bits=12, material_bits=4)  # three bits from MATERIAL
    cloud = sheet(3, spread=2.0)
    view = fit_view(cloud, size=(1300, 700))
    options = {"radii": radii_of(3, len(cloud), 0.2), "quality": quality}
    counts, frames = assert_same(cloud, view, preset, wide, frame_size=None, **options)
    assert frames == counts["tiles"] == 6


@pytest.mark.parametrize("name", ["wide2048", "plane-4096"])
@pytest.mark.parametrize("samples", [1, 4])
def test_a_large_picture_of_tiles_of_512_columns(name, samples):
    cloud = sheet(8, count=3000)
    view = fit_view(cloud, size=(2048, 2048), zoom=3.0)
    options = {"radii": radii_of(8, len(cloud), 0.1)}
    assert_same(cloud, view, CONFIGS[name], samples=samples, frame_size=(512, 512), **options)


def test_tiles_without_splats_are_not_drawn_and_counted():
    cloud = sphere(300)
    view = fit_view(cloud, size=(500, 100))
    picture = tile_picture(cloud, view, radii=np.full(300, 0.05), frame_size=(64, 40))
    rasters, frames = drawn_in_tiles(picture)
    assert rasters[0].drawn.any()
    assert picture.counts["tiles"] == frames
    assert picture.counts["tiles_empty"] == picture.grid.rows * picture.grid.columns - frames > 5


def test_points_without_a_pixel_are_drawn_if_nothing_else_is():
    cloud = sphere(5)
    view = fit_view(cloud, size=(700, 100))
    radii = np.full(5, 1e-6)
    counts, _ = assert_same(cloud, view, RGB24, RGB24.replace(x_bits=12, material_bits=4),
                            radii=radii, frame_size=None)  # fmt: skip
    assert counts["elements"] > 0
    assert "no_pixel" not in counts["skips"]


def test_a_view_of_nothing_is_one_line():
    cloud = sphere(50)
    view = dataclasses.replace(fit_view(cloud, size=(700, 100)), eye=np.array([0.0, 0.0, 1e6]))
    with pytest.raises(InputError, match=r"nothing of .* is in view: of 50 points, "):
        tile_picture(cloud, view, radii=np.full(50, 0.1))


def test_shapes_of_the_rom_are_refused():
    cloud = sphere(50)
    config = PAPER.with_shapes()
    with pytest.raises(InputError, match="not drawn in tiles"):
        tile_picture(cloud, fit_view(cloud), radii=np.full(50, 0.1), config=config,
                     quality="paper", shapes="rom")  # fmt: skip
