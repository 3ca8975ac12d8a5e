"""Points of no surface, on curves or alone, are seen at any distance."""

import dataclasses

import numpy as np
import pytest
from scipy import ndimage

from splatline.host.cloud.spacing import measure_discs
from splatline.host.files.assemble import Columns, assemble_cloud
from splatline.host.pipeline import make_frame, make_frames
from splatline.host.visibility.skips import DEFAULT_SKIPS
from splatline.host.visibility.view import fit_view
from splatline.sim import golden


def cloud_of(positions, normals=None):
    return assemble_cloud(Columns(np.asarray(positions, float), normals), "test")


def drawn(cloud, **options):
    discs = measure_discs(cloud)
    view = fit_view(cloud, radii=discs.radii, size=(96, 80), **options.pop("view", {}))
    return golden.render(make_frame(cloud, view, **{**discs._asdict(), **options})).drawn


def line(count, noise=0.0):
    along = np.linspace(0.0, 1.0, count)[:, None]
    jitter = np.random.default_rng(1).normal(scale=noise, size=(count, 3)) if noise else 0.0
    return along * [1.0, 0.3, 0.2] + jitter


@pytest.mark.parametrize("skips", [DEFAULT_SKIPS, DEFAULT_SKIPS - {"overdrawn"}])
@pytest.mark.parametrize("count", [300, 20_000])
def test_a_line_has_no_gap_however_close_its_points_are(count, skips):
    seen = drawn(cloud_of(line(count)), skips=skips)
    columns = np.flatnonzero(seen.any(axis=0))
    assert columns[-1] - columns[0] > 80
    assert len(columns) == columns[-1] - columns[0] + 1
    if count == 20_000:
        assert seen.sum(axis=0).max() <= 2  # and it is a line


def test_normals_of_a_file_count_on_a_line_too():
    points = line(20_000)
    away = np.broadcast_to([0.0, 0.0, -1.0], points.shape)
    with pytest.raises(ValueError, match="in view"):
        drawn(cloud_of(points, away), view={"orbit": (0.0, 0.0)})


def test_rings_are_whole():
    turn = np.linspace(0.0, 2.0 * np.pi, 5000, endpoint=False)
    rings = [np.column_stack([r * np.cos(turn), r * np.sin(turn), 0 * turn]) for r in (1, 2, 3)]
    seen = drawn(cloud_of(np.concatenate(rings)), view={"orbit": (0.0, 0.0)})
    assert ndimage.label(seen, np.ones((3, 3)))[1] == 3
    assert ndimage.label(~seen)[1] == 4  # each is closed


@pytest.mark.parametrize("count", [2, 3, 5, 8, 10])
def test_each_of_a_few_points_is_seen_apart(count):
    positions = np.random.default_rng(count).normal(size=(count, 3))
    discs = measure_discs(cloud_of(positions))
    gaps = np.linalg.norm(positions[:, None] - positions, axis=2)
    apart = discs.radii[:, None] + discs.radii < gaps
    assert (apart | np.eye(count, dtype=bool)).all()
    assert discs.thin.all()


def test_a_line_towards_the_eye_is_a_spot_of_its_nearest_disc():
    seen = drawn(cloud_of(line(100)), view={"orbit": (0.0, 0.0)})
    assert 0 < seen.sum() < 0.5 * seen.size


def test_no_point_of_a_surface_is_thin():
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.random((5000, 2)), 0.002 * rng.normal(size=5000)])
    assert measure_discs(cloud_of(points)).thin.mean() < 0.02


def test_a_wire_at_a_surface_is_whole_and_the_surface_is_not_thin():
    rng = np.random.default_rng(1)
    sheet = np.column_stack([rng.random((40_000, 2)), np.zeros(40_000)])
    wire = np.linspace(0.0, 1.0, 4000)[:, None] * [1.0, 0.0, 0.0] + [1.0, 0.5, 0.0]
    cloud = cloud_of(np.concatenate([sheet, wire]))
    thin = measure_discs(cloud).thin
    assert not thin[:40_000].any()
    assert thin[40_000:].mean() > 0.98
    columns = np.flatnonzero(drawn(cloud, view={"orbit": (0.0, 0.0)}).any(axis=0))
    assert len(columns) == columns[-1] - columns[0] + 1 > 80


@pytest.mark.parametrize("distance", [9, 12])
def test_a_surface_from_afar_grows_no_fatter(distance):
    rng = np.random.default_rng(2)
    cloud = cloud_of(np.column_stack([rng.random((200_000, 2)), np.zeros(200_000)]))
    discs = measure_discs(cloud)
    view = fit_view(cloud, size=(96, 80), orbit=(0.0, 0.0))
    view = dataclasses.replace(view, focal=view.focal / distance)
    half = 0.5 * view.focal / np.abs(view.eye[2])
    assert half % 1.0 < 0.25  # its outermost points lie beyond the centres of the last pixels
    seen = golden.render(make_frame(cloud, view, **discs._asdict())).drawn
    assert seen.sum() == (2 * int(half)) ** 2


def test_points_at_one_position_are_one_pixel_at_least():
    cloud = cloud_of(np.zeros((50, 3)))
    view = fit_view(cloud, size=(64, 48))
    discs = measure_discs(cloud)
    frames = make_frames(cloud, view, 4, **discs._replace(radii=1e-9 * discs.radii)._asdict())
    assert all(golden.render(frame).drawn.sum() == 1 for frame in frames)
