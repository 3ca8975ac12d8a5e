"""The everyday names: ``import splatline``."""

import ast
import io
import os
import subprocess
import sys
from pathlib import Path

import laspy
import numpy as np
import pytest
from PIL import Image

import splatline
from splatline.cli.main import main
from splatline.contract.errors import InputError
from splatline.host.files.wanted import ColourBy
from splatline.view import prepared
from tests.support.clouds import sphere

IMPORT = """
import sys, time
begin = time.process_time()
import splatline
print(time.process_time() - begin, *sorted({"numpy", "numba", "click", "PIL"} & set(sys.modules)))
"""

LAYER = """
import os, sys
import splatline
from splatline.view.pixels import rgba_bytes
from splatline.contract.raster import Raster
import numba
rgba_bytes([Raster.background(8, 8)], (0.0, 0.0, 0.0))
print(numba.threading_layer(), os.environ["OMP_WAIT_POLICY"])
"""


@pytest.mark.parametrize(
    ("asked", "layer"),
    [
        ({}, "omp passive"),
        ({"NUMBA_THREADING_LAYER": "workqueue"}, "workqueue passive"),
        ({"OMP_WAIT_POLICY": "active"}, "omp active"),
    ],
)
def test_openmp_runs_parallel_loops_unless_the_environment_says_otherwise(asked, layer):
    names = ("NUMBA_THREADING_LAYER", "NUMBA_THREADING_LAYER_PRIORITY", "OMP_WAIT_POLICY")
    usual = {name: value for name, value in os.environ.items() if name not in names}
    run = subprocess.run(
        [sys.executable, "-c", LAYER], env=usual | asked, capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == layer


@pytest.fixture
def scan(tmp_path, monkeypatch):
    """A ball in ``scan.ply`` of the current folder."""
    points = sphere(600).positions
    head = "ply\nformat ascii 1.0\nelement vertex 600\n"
    head += "".join(f"property float {name}\n" for name in "xyz") + "end_header\n"
    rows = "\n".join(" ".join(map(str, row)) for row in points)
    (tmp_path / "scan.ply").write_text(f"{head}{rows}\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path / "scan.ply"


def pixels(data):
    return np.array(Image.open(io.BytesIO(data)))


def test_every_name_is_there():
    for name in splatline.__all__:
        assert getattr(splatline, name) is not None
    assert set(dir(splatline)) == set(splatline.__all__)
    with pytest.raises(AttributeError, match="absent"):
        _ = splatline.absent


def test_the_import_is_quick_and_brings_nothing():
    runs = [
        subprocess.run(
            [sys.executable, "-c", IMPORT], capture_output=True, text=True, check=True
        ).stdout.split()
        for _ in range(3)
    ]
    assert all(len(run) == 1 for run in runs), runs
    assert min(float(run[0]) for run in runs) < 0.05


def test_the_three_lines_draw_what_the_command_line_draws(scan, monkeypatch):
    lines = [line[4:] for line in splatline.__doc__.splitlines() if line.startswith(">>> ")]
    assert len(lines) == 3
    exec("\n".join(lines), {})
    told = ast.parse(lines[-1]).body[0].value.func.value.keywords
    options = {word.arg: ast.literal_eval(word.value) for word in told}
    assert options == {"size": (480, 360), "samples": 4}
    main(
        ["render", "scan.ply", "--size", "480x360", "--samples", "4", "-o", "other.png"],
        standalone_mode=False,
    )
    assert Path("scan.png").read_bytes() == Path("other.png").read_bytes()


def test_a_file_a_cloud_and_a_camera_draw_the_same(scan):
    one = splatline.render(scan, size=(64, 48), orbit=(50.0, 10.0))
    two = splatline.render(splatline.read_cloud(scan), size=(64, 48), orbit=(50.0, 10.0))
    assert (one.rgb == two.rgb).all()
    assert one.size == (64, 48)
    assert one.rgb.shape == (48, 64, 3)
    camera = splatline.Camera((0.0, 0.0, 0.0), 4.0, 50.0, 10.0)
    aimed = splatline.render(scan, size=(64, 48), camera=camera)
    assert aimed.counts["elements"] > 100
    with pytest.raises(InputError, match="not both"):
        splatline.render(scan, camera=camera, fov=20.0)


def test_a_picture_shows_itself_in_a_notebook(scan):
    picture = splatline.render(scan, size=(32, 24))
    assert (pixels(picture._repr_png_()) == picture.rgb).all()
    assert "32x24" in repr(picture)
    assert "rgb24" in repr(picture)
    with pytest.raises(InputError, match=r"\.png"):
        picture.save("picture.jpg")


def test_a_scene_is_seen_as_the_command_line_sees_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    picture = splatline.render(splatline.load_scene("terrain"), size=(48, 32), preset="paper")
    main(
        ["render", "--size", "48x32", "--preset", "paper", "-o", "terrain.png"],
        standalone_mode=False,
    )
    assert (pixels(Path("terrain.png").read_bytes()) == picture.rgb).all()


def test_the_last_cloud_is_prepared_once(monkeypatch):
    made = []
    prepare = prepared.live_cloud
    monkeypatch.setattr(
        prepared, "live_cloud", lambda *args, **more: made.append(1) or prepare(*args, **more)
    )
    first, second = sphere(300), sphere(300, seed=2)
    for cloud in (first, first, second, second):
        splatline.render(cloud, size=(24, 24))
    splatline.render(second, size=(24, 24), colour="height")
    splatline.render(second, size=(24, 24), colour=ColourBy("height", "turbo"))
    assert len(made) == 4
    with pytest.raises(InputError, match="read_cloud"):
        splatline.render(second, colour="intensity")


@pytest.mark.parametrize(
    ("option", "told"),
    [
        ({"preset": "absent"}, "preset"),
        ({"lights": "absent"}, "lights"),
        ({"background": "absent"}, "#rrggbb"),
        ({"background": (0.1, 0.2, 7.0)}, "0..1"),
        ({"samples": 3}, "samples"),
        ({"quality": "absent"}, "absent"),
        ({"fov": 180.0}, "field of view"),
    ],
)
def test_a_bad_option_is_told_in_a_line(option, told):
    with pytest.raises(InputError, match=told) as error:
        splatline.render(sphere(50), size=(16, 16), **option)
    assert "\n" not in str(error.value)


def test_a_survey_s_z_points_up(tmp_path):
    points = laspy.create(point_format=0, file_version="1.2")
    points.x, points.y, points.z = (sphere(200).positions * (3.0, 2.0, 1.0)).T
    points.write(tmp_path / "scan.las")
    cloud = splatline.read_cloud(tmp_path / "scan.las", colour="height")
    assert cloud.up == "z"
    assert cloud.colour_key["up"] == "z"
    same = splatline.render(str(tmp_path / "scan.las"), size=(24, 24), up="z", colour="height")
    assert (splatline.render(cloud, size=(24, 24)).rgb == same.rgb).all()
