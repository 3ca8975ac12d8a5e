"""A camera that looks at a point, and lights: options of every command that draws."""

import json

import numpy as np
import pytest
from PIL import Image

from splatline.cli.commands import render as render_command

AIM = ("--target", "0.25,-0.5,0", "--distance", 4)


def pixels(path):
    return np.asarray(Image.open(path))


def test_the_target_stands_in_the_middle_at_its_distance(run, folder, cloud):
    """A point of the ball at x = 1, seen from along x: the middle pixel shows it, 3 units away."""
    options = ("--orbit", "90,0", "--up", "y", "--target", "1,0,0", "--distance", 3)
    result = run("render", cloud, *options, "-o", "a.png", "--stats", "a.json", "--depth", "d.png")
    assert result.exit_code == 0, result.output
    stats = json.loads((folder / "a.json").read_text())
    assert stats["view"]["target"] == [1.0, 0.0, 0.0]
    assert stats["view"]["distance"] == 3.0
    near, far = stats["depth_range"]
    share = 1.0 - pixels("d.png")[256, 256] / 65535.0
    assert near + share * (far - near) == pytest.approx(3.0, abs=0.02)


def test_the_distance_sets_the_size(run, folder, cloud):
    """Twice as far, half as wide."""
    widths = []
    for distance in (8, 16):
        run("render", cloud, "--target", "0,0,0", "--distance", distance, "-o", "a.png")
        drawn = (pixels("a.png") != pixels("a.png")[0, 0]).any(axis=2)
        widths.append(int(drawn.any(axis=0).sum()))
    assert widths[0] == pytest.approx(2 * widths[1], abs=4)


@pytest.mark.parametrize("given", [AIM[:2], AIM[2:]])
@pytest.mark.parametrize("command", ["render", "encode"])
def test_one_of_the_pair_alone_is_an_error_of_one_line(run, folder, cloud, command, given):
    result = run(command, cloud, *given, "-o", "a.png")
    assert result.exit_code == 2
    assert "--target and --distance go together" in result.output
    assert result.output.count("\n") == 1
    assert not list(folder.iterdir())


@pytest.mark.parametrize(
    "options",
    [
        ("--target", "1,2", "--distance", 1),
        ("--target", "1,2,nan", "--distance", 1),
        ("--target", "1,2,3,", "--distance", 1),
        ("--target", "1,2,3", "--distance", 0),
        ("--target", "1,2,3", "--distance", -1),
        ("--target", "1,2,3", "--distance", "inf"),
        ("--lights", "disco"),
    ],
)
def test_a_value_out_of_range_is_an_error_of_one_line(run, folder, cloud, options):
    result = run("render", cloud, *options)
    assert result.exit_code == 2
    assert result.output.count("\n") == 1


def test_lights_and_target_reach_encode(run, folder, cloud):
    """Also that of code words in a file."""
    options = (*AIM, "--lights", "none", "--size", "300x200")
    assert run("render", cloud, *options, "-o", "whole.png").exit_code == 0
    assert run("render", cloud, *AIM, "--size", "300x200", "-o", "lit.png").exit_code == 0
    assert not np.array_equal(pixels("whole.png"), pixels("lit.png"))
    assert run("encode", cloud, *options, "-o", "a.frame").exit_code == 0
    assert run("play", "a.frame", "-o", "played.png").exit_code == 0
    assert np.array_equal(pixels("played.png"), pixels("whole.png"))


def test_lights_and_target_reach_tiles(run, folder, cloud, monkeypatch):
    options = (*AIM, "--lights", "side", "--size", "600x540", "--preset", "wide2048")
    assert run("render", cloud, *options, "-o", "whole.png").exit_code == 0
    monkeypatch.setattr(render_command, "fits_engine", lambda request: False)
    assert run("render", cloud, *options, "-o", "tiles.png").exit_code == 0
    assert np.array_equal(pixels("tiles.png"), pixels("whole.png"))


def test_lights_and_target_reach_a_cloud_in_parts(run, folder, cloud):
    """Twice the same file is a cloud in parts, whose picture is nearly that of one."""
    options = (*AIM, "--lights", "none", "--size", "256x256")
    assert run("render", cloud, *options, "-o", "one.png").exit_code == 0
    result = run("render", cloud, cloud, *options, "-o", "parts.png")
    assert result.exit_code == 0, result.output
    error = np.abs(pixels("one.png").astype(float) - pixels("parts.png"))
    assert error.mean() < 3.0
    assert run("render", cloud, cloud, *AIM, "--size", "256x256", "-o", "lit.png").exit_code == 0
    assert np.abs(pixels("lit.png").astype(float) - pixels("parts.png")).mean() > 5.0


def test_the_reference_has_the_lights_too(run, folder, cloud):
    """With the wrong ones its error would be large."""
    options = (*AIM, "--lights", "side", "--size", "200x200", "--stats", "a.json")
    assert run("render", cloud, *options, "--reference").exit_code == 0
    assert json.loads((folder / "a.json").read_text())["psnr_db"] > 28.0
