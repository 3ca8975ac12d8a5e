import numpy as np
import pytest
from PIL import Image

from splatline.contract.presets import PAPER
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.materials import find_materials, material_tables, materials_of
from tests.support.clouds import cloud_of


def coloured(colours):
    count = len(colours)
    return cloud_of(np.zeros((count, 3)), np.zeros((count, 3)), colours)


def test_few_colours_stay_exactly_as_they_are():
    rng = np.random.default_rng(1)
    colours = rng.integers(0, 256, (128, 3))[rng.integers(0, 128, 5000)]
    materials = find_materials(coloured(colours))
    assert (materials.palette[materials.index] == colours).all()
    assert len(materials.palette) <= 128


def test_no_more_materials_than_a_byte_tells_apart():
    """However many the engine's table has."""
    colours = np.stack([np.arange(300) % 256, np.arange(300) // 256, np.zeros(300)], axis=-1)
    cloud = cloud_of(np.zeros((300, 3)), np.ones((300, 3)), colours.astype(np.uint8))
    materials = find_materials(cloud, most=512)
    assert len(materials.palette) <= 256
    error = materials.palette[materials.index].astype(int) - colours
    assert np.abs(error).max() <= 4


def test_many_colours_are_reduced_to_near_ones():
    rng = np.random.default_rng(2)
    colours = rng.integers(0, 256, (20_000, 3))
    materials = find_materials(coloured(colours))
    assert len(materials.palette) <= 128
    error = np.abs(materials.palette[materials.index].astype(int) - colours).mean()
    assert error < 15  # 128 cells of a uniform cube: about 256 / 128^(1/3) / 4 = 13 a channel


def test_a_palette_has_less_error_than_median_cut_and_each_point_its_nearest_colour():
    # Most colours lie close together, as in a scan, and some far away.
    rng = np.random.default_rng(3)
    near = rng.normal((150, 110, 80), (30, 20, 12), (15_000, 3))
    colours = np.vstack([near, rng.uniform(0, 255, (800, 3))]).clip(0, 255).astype(np.uint8)
    found = find_materials(coloured(colours))
    shown = found.palette[found.index].astype(float)
    apart = np.linalg.norm(found.palette[None].astype(float) - colours[:400, None], axis=2)
    assert np.linalg.norm(shown - colours, axis=1)[:400] == pytest.approx(apart.min(axis=1))

    cut = Image.fromarray(colours[None]).quantize(128, method=Image.Quantize.MEDIANCUT, dither=0)
    theirs = np.asarray(cut.convert("RGB"), float)[0]
    assert np.mean((shown - colours) ** 2) < 0.75 * np.mean((theirs - colours) ** 2)


@pytest.mark.parametrize("count", [1, 7, 256])
def test_each_colour_has_the_first_of_the_nearest_entries(count):
    """At the ends of the range too, where the squares of distances are largest."""
    rng = np.random.default_rng(count)
    palette = rng.integers(0, 256, (count, 3)).astype(np.uint8)
    palette[0] = 0
    palette[count // 2 :] = palette[: count - count // 2]  # each twice
    colours = np.vstack([rng.integers(0, 256, (3000, 3)), [(255, 255, 255), (0, 0, 0)]])
    away = colours[:, None] - palette[None].astype(int)
    expected = (away**2).sum(axis=2).argmin(axis=1)
    assert (materials_of(coloured(colours), palette).index == expected).all()


def test_one_colour_is_one_material():
    materials = find_materials(coloured(np.full((10, 3), 77)))
    assert materials.palette.tolist() == [[77, 77, 77]]
    assert not materials.index.any()


def test_full_white_in_full_light_is_the_largest_level_and_rounding_is_to_nearest():
    grey = np.linspace(0, 255, 12).astype(np.uint8)
    materials = find_materials(coloured(np.repeat(grey[:, None], 3, axis=1)))
    tables = material_tables(materials, Lighting(gloss=0.5), PAPER)
    assert tables.diffuse.max() < 64
    assert tables.specular.max() < 64
    for intensity in range(128):
        level = tables.ambient[0] + tables.diffuse[:12, 0] * intensity >> 10
        exact = materials.palette[:, 0] / 255 * intensity / 127 * 7
        # Half a level of rounding, and half a step of kd.
        assert (np.abs(level - exact) <= 0.5 + 0.5 * 127 / 1024 + 1e-9).all()
    assert (tables.ambient[0] + tables.diffuse[11, 0] * 127) >> 10 == 7
