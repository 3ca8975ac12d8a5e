import numpy as np
import pytest

from splatline.host.encode.quality import QUALITIES
from splatline.host.files.readers import read_cloud
from splatline.sim.stress.case import measure
from splatline.sim.stress.small_clouds import sphere
from splatline.sim.stress.themes import themes

CASES = themes()["normals"].cases


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_normals_of_any_length_or_none_give_a_sound_picture(case, quality):
    assert measure(case, quality).problems == ()


@pytest.mark.parametrize("broken", [0.0, np.nan, np.inf, -np.inf])
def test_normals_come_out_of_a_file_of_unit_length_and_the_broken_ones_estimated(tmp_path, broken):
    ball = sphere(600)
    lengths = 10.0 ** np.random.default_rng(1).uniform(-300.0, 300.0, (600, 1))
    normals = ball.normals * lengths
    normals[::7] = broken
    path = tmp_path / "ball.npz"
    np.savez(path, positions=ball.positions, normals=normals)
    cloud = read_cloud(path)
    two_sided = np.arange(600) % 7 == 0
    assert np.array_equal(cloud.two_sided, two_sided)
    assert np.abs(np.linalg.norm(cloud.normals, axis=1) - 1.0).max() < 1e-6
    cosine = np.abs((cloud.normals * ball.normals).sum(axis=1))
    assert cosine[~two_sided].min() > 1.0 - 1e-6
    assert cosine[two_sided].min() > 0.9
