"""PLY files of Gaussian splats, in the columns of the reference implementation's writer."""

import dataclasses

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.cloud.bulk import select
from splatline.host.cloud.spacing import measure_discs
from splatline.host.files.assemble import Columns, assemble_cloud
from splatline.host.files.readers import read_cloud
from splatline.host.pipeline import make_frame
from splatline.host.visibility.view import fit_view
from splatline.sim import golden
from splatline.sim.reference.wholeness import pinholes
from tests.host.files.cloud_files import COLOURS, COUNT, POSITIONS, places
from tests.host.files.gaussian_files import OPACITY, ROTATIONS, SCALES, gaussians, ply_bytes

ALPHA = 1.0 / (1.0 + np.exp(-OPACITY))
SEEN = ALPHA >= 0.3


def matrices(rotations):
    """Rotation matrices of quaternions, element by element."""
    w, x, y, z = (rotations / np.linalg.norm(rotations, axis=1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def read(folder, rows):
    (folder / "a.ply").write_bytes(ply_bytes(rows))
    return read_cloud(folder / "a.ply")


def test_centres_and_colours_of_the_splats_that_are_opaque_enough(tmp_path):
    cloud = read(tmp_path, gaussians())
    assert places(cloud) == pytest.approx(POSITIONS[SEEN].astype(float), abs=1e-6)
    assert np.array_equal(cloud.colours, COLOURS[SEEN])
    assert cloud.dropped == {"non_finite": 0, "transparent": np.count_nonzero(~SEEN)}
    assert cloud.used["rot_0"] == "orientation"
    assert cloud.ignored[:3] == ("nx", "ny", "nz")
    assert len(cloud.ignored) == 48


def test_a_disc_lies_across_the_smallest_axis(tmp_path):
    cloud = read(tmp_path, gaussians())
    axes = matrices(ROTATIONS)[np.arange(COUNT), :, SCALES.argmin(axis=1)][SEEN]
    sizes = np.sort(SCALES, axis=1)[SEEN]
    flat = sizes[:, 0] <= sizes[:, 1] + np.log(0.7)
    assert 20 < np.count_nonzero(flat) < len(cloud)
    assert np.abs((cloud.normals * axes).sum(axis=1))[flat] == pytest.approx(1.0, abs=1e-6)
    told = np.count_nonzero(~flat)
    assert cloud.notes == (f"{told} splats are round, so their normals are estimated",)
    assert cloud.two_sided.all()


def test_a_disc_has_the_area_that_the_opacity_adds_up_to(tmp_path):
    cloud = read(tmp_path, gaussians())
    larger = np.exp(np.sort(SCALES, axis=1)[:, 1:])
    steps = np.linspace(-8.0, 8.0, 401)
    bell = np.exp(-0.5 * steps**2).sum() * (steps[1] - steps[0])
    area = ALPHA * bell * larger[:, 0] * bell * larger[:, 1]
    assert np.pi * cloud.radii**2 == pytest.approx(area[SEEN], rel=1e-5)


def test_the_radii_are_those_of_the_discs_unless_a_size_is_asked_for(tmp_path):
    cloud = read(tmp_path, gaussians(scales=SCALES + 6.0))
    discs = measure_discs(cloud)
    assert np.array_equal(discs.radii, cloud.radii)
    assert not discs.thin.any()
    assert (measure_discs(cloud, 0.5).radii == 0.25).all()
    kept = np.arange(len(cloud)) % 3 == 0
    assert np.array_equal(select(cloud, kept).radii, cloud.radii[kept])


def sphere_of_splats(scales):
    """Splats on a sphere of which most programs would make points: opaque, in one colour."""
    count = 1500
    rows = np.zeros(count, gaussians().dtype)
    height = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    ring, turn = np.sqrt(1.0 - height**2), 2.39996323 * np.arange(count)
    rows["x"], rows["y"], rows["z"] = ring * np.cos(turn), ring * np.sin(turn), height
    rows["opacity"], rows["rot_0"] = 5.0, 1.0
    for axis, scale in enumerate(scales):
        rows[f"scale_{axis}"] = np.log(scale)
    for axis, value in enumerate((0.9, 0.5, 0.2)):
        rows[f"f_dc_{axis}"] = (value - 0.5) / 0.28209479177387814
    return rows


@pytest.mark.parametrize("scales", [(0.03, 0.03, 0.03), (0.001, 0.00101, 0.0009), (0.2, 0.2, 0.2)])
def test_round_splats_are_a_whole_surface_as_bright_as_points(tmp_path, scales):
    rows = sphere_of_splats(scales)
    cloud = read(tmp_path, rows)
    points = assemble_cloud(
        Columns(np.stack([rows[axis] for axis in "xyz"], axis=-1), None, cloud.colours), "points"
    )
    view = fit_view(points, size=(64, 64))
    of_splats, of_points = (
        golden.render(make_frame(each, view, **measure_discs(each)._asdict()))
        for each in (cloud, points)
    )
    assert not pinholes(of_splats.drawn).any()
    assert (of_splats.drawn >= of_points.drawn).all()
    bright = [r.to_rgb()[r.drawn].astype(float) for r in (of_splats, of_points)]
    assert bright[0].mean() == pytest.approx(bright[1].mean(), rel=0.1)
    assert bright[0].max() == pytest.approx(bright[1].max(), rel=0.1)


def test_flat_splats_that_are_too_small_close_the_surface_and_keep_their_axes(tmp_path):
    cloud = read(tmp_path, sphere_of_splats((0.004, 0.004, 0.001)))
    assert np.abs(cloud.normals[:, 2]) == pytest.approx(1.0)
    discs = measure_discs(cloud)
    assert (discs.radii >= cloud.radii).all()
    assert np.median(discs.radii) > 5 * np.median(cloud.radii)
    large = cloud.radii.copy()
    large[::2] = 1.0  # half of them are large enough
    assert np.array_equal(measure_discs(dataclasses.replace(cloud, radii=large)).radii, large)


def test_splats_without_a_size_are_left_out(tmp_path):
    scales = SCALES.copy()
    scales[-1], scales[-2], scales[-3] = np.nan, 1e30, -1e30
    cloud = read(tmp_path, gaussians(scales=scales))
    assert cloud.dropped["without_size"] == 3
    assert np.isfinite(cloud.radii).all()


def test_no_splat_that_is_opaque(tmp_path):
    with pytest.raises(InputError, match=r"none of its 60 splats has an opacity of 0\.3"):
        read(tmp_path, gaussians(opacity=np.full(COUNT, -5.0)))


def test_harmonics_alone_are_colours_of_points(tmp_path):
    rows = gaussians()
    names = [name for name in rows.dtype.names if not name.startswith(("rot", "scale"))]
    cloud = read(tmp_path, np.array(rows[names].tolist(), [(name, "f4") for name in names]))
    assert len(cloud) == COUNT
    assert cloud.radii is None
    assert np.array_equal(cloud.colours, COLOURS)
