import math

import numpy as np

from splatline.contract.presets import PAPER
from splatline.host.pipeline import make_frame
from splatline.host.shading.lighting import Light, Lighting
from splatline.host.shading.normal_levels import level_slopes
from splatline.host.shading.shade import SHADE_LEVELS, shade_bits, shade_tables
from splatline.host.visibility.block_index import build_index
from splatline.host.visibility.project import project
from splatline.host.visibility.view import View
from tests.support.clouds import cloud_of


def test_tables_are_phong_s_model_at_each_level():
    lighting = Lighting(
        (Light((0.3, -0.4, -2.0), 0.6), Light((-1.0, 0.0, -0.2), 0.3)), 0.1, 0.5, 9.0
    )
    diffuse, specular = shade_tables(lighting, 7, 64)
    slopes = level_slopes(64)
    for x in range(0, 64, 5):
        for y in range(0, 64, 7):
            length = math.sqrt(slopes[x] ** 2 + slopes[y] ** 2 + 1)
            n = [-slopes[x] / length, -slopes[y] / length, -1 / length]
            d, s = lighting.ambient, 0.0
            for light in lighting.lights:
                size = math.sqrt(sum(c * c for c in light.direction))
                towards = [c / size for c in light.direction]
                cosine = sum(a * b for a, b in zip(n, towards, strict=True))
                if cosine > 0:
                    d += light.intensity * cosine
                    reflected_z = 2 * cosine * n[2] - towards[2]
                    s += light.intensity * max(-reflected_z, 0) ** lighting.shininess
            assert abs(diffuse[x, y] - 127 * min(d, 1)) <= 0.5
            assert abs(specular[x, y] - 127 * min(s, 1)) <= 0.5


def test_bright_lights_saturate_and_no_light_leaves_the_ambient():
    blinding = Lighting(tuple(Light((0, 0, -1), 5.0) for _ in range(3)), 0.2)
    diffuse, specular = shade_tables(blinding, 7)
    assert diffuse.max() == specular.max() == 127
    dark_diffuse, dark_specular = shade_tables(Lighting((), 0.2), 7)
    assert np.unique(dark_diffuse).tolist() == [round(0.2 * 127)]
    assert not dark_specular.any()


def test_highlights_are_those_that_the_true_viewer_sees():
    """Away from the axis, where a table for a viewer on it would show others."""
    rng = np.random.default_rng(5)
    lamp = Lighting((Light((-0.5, -0.7, -0.6), 1.0),), 0.0, 1.0, 12.0)
    towards = np.array(lamp.lights[0].direction) / np.linalg.norm(lamp.lights[0].direction)
    count = 3000
    positions = np.stack([*rng.uniform(-1.5, 1.5, (2, count)), np.full(count, 2.0)], -1)
    ray = positions / np.linalg.norm(positions, axis=1, keepdims=True)
    normals = -ray + 0.7 * rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    kept = ((normals * ray).sum(1) < -0.3) & (normals[:, 2] < -0.2)
    positions, normals, ray = positions[kept], normals[kept], ray[kept]
    index = build_index(cloud_of(positions, normals), np.full(len(positions), 0.1))
    view = View(np.zeros(3), np.eye(3), 100.0, 400, 400, 0.1)
    splats = project(index, view, shade_bits(lamp, PAPER), 14, frozenset()).together()
    shown = (splats["look"] >> 7 & 127) / 127.0
    order = index.point
    cosine = normals[order] @ towards
    mirrored = 2.0 * cosine[:, None] * normals[order] - towards
    glance = np.maximum(-(mirrored * ray[order]).sum(1), 0.0)
    true = np.where(cosine > 0, glance**12.0, 0.0)
    on_axis = np.where(cosine > 0, np.maximum(-mirrored[:, 2], 0.0) ** 12.0, 0.0)
    # To first order in the slant, which goes up to 50 degrees here.
    assert np.sqrt(np.mean((shown - true) ** 2)) < 0.5 * np.sqrt(np.mean((on_axis - true) ** 2))


def test_the_table_of_the_same_lights_is_made_once_and_cannot_be_changed():
    table = shade_bits(Lighting(), PAPER)
    assert table is shade_bits(Lighting(), PAPER)
    assert table.shape == (2, SHADE_LEVELS, SHADE_LEVELS)
    assert shade_bits(Lighting(), PAPER, 64).shape == (2, 64, 64)
    assert not table.flags.writeable


def test_the_paper_s_quality_has_the_paper_s_levels_of_shade():
    """So many normals of one direction: 64 levels show fewer shades than 256."""
    rng = np.random.default_rng(6)
    normals = np.stack([*rng.uniform(-0.4, 0.4, (2, 2000)), np.full(2000, -1.0)], -1)
    cloud = cloud_of(rng.uniform(-1, 1, (2000, 3)), normals)
    view = View(np.array([0.0, 0.0, -5.0]), np.eye(3), 100.0, 64, 64, 0.1)
    radii = np.full(2000, 0.05)
    field = np.uint64((1 << PAPER.material.lsb - PAPER.diffuse.lsb) - 1)

    def shades(quality):
        words = make_frame(cloud, view, radii=radii, quality=quality).codewords
        return len(np.unique(words >> np.uint64(PAPER.diffuse.lsb) & field))

    assert shades("exact") > 1.1 * shades("paper")
