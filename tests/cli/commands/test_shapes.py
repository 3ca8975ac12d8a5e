"""``--shapes``: the ROM's pictures and statistics, and what it does not go with."""

import json

import numpy as np
from PIL import Image


def pixels(path):
    with Image.open(path) as picture:
        return np.array(picture)


def test_the_rom_draws_the_paper_s_picture_and_both_ways_are_counted(run, folder, cloud):
    common = ("render", cloud, "--size", "64x48", "--splat-size", "0.2")
    table = run(*common, "--quality", "paper", "--specks", "keep", "-o", "table.png")
    assert table.exit_code == 0
    result = run(*common, "--shapes", "rom", "-o", "rom.png", "--stats", "rom.json")
    assert result.exit_code == 0, result.stderr
    assert np.array_equal(pixels(folder / "rom.png"), pixels(folder / "table.png"))
    numbers = json.loads((folder / "rom.json").read_text())
    assert numbers["preset"] == "rgb24-rom"
    assert (numbers["quality"], numbers["shapes"]) == ("paper", "rom")
    assert numbers["bits_sent"].keys() == {"rom", "table"}
    assert numbers["bits_sent"]["rom"] == 64 * numbers["codewords"]
    assert f"{numbers['bits_sent']['rom']:,} (rom)" in result.stdout


def test_the_rom_of_every_size_sends_fewer_bits(run, folder, cloud):
    result = run("render", cloud, "--size", "200x200", "--splat-size", "0.1", "--shapes", "rom",
                 "--preset", "paper-rom-full", "--stats", "rom.json")  # fmt: skip
    assert result.exit_code == 0, result.stderr
    sent = json.loads((folder / "rom.json").read_text())["bits_sent"]
    assert sent["rom"] < 0.8 * sent["table"]


def test_the_rom_s_verilog_is_asked_for_a_scene(run, folder, verilog):
    """Golden stands for its simulation; ``tests/rtl/shapes`` has the Verilog's."""
    result = run("render", "--scene", "knot", "--size", "48x32", "--shapes", "rom",
                 "--engine", "rtl", "-o", "knot.png", "--stats", "knot.json")  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert len(verilog[1]) == 1
    numbers = json.loads((folder / "knot.json").read_text())
    assert (numbers["preset"], numbers["mismatched_pixels"]) == ("rgb24-rom", 0)
    assert numbers["bits_sent"]["rom"] == 64 * numbers["codewords"]


def test_without_the_rom_one_way_is_counted(run, folder, cloud):
    assert run("render", cloud, "--size", "32x32", "--stats", "a.json").exit_code == 0
    numbers = json.loads((folder / "a.json").read_text())
    assert numbers["bits_sent"] == {"table": 64 * numbers["codewords"]}


def test_another_quality_or_a_skip_of_the_hidden_is_refused(run, folder, cloud):
    for options, named in (
        (["--quality", "exact"], "--quality paper, not exact"),
        (["--quality", "fast"], "--quality paper, not fast"),
        (["--skip", "hidden"], "the skip hidden"),
    ):
        result = run("render", cloud, "--shapes", "rom", *options)
        assert result.exit_code == 2
        assert named in result.stderr
        assert "Traceback" not in result.stderr
    assert not list(folder.iterdir())


def test_a_frame_of_compact_words_is_played_from_disk(run, folder, cloud):
    common = (cloud, "--size", "64x48", "--shapes", "rom")
    assert run("encode", *common, "-o", "ball.frame").exit_code == 0
    facts = json.loads(run("info", "ball.frame", "--json").stdout)
    assert 0 < facts["compact_words"] <= facts["symmetric_words"]
    assert run("play", "ball.frame", "-o", "played.png").exit_code == 0
    assert run("render", *common, "-o", "rendered.png").exit_code == 0
    assert np.array_equal(pixels(folder / "played.png"), pixels(folder / "rendered.png"))
