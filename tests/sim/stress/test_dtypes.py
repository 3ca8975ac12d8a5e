import numpy as np
import pytest
from plyfile import PlyData, PlyElement

from splatline.host.cloud.spacing import splat_radii
from splatline.host.encode.quality import QUALITIES
from splatline.host.files.readers import read_cloud
from splatline.host.visibility.view import fit_view
from splatline.sim.stress.case import Scene, draw, measure
from splatline.sim.stress.small_clouds import SIZE, fitted, on_grid, sphere
from splatline.sim.stress.themes import themes

CASES = themes()["dtypes"].cases


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_same_values_of_any_type_are_the_same_picture(case, quality):
    assert measure(case, quality).problems == ()


def words_of(path):
    cloud = read_cloud(path)
    return draw(Scene(cloud, fit_view(cloud, size=SIZE), splat_radii(cloud)), "exact")[0].codewords


@pytest.mark.parametrize("dtype", ["f2", "f4", ">f4", "f8", ">f8", "i2", ">i4", "i8"])
def test_an_npz_file_of_any_type_is_the_same_picture(tmp_path, dtype):
    ball = on_grid(sphere(600), 2.0**-6)
    scale = 64.0 if "i" in dtype else 1.0
    path = tmp_path / "ball.npz"
    places = (ball.positions * scale).astype(dtype)
    np.savez(path, positions=places, normals=ball.normals, colours=ball.colours)
    assert np.array_equal(words_of(path), draw(fitted(ball), "exact")[0].codewords)


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("dtype", ["f4", "f8", "i2", "i4"])
def test_a_ply_file_of_any_type_and_order_is_the_same_picture(tmp_path, dtype, order):
    ball = on_grid(sphere(600), 2.0**-6)
    scale = 64.0 if "i" in dtype else 1.0
    fields = [(axis, dtype) for axis in "xyz"] + [(f"n{axis}", "f8") for axis in "xyz"]
    fields += [(name, "u1") for name in ("red", "green", "blue")]
    rows = np.empty(len(ball.positions), fields)
    for axis in range(3):
        rows["xyz"[axis]] = ball.positions[:, axis] * scale
        rows["n" + "xyz"[axis]] = ball.normals[:, axis]
        rows[("red", "green", "blue")[axis]] = ball.colours[:, axis]
    path = tmp_path / "ball.ply"
    PlyData([PlyElement.describe(rows, "vertex")], byte_order=order).write(path)
    assert np.array_equal(words_of(path), draw(fitted(ball), "exact")[0].codewords)
