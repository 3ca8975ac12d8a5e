"""The options --colour, --map and --range of ``render`` and ``encode``."""

import json

import numpy as np
import pytest

from splatline import host
from splatline.host.files.wanted import ColourBy
from tests.host.files.kinds import SPHERE, XYZ_PLY, ply

CLASS = np.array([2, 6, 77])[np.arange(len(SPHERE)) % 3]


@pytest.fixture
def scan(tmp_path):
    """A sphere without colours, with classes and a time."""
    path = tmp_path / "scan.ply"
    names = [*XYZ_PLY, "uchar classification", "double time"]
    path.write_bytes(ply(names, [*SPHERE.T, CLASS, 1e9 + np.arange(len(SPHERE)) / 8]))
    return path


def render(run, folder, *arguments):
    result = run("render", *arguments, "--size", "32x32", "-o", "a.png", "--stats", "a.json")
    assert result.exit_code == 0, result.stderr
    told = " ".join(result.stdout.replace("│", " ").split())
    return told, json.loads((folder / "a.json").read_text())["colour"]


def test_a_file_is_coloured_by_height_along_up(run, folder, scan):
    told, key = render(run, folder, scan, "--colour", "height", "--up", "-z", "--map", "magma")
    assert (key["by"], key["up"], key["map"]) == ("height", "-z", "magma")
    assert key["range"] == pytest.approx([-SPHERE[:, 2].max(), -SPHERE[:, 2].min()], abs=1e-6)
    assert "coloured by height along -z, -0.98333 to 0.98333, map magma" in told


def test_the_picture_is_that_of_the_colours(run, folder, scan):
    """The options reach the file: the picture is that of a file with these colours."""
    options = ["--size", "32x32", "--up", "z"]
    assert run("render", scan, *options, "--colour", "time", "--map", "turbo").exit_code == 0
    colours = host.read_cloud(scan, colour=ColourBy("time", "turbo")).colours
    rgb = [f"uchar {name}" for name in ("red", "green", "blue")]
    (folder / "own.ply").write_bytes(ply([*XYZ_PLY, *rgb], [*SPHERE.T, *colours.T]))
    assert run("render", "own.ply", *options).exit_code == 0
    assert (folder / "own.png").read_bytes() == (folder / "scan.png").read_bytes()


@pytest.mark.parametrize("option", ["--colour", "--color"])
def test_a_range_has_the_digits_that_tell_its_ends_apart(run, folder, scan, option):
    told, key = render(run, folder, scan, option, "TIME", "--range", "1e9,1000000007.5")
    assert key["range"] == [1e9, 1e9 + 7.5]
    assert "coloured by time, 1,000,000,000 to 1,000,000,007.5, map viridis" in told


def test_classes_are_listed_with_colours_and_counts(run, folder, scan):
    told, key = render(run, folder, scan, "--colour", "classification")
    assert [item["points"] for item in key["classes"]] == [20, 20, 20]
    assert "class 2 #a1522e ground, 20 points class 6 #ff5555 building, 20 points" in told
    assert "class 77 #" in told
    encoded = run("encode", scan, "--colour", "classification", "-o", "a.frame")
    assert "#a1522e ground, 20 points" in encoded.stdout


def test_without_the_option_no_key_is_told(run, folder, scan):
    told, key = render(run, folder, scan)
    assert key is None
    assert "coloured by" not in told


def test_a_built_in_scene_has_heights(run, folder):
    told, key = render(run, folder, "--colour", "height")
    assert key["up"] == "z"
    assert "coloured by height along z, 826 to 3,766, map viridis" in told
    assert render(run, folder, "--colour", "rgb")[1] is None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--colour", "speed"], "no field 'speed'; its fields are x, y, z, classification, time"),
        (["--colour", "rgb"], "has no colours; its fields are x, y, z, classification, time"),
        (["--colour", "intensity"], "has no intensity; its fields are x, y, z, class"),
        (["--colour", "time", "--map", "viridi"], "there is no colour map 'viridi'; there are: v"),
        (["--colour", "time", "--range", "5"], "'5' is not a range; write LOW,HIGH"),
        (["--colour", "time", "--range", "5,5"], "'5,5' is not a range; write LOW,HIGH"),
        (["--colour", "time", "--range", "a,5"], "'a,5' is not a range"),
        (["--colour", "time", "--range", "nan,5"], "'nan,5' is not a range"),
        (["--colour", "classification", "--map", "jet"], "by classification need no map"),
        (["--colour", "rgb", "--range", "0,1"], "by rgb need no range"),
        (["--map", "jet"], "--map needs --colour"),
        (["--range", "0,1"], "--range needs --colour"),
    ],
)
@pytest.mark.parametrize("command", [["render"], ["encode", "-o", "a.frame"]])
def test_what_cannot_be_gets_one_line(run, folder, scan, command, arguments, words):
    result = run(*command, scan, *arguments)
    assert result.exit_code == 2, result.exception
    told = [line for line in result.stderr.splitlines() if not line.endswith("...")]
    assert len(told) == 1
    assert told[0].startswith("splatline: ")
    assert words in told[0]
    assert not list(folder.iterdir())


@pytest.mark.parametrize("field", ["intensity", "classification", "speed"])
def test_a_scene_says_what_it_has(run, folder, field):
    result = run("render", "--scene", "knot", "--colour", field)
    assert result.exit_code == 2
    assert result.stderr.splitlines()[-1] == (
        f"splatline: the scene knot has no field '{field}'; it has rgb and height"
    )
    assert not list(folder.iterdir())
