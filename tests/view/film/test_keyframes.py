import json

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.view.camera import Camera
from splatline.view.film.keyframes import read_path

HOME = Camera((1.0, 2.0, 3.0), 10.0, 30.0, 20.0, "z", 40.0)


def path_of(tmp_path, keys):
    (tmp_path / "path.json").write_text(json.dumps(keys))
    return read_path(tmp_path / "path.json", HOME)


def test_json_and_csv_tell_the_same(tmp_path):
    one = path_of(
        tmp_path,
        [
            {"time": 0, "azimuth": 30, "elevation": 20},
            {"time": 2, "azimuth": 120, "elevation": 60, "distance": 14.5},
            {"time": 5, "azimuth": 200, "target": [1.5, 0, -2]},
        ],
    )
    table = tmp_path / "path.csv"
    table.write_text(
        "time,azimuth,elevation,distance,x,y,z\n0,30,20,,,,\n\n2,120,60,14.5,,,\n5,200,,,1.5,0,-2\n"
    )
    other = read_path(table, HOME)
    assert (one.times == other.times).all()
    assert (one.values == other.values).all()
    assert one.values[2].tolist() == [200.0, 20.0, 10.0, 1.5, 0.0, -2.0]
    assert one.seconds == 5.0
    assert one.lens.fov == HOME.fov


def test_the_camera_passes_through_the_keyframes(tmp_path):
    keys = [
        {"time": 1.0, "azimuth": 170, "elevation": 10},
        {"time": 2.0, "azimuth": -170, "elevation": 30, "distance": 40},
        {"time": 4.0, "azimuth": -100, "elevation": 0, "distance": 5, "target": [4, 0, 0]},
    ]
    path = path_of(tmp_path, keys)
    assert not path.is_closed
    cameras = path.cameras(31)
    for key in keys:
        camera = cameras[round(10 * (key["time"] - 1.0))]
        assert camera.azimuth == pytest.approx(key["azimuth"])
        assert camera.elevation == pytest.approx(key["elevation"], abs=1e-9)
        assert camera.distance == pytest.approx(key.get("distance", 10.0))
    # The short way: never through azimuth 0.
    assert all(abs(camera.azimuth) > 90.0 for camera in cameras)
    assert {(camera.up, camera.fov) for camera in cameras} == {("z", 40.0)}
    steps = np.diff(np.unwrap([camera.azimuth for camera in path.cameras(301)], period=360.0))
    assert np.abs(np.diff(steps)).max() < 0.02  # without a jerk
    assert min(camera.distance for camera in cameras) > 0.0


def test_a_straight_way_in_even_time_is_even(tmp_path):
    keys = [{"time": time, "azimuth": 20 * time, "elevation": 5 * time} for time in range(5)]
    cameras = path_of(tmp_path, keys).cameras(41)
    assert [camera.azimuth for camera in cameras] == pytest.approx(np.linspace(0.0, 80.0, 41))
    assert [camera.elevation for camera in cameras] == pytest.approx(np.linspace(0.0, 20.0, 41))


def test_a_closed_path_ends_a_step_before_it_began(tmp_path):
    keys = [{"time": time, "azimuth": azimuth} for time, azimuth in enumerate((0, 120, 240, 360))]
    path = path_of(tmp_path, keys)
    assert path.is_closed
    cameras = path.cameras(30)
    steps = np.diff([each.azimuth for each in [*cameras, cameras[0]]]) % 360.0
    assert steps == pytest.approx(np.full(30, 12.0))


def test_an_elevation_stops_at_the_pole(tmp_path):
    keys = [{"time": time, "elevation": each} for time, each in enumerate((0, 88, 90, 0))]
    elevations = [camera.elevation for camera in path_of(tmp_path, keys).cameras(100)]
    assert max(elevations) == 90.0


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("a.json", "{", "is no JSON"),
        ("a.json", '{"time": 0}', "a list of objects"),
        ("a.json", '[{"time": 0}]', "keyframes"),
        ("a.json", '[{"time": 0}, {"time": 0}]', "ascend"),
        ("a.json", '[{"time": 0}, {"azimuth": 0}]', "no time"),
        ("a.json", '[{"time": 0}, {"time": 1, "angle": 3}]', "'angle'"),
        ("a.json", '[{"time": 0}, {"time": NaN}]', "time of keyframe 2"),
        ("a.json", '[{"time": 0}, {"time": 1, "distance": 0}]', "above 0"),
        ("a.json", '[{"time": 0}, {"time": 1, "elevation": 91}]', "-90 to 90"),
        ("a.json", '[{"time": 0}, {"time": 1, "target": [1, 2]}]', "three numbers"),
        ("a.json", '[{"time": 0}, {"time": 1, "azimuth": "north"}]', "'north'"),
        ("a.json", '[{"time": 0}, {"time": 1, "azimuth": true}]', "True"),
        ("a.csv", "time,azimuth\n0,1,2\n1,2\n", "has 3 values"),
        ("a.csv", "", "keyframes"),
        ("a.csv", "\udcff", "is no text"),
        ("a.json", "[" * 100_000, "is no JSON"),
    ],
)
def test_a_bad_path_is_told_in_a_line(tmp_path, name, text, told):
    file = tmp_path / name
    file.write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(InputError, match=told) as error:
        read_path(file, HOME)
    assert str(error.value).startswith(f"{file}: ")
    assert "\n" not in str(error.value)
