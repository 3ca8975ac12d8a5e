import dataclasses

import numpy as np
import pytest

from splatline.host.cloud.resample import resample
from splatline.host.cloud.spacing import COVER, measure_discs
from splatline.host.pipeline import make_frame
from splatline.host.visibility.block_index import build_index
from splatline.host.visibility.project import project
from splatline.host.visibility.trim import LARGE, SMALL, trim, trimmed_radii
from splatline.host.visibility.view import View, fit_view
from splatline.sim import golden
from splatline.sim.reference.wholeness import largest_gap, see_through, wholeness
from tests.support.clouds import cloud_of, sphere

VIEW = View(np.zeros(3), np.eye(3), 150.0, 200, 100, near=0.1)

EXCESS = 1.0 - 1.0 / COVER

SHADES = np.zeros((2, 64, 64), np.uint32)


def unit_sphere(view):
    """Depths along the view, as shares of their range, and the pixels whose rays meet it."""
    lines, columns = np.mgrid[: view.height, : view.width] + 0.5
    x, y = (columns - view.middle[0]) / view.focal, (lines - view.middle[1]) / view.focal
    rays = np.stack([x, y, np.ones_like(x)], axis=-1) @ view.axes
    squares, half = np.sum(rays**2, axis=-1), -(rays @ view.eye)
    root = half**2 - squares * (view.eye @ view.eye - 1.0)
    drawn = root > 0.0
    depths = (half - np.sqrt(np.maximum(root, 0.0))) / squares
    low, high = depths[drawn].min(), depths[drawn].max()
    return (depths - low) / (high - low), drawn


def test_small_discs_are_trimmed_to_their_closing_radius_and_large_ones_are_not():
    assert trim(SMALL, EXCESS) == pytest.approx(SMALL / COVER)
    assert trim(0.01, EXCESS) == pytest.approx(0.01 / COVER)
    assert trim(LARGE, EXCESS) == LARGE
    assert trim(90.0, EXCESS) == 90.0
    assert trim(1.0, 0.0) == 1.0


def test_a_larger_disc_stays_larger():
    radii = np.linspace(0.0, 2 * LARGE, 1000)
    assert np.all(np.diff([trim(radius, EXCESS) for radius in radii]) > 0)


def test_splats_are_as_large_as_trimmed_radii_say():
    rng = np.random.default_rng(3)
    positions = rng.uniform((-1, -0.5, 2), (1, 0.5, 9), (300, 3))
    cloud, radii = (
        cloud_of(positions, np.tile([0.0, 0.0, -1.0], (300, 1))),
        rng.uniform(0, 0.5, 300),
    )
    index = build_index(cloud, radii)
    splats = project(index, VIEW, SHADES, 14, frozenset(), COVER).together()
    expected = trimmed_radii(cloud.positions, radii, VIEW, COVER)
    sizes = 2 * expected * VIEW.focal / cloud.positions[:, 2]
    np.testing.assert_allclose(np.sort(splats["diameter"]), np.sort(sizes), rtol=1e-6)
    assert np.any(expected < radii) and np.any(expected == radii)


def test_discs_of_given_sizes_are_not_trimmed():
    cloud = sphere(500)
    assert measure_discs(cloud).cover == COVER
    assert measure_discs(cloud, 0.1).cover == 1.0
    own = dataclasses.replace(cloud, radii=np.full(500, 9.0))
    assert measure_discs(own).cover == 1.0


def test_a_sphere_with_trimmed_discs_is_whole_and_has_a_sharper_outline():
    cloud = sphere(20_000)
    view = fit_view(cloud, size=(128, 128))
    discs = measure_discs(cloud)
    pictures = [
        golden.render(make_frame(cloud, view, **each._asdict(), close_specks=True))
        for each in (discs, discs.drawn(close_specks=False))
    ]
    depths, true = unit_sphere(view)
    trimmed, whole = (np.count_nonzero(picture.drawn & ~true) for picture in pictures)
    assert trimmed < 0.7 * whole
    assert np.count_nonzero(true & ~pictures[0].drawn) < 0.001 * np.count_nonzero(true)
    own = wholeness(pictures[0])
    assert own["pinholes"] == 0.0
    # The true outline falls off steeply.
    assert own["see_through"] < 0.1 * np.mean(see_through(depths, true)[true])


@pytest.mark.parametrize(
    ("count", "seed", "is_trimmed"),
    [(8000, 2, False), (20_000, 0, False), (20_000, 3, True), (20_000, 4, True)],
)
def test_a_dense_sample_of_scattered_points_has_no_gap(count, seed, is_trimmed):
    """As those of scans: its points lie in the discs of points that lie at random."""
    normals = np.random.default_rng(seed).normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    cloud = cloud_of(normals, normals.astype(np.float32))
    dense, _ = resample(cloud, measure_discs(cloud).radii, 4 * count)
    view = fit_view(cloud, size=(256, 256))
    discs = measure_discs(dense).drawn(close_specks=is_trimmed)
    frame = make_frame(dense, view, **discs._asdict(), close_specks=True)
    assert largest_gap(golden.render(frame).drawn) == 0
