"""Discs near the eye, by their words, against rays through the pixels' centres."""

import dataclasses

import numpy as np
import pytest

from splatline.contract.presets import PAPER, PLANE
from splatline.host.encode.encode import encode
from splatline.host.visibility.view import View
from tests.support.splats import picture_of, splats_of

WIDTH, HEIGHT = 45, 34
FAR = 1000.0
RAYS = np.stack(np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5), axis=-1)


def rays_of(focal):
    """Directions through the pixels' centres, whose third coordinate is 1."""
    offset = RAYS - (WIDTH / 2, HEIGHT / 2)
    return np.concatenate([offset / focal, np.ones((HEIGHT, WIDTH, 1))], axis=-1)


def pixels_met(centre, normal, radius, focal, near):
    """Return where a ray surely meets a disc beyond the near plane, and where it surely does not.

    A ray that comes within a thousandth of the rim, or of the near plane, is in neither. Pixels
    beyond the depth range are those that an engine with planes does not draw.
    """
    rays = rays_of(focal)
    with np.errstate(divide="ignore"):
        distance = (normal @ centre) / (rays @ normal)
    away = np.linalg.norm(distance[..., np.newaxis] * rays - centre, axis=-1) / radius
    met = (away < 0.999) & (distance > 1.001 * near) & (distance < 0.9 * FAR)
    missed = (away > 1.001) | (distance < 0.999 * near)
    return met, missed


def drawn_by_words(config, place, radius, slopes, focal, near):
    splat = splats_of(*place, 2 * radius * focal, slope=slopes)
    splat = dataclasses.replace(splat, depth_range=(0.0, FAR))
    view = View(np.zeros(3), np.eye(3), focal, WIDTH, HEIGHT, near)
    return picture_of(encode(splat, view, config, "exact"), WIDTH, HEIGHT, config).drawn


@pytest.mark.parametrize("config", [PAPER, PLANE], ids=["paper", "plane"])
@pytest.mark.parametrize(
    ("radii", "near"),
    [((0.02, 0.5), 1e-3), ((0.5, 0.99), 1e-3), ((1.0, 3.0), 0.05), ((1.0, 30.0), 0.4)],
    ids=["small", "nearer than twice its radius", "behind the eye", "far behind the eye"],
)
def test_a_disc_s_pixels_are_those_whose_rays_meet_it(config, radii, near):
    rng = np.random.default_rng(2)
    some, leans = 0, np.zeros(2, int)
    for _ in range(300):
        focal = float(np.exp(rng.uniform(np.log(3.0), np.log(80.0))))
        radius = float(np.float32(np.exp(rng.uniform(*np.log(radii)))))
        place = np.float32(rng.uniform((-15, -15), (WIDTH + 15, HEIGHT + 15))).astype(float)
        centre = np.append((place - (WIDTH / 2, HEIGHT / 2)) / focal, 1.0)  # at the distance 1
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        facing = normal @ centre
        if abs(facing) < 0.05 * np.linalg.norm(centre):
            continue  # nearly edge on, where 32-bit slopes are too coarse for this test
        slopes = np.float32(normal[:2] / facing).astype(float)
        normal = np.append(slopes, 1.0 - slopes @ centre[:2])  # as the host has it
        met, missed = pixels_met(centre, normal, radius, focal, near)
        found = drawn_by_words(config, place, radius, slopes, focal, near)
        assert found[met].all(), (place, radius, slopes, focal)
        assert not found[missed].any(), (place, radius, slopes, focal)
        some += met.any() and missed.any()
        leans += slopes[0] > 0, slopes[0] < 0
    assert some > 60
    assert leans.min() > 60
