import json

import numpy as np
import pytest
from PIL import Image


@pytest.fixture
def frame(run, folder, cloud):
    result = run("encode", cloud, "--size", "48x40", "-o", "ball.frame")
    assert result.exit_code == 0, result.stderr
    return folder / "ball.frame"


def test_encode_writes_little_endian_words_and_a_sidecar(frame, folder):
    assert sorted(path.name for path in folder.iterdir()) == ["ball.frame", "ball.frame.json"]
    words = np.fromfile(frame, "<u8")
    end = int(words[-1])
    # The last word is a control word: MODE 1, every row empty, with the end bit.
    rows = [(end >> (1 + 6 * row) & 7, end >> (4 + 6 * row) & 7) for row in range(4)]
    assert end & 1
    assert end >> 25 & 1
    assert all(first > last for first, last in rows)
    sidecar = json.loads((folder / "ball.frame.json").read_text())
    assert sidecar["counts"]["codewords"] == len(words)


def test_play_draws_what_render_draws(run, frame, folder, cloud):
    assert run("play", "ball.frame", "--stats", "a.json", "--depth", "d.png").exit_code == 0
    assert run("render", cloud, "--size", "48x40", "-o", "other.png").exit_code == 0
    assert (folder / "ball.png").read_bytes() == (folder / "other.png").read_bytes()
    numbers = json.loads((folder / "a.json").read_text())
    assert numbers["codewords"] == len(np.fromfile(frame, "<u8"))
    assert numbers["size"] == [48, 40]
    with Image.open(folder / "d.png") as depth:
        assert depth.size == (48, 40)


def test_play_fails_where_the_verilog_differs_from_golden(run, frame, folder, verilog):
    assert run("play", frame, "--engine", "rtl").exit_code == 0
    verilog[0].append((3, 4))
    result = run("play", frame, "--engine", "rtl", "--stats", "a.json")
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1].startswith("splatline: 1 pixels")
    assert json.loads((folder / "a.json").read_text())["mismatched_pixels"] == 1


@pytest.mark.parametrize("output", ["ball.frame.json", "./ball.frame"])
def test_play_does_not_write_over_its_frame(run, frame, folder, output):
    before = {path: path.read_bytes() for path in folder.iterdir()}
    result = run("play", "ball.frame", "--stats", output)
    assert result.exit_code == 2
    assert "over the input" in result.stderr
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def test_info_of_a_frame_counts_its_words(run, frame):
    result = run("info", frame, "--json")
    assert result.exit_code == 0, result.stderr
    facts = json.loads(result.stdout)
    assert facts["codewords"] == len(np.fromfile(frame, "<u8"))
    assert facts["points"] == 2000
    assert (facts["width"], facts["height"]) == (48, 40)
    table = run("info", "ball.frame")
    assert table.exit_code == 0
    assert "symmetric" in table.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["encode", "{cloud}", "-o", "nowhere/a.frame"], "no folder nowhere"),
        (["encode", "{cloud}", "-o", "{cloud}"], "over the input"),
        (["encode", "absent.ply", "-o", "a.frame"], "absent.ply"),
        (["play", "absent.frame"], "absent.frame"),
        (["play", "{cloud}"], "ball"),
    ],
)
def test_bad_input_gets_one_line_code_2_and_leaves_nothing(run, folder, cloud, arguments, words):
    result = run(*(text.format(cloud=cloud) for text in arguments))
    assert result.exit_code == 2, (result.stderr, result.exception)
    message = result.stderr.splitlines()[-1]
    assert message.startswith("splatline: ")
    assert words in message
    assert not list(folder.iterdir())


def test_a_frame_that_was_cut_short_is_refused(run, frame, folder):
    frame.write_bytes(frame.read_bytes()[:-12])
    for arguments in (["play", frame], ["info", frame]):
        result = run(*arguments)
        assert result.exit_code == 2, (result.stderr, result.exception)
        assert result.stderr.splitlines()[-1].startswith("splatline: ")
    assert not (folder / "ball.png").exists()


def test_a_frame_of_plane_words_is_encoded_played_and_described(run, folder, cloud):
    options = ("--size", "32x32", "--preset", "plane")
    assert run("encode", cloud, *options, "-o", "a.frame").exit_code == 0
    assert (folder / "a.frame").stat().st_size % 16 == 0
    result = run("play", "a.frame", "-o", "a.png")
    assert result.exit_code == 0, result.stderr
    described = run("info", "a.frame", "--json")
    facts = json.loads(described.stdout)
    assert facts["preset"] == "plane"
    assert facts["bits_sent"] == {"table": 96 * facts["codewords"]}
    assert run("render", cloud, *options, "-o", "b.png", "--engines", "2").exit_code == 0
