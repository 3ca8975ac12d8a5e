import json
import re

import av
import numpy as np
import pytest
from PIL import Image, ImageSequence

from splatline.cli.commands.film import film
from splatline.view.camera import Camera
from splatline.view.film.keyframes import read_path

QUICK = ["--size", "48x32", "--seconds", "0.4", "--fps", "10"]


def files(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_cloud_becomes_a_film(run, folder, cloud):
    result = run("film", cloud, "-o", "ball.mp4", *QUICK, "--orbit", "-75,10", "--samples", "2")
    assert result.exit_code == 0, result.stderr
    assert files(folder) == ["ball.mp4"]
    with av.open("ball.mp4") as container:
        assert sum(1 for _ in container.decode(video=0)) == 4
    assert result.stdout.startswith("ball.mp4: 4 frames, 0.4 s, ")
    assert "Drawing 4 frames ..." in result.stderr.splitlines()


def test_a_frame_is_the_picture_of_render(run, folder, cloud):
    """Of the same camera, which a path gives in full."""
    key = {"azimuth": 50, "elevation": 10, "distance": 4, "target": [0.1, 0, 0]}
    (folder / "path.json").write_text(
        json.dumps([{"time": 0, **key}, {"time": 1, **key, "azimuth": 70}])
    )
    view = ["--size", "48x32", "--fov", "50", "--lights", "side", "--preset", "paper"]
    result = run("film", cloud, "-o", "ball.webp", "--path", "path.json", "--fps", "3",
                 "--fidelity", "100", "--background", "#102030", *view)  # fmt: skip
    assert result.exit_code == 0, result.stderr
    with Image.open("ball.webp") as film:
        frames = [np.array(frame.convert("RGB")) for frame in ImageSequence.Iterator(film)]
    assert len(frames) == 3
    for frame, azimuth in zip(frames, (50, 60, 70), strict=True):
        done = run("render", cloud, "-o", "one.png", "--orbit", f"{azimuth},10", "--target",
                   "0.1,0,0", "--distance", "4", "--background", "#102030", *view)  # fmt: skip
        assert done.exit_code == 0, done.stderr
        with Image.open("one.png") as picture:
            assert (np.array(picture) == frame).all()


def test_a_built_in_scene_is_filmed_by_height(run, folder):
    result = run("film", "--scene", "knot", "-o", "knot.gif", *QUICK, "--colour", "height")
    assert result.exit_code == 0, result.stderr
    with Image.open("knot.gif") as made:
        assert (made.size, made.n_frames) == ((48, 32), 4)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["-o", "a.avi"], ".mp4, .gif, .webp"),
        (["-o", "a.mp4", "--size", "33x20"], "34x20"),
        (["-o", "a.gif", "--fps", "70"], "50 frames"),
        (["-o", "absent/a.gif"], "no folder"),
        (["-o", "a.webp", "--path", "absent.json"], "absent.json"),
        (["-o", "a.webp", "--seconds", "nan"], "seconds"),
        (["-o", "a.webp", "--preset", "plane", "--quality", "paper"], "paper"),
        ([], "--output"),
    ],
)
def test_what_cannot_be_is_told_in_one_line(run, folder, cloud, options, told):
    result = run("film", cloud, *options)
    assert result.exit_code == 2
    assert told in result.stderr.splitlines()[-1]
    assert sum(line.startswith("splatline:") for line in result.stderr.splitlines()) == 1
    assert files(folder) == []


def test_the_examples_of_the_help_are_paths(run, folder, tmp_path):
    text = re.sub("\n    ", "\n", film.help)
    (folder / "a.json").write_text(re.search(r"\[\{.*?\}\]", text, re.DOTALL)[0])
    rows = text[text.index("time,azimuth") :].split("\n\n")[0]
    (folder / "a.csv").write_text("\n".join(line.strip() for line in rows.splitlines()))
    one, other = (read_path(folder / name, Camera((0, 0, 0), 1.0)) for name in ("a.json", "a.csv"))
    assert (one.values == other.values).all()
