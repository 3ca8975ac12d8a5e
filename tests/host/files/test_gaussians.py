"""PLY files of Gaussian splats, in the columns of the reference implementation's writer."""

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.cloud.bulk import select
from splatline.host.cloud.spacing import measure_discs
from splatline.host.files.readers import read_cloud
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
    assert np.abs((cloud.normals * axes).sum(axis=1)) == pytest.approx(1.0, abs=1e-6)
    assert cloud.two_sided.all()


def test_a_disc_has_the_area_that_the_opacity_adds_up_to(tmp_path):
    cloud = read(tmp_path, gaussians())
    larger = np.exp(np.sort(SCALES, axis=1)[:, 1:])
    steps = np.linspace(-8.0, 8.0, 401)
    bell = np.exp(-0.5 * steps**2).sum() * (steps[1] - steps[0])
    area = ALPHA * bell * larger[:, 0] * bell * larger[:, 1]
    assert np.pi * cloud.radii**2 == pytest.approx(area[SEEN], rel=1e-5)


def test_the_radii_are_those_of_the_discs_unless_a_size_is_asked_for(tmp_path):
    cloud = read(tmp_path, gaussians())
    assert np.array_equal(measure_discs(cloud).radii, cloud.radii)
    assert (measure_discs(cloud, 0.5).radii == 0.25).all()
    kept = np.arange(len(cloud)) % 3 == 0
    assert np.array_equal(select(cloud, kept).radii, cloud.radii[kept])


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
