"""E57 files, written by hand from the standard."""

import struct
import sys

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.colours import NEUTRAL
from splatline.host.files.readers import read_cloud
from tests.host.files.cloud_files import COLOURS, COUNT, NORMALS, POSITIONS, places
from tests.host.files.e57_files import colours, coordinates, e57, paged, pose, unpaged

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
HALF = float(np.sqrt(0.5))
MOVE = (654321.0, 5212345.5, 17.25)
QUARTER = pose((HALF, 0.0, 0.0, HALF), MOVE)
"""A quarter of a turn about z, and a way into map coordinates."""


def read(folder, data):
    path = folder / "a.e57"
    path.write_bytes(data)
    return read_cloud(path)


@pytest.mark.parametrize(("kind", "error"), [("f", 0.0), ("d", 0.0), ("S", 0.0006)])
def test_points_and_colours(tmp_path, kind, error):
    cloud = read(tmp_path, e57(coordinates(POSITIONS, kind) | colours(COLOURS)))
    assert places(cloud) == pytest.approx(POSITIONS.astype(float), abs=error + 1e-12, rel=0)
    assert np.array_equal(cloud.colours, COLOURS)
    assert cloud.used["colorRed"] == "colour"


def test_colours_of_16_bits(tmp_path):
    cloud = read(tmp_path, e57(coordinates(POSITIONS) | colours(COLOURS.astype(int) * 257, "H")))
    assert np.array_equal(cloud.colours, COLOURS)


def test_an_intensity_is_grey(tmp_path):
    columns = coordinates(POSITIONS) | {"intensity": ("f", np.arange(COUNT) / COUNT)}
    cloud = read(tmp_path, e57(columns))
    assert cloud.used["intensity"] == "intensity, as grey"
    assert (np.diff(cloud.colours[:, 0].astype(int)) >= 0).all()


def test_each_scan_is_moved_by_its_pose_to_the_millimetre(tmp_path):
    first = coordinates(POSITIONS) | {"pose": QUARTER}
    second = coordinates(POSITIONS, "S") | {"pose": pose((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 9.0))}
    cloud = read(tmp_path, e57(first, second))
    expected = np.vstack(
        [POSITIONS @ TURN.T + MOVE, np.round(POSITIONS, 3) + np.array([0.0, 0.0, 9.0])]
    )
    assert places(cloud) == pytest.approx(expected, abs=1e-3, rel=0)
    assert places(cloud)[:COUNT] == pytest.approx(expected[:COUNT], abs=1e-8, rel=0)


def test_normals_turn_with_the_pose(tmp_path):
    normals = coordinates(NORMALS, "f", ("nor__normalX", "nor__normalY", "nor__normalZ"))
    space = ' xmlns:nor="http://www.libe57.org/E57_NOR_surface_normals.txt"'
    cloud = read(
        tmp_path, e57(coordinates(POSITIONS) | normals | {"pose": QUARTER}, namespace=space)
    )
    assert cloud.normals == pytest.approx(NORMALS @ TURN.T, abs=1e-6)
    assert not cloud.two_sided.any()


def test_spherical_coordinates(tmp_path):
    distance = np.linalg.norm(POSITIONS.astype(float), axis=1)
    azimuth = np.arctan2(POSITIONS[:, 1], POSITIONS[:, 0])
    elevation = np.arcsin(POSITIONS[:, 2] / distance)
    rows = np.column_stack([distance, azimuth, elevation])
    names = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
    cloud = read(tmp_path, e57(coordinates(rows, "d", names)))
    assert places(cloud) == pytest.approx(POSITIONS.astype(float), abs=1e-6)


def test_a_structured_scan_without_the_returns_that_are_invalid(tmp_path):
    state = np.zeros(COUNT, int)
    state[:7], state[7:9] = 2, 1
    rows = {"rowIndex": ("H", np.arange(COUNT) // 6), "columnIndex": ("H", np.arange(COUNT) % 6)}
    columns = coordinates(POSITIONS) | rows | {"cartesianInvalidState": ("B", state)}
    cloud = read(tmp_path, e57(columns))
    assert places(cloud) == pytest.approx(POSITIONS[9:].astype(float), abs=1e-9)
    assert cloud.dropped == {"non_finite": 0, "invalid": 9}
    assert cloud.ignored == ("rowIndex", "columnIndex")


def test_a_scan_without_colours_beside_one_with_colours(tmp_path):
    cloud = read(tmp_path, e57(coordinates(POSITIONS) | colours(COLOURS), coordinates(POSITIONS)))
    assert np.array_equal(cloud.colours[:COUNT], COLOURS)
    assert (cloud.colours[COUNT:] == NEUTRAL).all()


def test_wrong_files(tmp_path):
    whole = e57(coordinates(POSITIONS))
    text = unpaged(whole)
    for data, message in (
        (whole[:-10], "does not fit the file's size"),
        (whole[:24] + struct.pack("<Q", 1 << 60) + whole[32:], "does not fit the file's size"),
        (e57(), "has no points"),
        (e57(coordinates(POSITIONS), count=0), "has no points"),
        (e57(coordinates(POSITIONS), count=1 << 40), "promises 1,099,511,627,776 points, more"),
        (e57(coordinates(POSITIONS), count=61), "ends after 60 of a scan's 61 points"),
        (e57({"intensity": ("f", np.arange(COUNT))}), "scans without coordinates"),
        (paged(text.replace(b"<guid type", b"<!DOCTYPE e")), "declarations of its own"),
        (whole[:100] + b"x" + whole[101:], "cannot be read as E57"),
    ):
        with pytest.raises(InputError, match=message):
            read(tmp_path, data)
    assert (tmp_path / "a.e57").exists()


def test_without_the_extra_a_line_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pye57", None)
    with pytest.raises(InputError, match=r"E57 needs pye57: pip install '\.\[e57\]'"):
        read(tmp_path, e57(coordinates(POSITIONS)))
