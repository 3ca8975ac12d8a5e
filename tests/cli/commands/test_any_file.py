"""What commands say about files of any kind: columns, strays, names and pipes."""

import gzip
import json
import os
import random
import subprocess
import sys
import threading

import numpy as np
import pytest

from splatline.host.files.readers import FORMATS
from tests.host.files.corrupt import corrupt, whole_files
from tests.host.files.kinds import COLOURS, RGB_PLY, SPHERE, XYZ_PLY, ply, text
from tests.host.files.las_files import las, laz
from tests.host.files.mesh_files import stl


@pytest.fixture
def scalars(tmp_path):
    path = tmp_path / "scan.ply"
    names = [*XYZ_PLY, *RGB_PLY, "float intensity", "float time"]
    path.write_bytes(ply(names, [*SPHERE.T, *COLOURS.T, *np.ones((2, len(SPHERE)))]))
    return path


def test_info_says_which_columns_are_used_and_which_are_not(run, scalars):
    result = run("info", scalars, "--json")
    assert result.exit_code == 0, result.stderr
    facts = json.loads(result.stdout)
    assert facts["columns_used"] == {
        **dict.fromkeys("xyz", "position"),
        **dict.fromkeys(("red", "green", "blue"), "colour"),
    }
    assert facts["columns_ignored"] == ["intensity", "time"]
    text = " ".join(run("info", scalars).stdout.replace("│", " ").split())
    assert "red uint8 20 220 colour" in text
    assert "time float32 1 1 " in text


@pytest.mark.parametrize("command", [["render"], ["encode", "-o", "a.frame"]])
def test_a_column_that_may_be_missed_is_said(run, scalars, command):
    result = run(command[0], scalars, *command[1:], *["--size", "32x32"])
    assert result.exit_code == 0, result.stderr
    assert "not used: intensity " in result.stdout
    assert "time" not in result.stdout.split("not used:")[1].split("\n")[0]


def test_info_of_an_unknown_format_says_what_render_says(run, tmp_path):
    path = tmp_path / "scan.dwg"
    path.write_bytes(b"AC1032")
    told = [run(command, path) for command in ("info", "render")]
    assert [result.exit_code for result in told] == [2, 2]
    assert told[0].stderr.splitlines()[-1] == told[1].stderr.splitlines()[-1]
    assert "unknown format '.dwg'" in told[0].stderr


def splatline(*arguments, folder, **options):
    script = "from splatline.cli.main import main; main()"
    command = [sys.executable, "-c", script, *map(str, arguments)]
    return subprocess.run(command, cwd=folder, capture_output=True, check=False, **options)


@pytest.mark.parametrize("compress", [bytes, gzip.compress])
def test_the_standard_input_is_read(tmp_path, compress):
    content = compress(ply(XYZ_PLY, SPHERE.T))
    size = ["--size", "32x32", "--stats", "a.json"]
    ran = splatline("render", "-", "--format", "ply", *size, folder=tmp_path, input=content)
    assert ran.returncode == 0, ran.stderr
    assert (tmp_path / "stdin.png").exists()
    assert json.loads((tmp_path / "a.json").read_text())["points"] == 60
    (tmp_path / "scan.bin").write_bytes(content)
    with (tmp_path / "scan.bin").open("rb") as stream:
        ran = splatline("render", "-", "--format", "PLY", *size, folder=tmp_path, stdin=stream)
    assert ran.returncode == 0, ran.stderr


@pytest.mark.parametrize(
    ("options", "content", "words"),
    [
        ([], b"1 2 3", b"the standard input has no name; give its --format, one of .ply"),
        (["--format", "foo"], b"1 2 3", b"unknown format 'foo'; it must be one of .ply"),
        (["--format", "xyz"], b"", b"the pipe is empty"),
        (["--format", "las"], b"1 2 3", b"cannot be read as LAS: it does not begin with LASF"),
    ],
)
def test_a_standard_input_that_cannot_be_read(tmp_path, options, content, words):
    ran = splatline("render", "-", *options, folder=tmp_path, input=content)
    assert ran.returncode == 2
    assert ran.stderr.splitlines()[-1].startswith(b"splatline: ")
    assert words in ran.stderr.splitlines()[-1]
    assert not list(tmp_path.iterdir())


def test_a_format_may_be_given_for_a_name_without_one(run, tmp_path):
    path = tmp_path / "scan.dat"
    path.write_bytes(ply(XYZ_PLY, SPHERE.T))
    assert run("render", path, "--size", "32x32").exit_code == 2
    assert run("render", path, "--format", "ply", "--size", "32x32").exit_code == 0


def test_the_help_names_every_format(run):
    words = run("render", "--help").stdout.replace(";", " ").split()
    assert {suffix[1:] for suffix in FORMATS} <= set(words)


def test_a_mesh_is_sampled(run, folder, tmp_path):
    path = tmp_path / "box.stl"
    path.write_bytes(stl())
    options = ["--size", "64x64", "--stats", "a.json"]
    assert run("render", path, *options, "--sample", "5000").exit_code == 0
    assert json.loads((folder / "a.json").read_text())["points"] == 5000
    result = run("render", "--scene", "knot", "--sample", "5000")
    assert result.exit_code == 2
    assert "--sample needs a CLOUD" in result.stderr


def test_the_points_that_a_las_file_marks_are_counted(run, tmp_path):
    path = tmp_path / "scan.laz"
    path.write_bytes(laz(las(7, classes=[7] * 5 + [2] * 55)))
    result = run("render", path, "--size", "32x32")
    assert result.exit_code == 0, result.stderr
    assert "noise 5" in result.stdout


def test_a_stray_is_not_in_the_picture_and_is_said(run, folder, tmp_path):
    path, alone = tmp_path / "stray.xyz", tmp_path / "alone.xyz"
    alone.write_text(text(SPHERE))
    path.write_text(text(SPHERE) + "1e6 0 0\n")
    options = ["--size", "64x64"]
    result = run("render", path, *options, "--stats", "a.json")
    assert result.exit_code == 0, result.stderr
    assert "1 point lies far from the rest" in result.stdout
    numbers = json.loads((folder / "a.json").read_text())
    assert (numbers["points"], numbers["far_away"]) == (60, 1)
    assert run("render", alone, *options, "--stats", "b.json").exit_code == 0
    other = json.loads((folder / "b.json").read_text())
    assert abs(numbers["drawn_pixels"] - other["drawn_pixels"]) < 0.02 * other["drawn_pixels"]
    assert run("render", path, *options, "--fit", "all", "--stats", "c.json").exit_code == 0
    whole = json.loads((folder / "c.json").read_text())
    assert (whole["points"], whole["far_away"]) == (61, 0)
    assert whole["drawn_pixels"] < 20
    assert json.loads(run("info", path, "--json").stdout)["far_from_the_rest"] == 1


def test_a_sentinel_is_counted_among_the_points_not_read(run, folder, tmp_path):
    path = tmp_path / "a.xyz"
    path.write_text(text(SPHERE) + "1e30 1e30 1e30\n")
    result = run("render", path, "--size", "64x64", "--stats", "a.json")
    assert result.exit_code == 0, result.stderr
    assert "far away 1" in result.stdout
    assert json.loads((folder / "a.json").read_text())["drawn_pixels"] > 500


def test_a_compressed_file_gives_a_picture_of_its_name(run, folder, tmp_path):
    path = tmp_path / "my.scan.xyz.gz"
    path.write_bytes(gzip.compress(text(SPHERE).encode()))
    assert run("render", path, "--size", "32x32").exit_code == 0
    assert [entry.name for entry in folder.iterdir()] == ["my.scan.png"]


def through_a_pipe(path, content, call):
    os.mkfifo(path)
    writer = threading.Thread(target=lambda: path.write_bytes(content))
    writer.start()
    result = call()
    writer.join(10)
    return result


@pytest.mark.parametrize("suffix", [".xyz", ".ply"])
def test_a_pipe_is_read(run, folder, tmp_path, suffix):
    content = text(SPHERE).encode() if suffix == ".xyz" else ply(XYZ_PLY, SPHERE.T)
    path = tmp_path / f"pipe{suffix}"
    result = through_a_pipe(path, content, lambda: run("info", path, "--json"))
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["points"] == 60


def test_an_empty_pipe_is_called_so(run, tmp_path):
    path = tmp_path / "pipe.ply"
    result = through_a_pipe(path, b"", lambda: run("info", path))
    assert result.exit_code == 2
    assert "the pipe is empty" in result.stderr


def test_a_device_is_no_file(run, tmp_path):
    (tmp_path / "zero.ply").symlink_to("/dev/zero")
    result = run("info", tmp_path / "zero.ply")
    assert result.exit_code == 2
    assert "is a device, not a file" in result.stderr


def test_a_name_that_the_terminal_cannot_show_is_no_traceback(tmp_path):
    name = b"gr\xf6" + "ße€".encode() + b"\xff\x1b[1m.ply"
    (tmp_path / os.fsdecode(name)).write_bytes(ply(XYZ_PLY, SPHERE.T))
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    for arguments in (
        [b"info", name],
        [b"info", name, b"--json"],
        [b"info", b"absent" + name],
        [b"render", name, b"--size", b"32x32", b"--out-dir", b"a\xff"],
        [b"encode", name, b"-o", name + b".frame"],
        [b"play", name + b".frame"],
    ):
        script = "from splatline.cli.main import main; main()"
        ran = subprocess.run(
            [sys.executable, "-c", script, *arguments],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            check=False,
        )
        assert ran.returncode == (2 if b"absent" + name in arguments else 0), ran.stderr
        assert b"Traceback" not in ran.stderr
        assert b"Error" not in ran.stderr


def test_corrupted_files_get_a_picture_or_one_line_and_code_2(run, folder, tmp_path):
    samples = whole_files()
    codes = []
    for seed in range(120):
        sample = samples[seed // 2 % len(samples)]
        path = tmp_path / sample.name
        path.write_bytes(corrupt(sample, random.Random(seed), in_header=seed % 2 == 0))
        result = run("render", path, "--size", "16x16", "-o", "a.png")
        assert result.exit_code in (0, 2), (seed, result.exception)
        if result.exit_code == 2:
            told = [line for line in result.stderr.splitlines() if not line.endswith("...")]
            assert len(told) == 1
            assert told[0].startswith(f"splatline: {path}: ")
            assert not list(folder.iterdir())
        (folder / "a.png").unlink(missing_ok=True)
        codes.append(result.exit_code)
    assert min(codes.count(0), codes.count(2)) > 20
