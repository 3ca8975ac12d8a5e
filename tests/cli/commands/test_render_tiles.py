"""``splatline render`` of pictures that are larger than the engine's image."""

import json

import numpy as np
import pytest
from PIL import Image

from splatline.cli.commands import render as render_command
from splatline.cli.commands import render_tiles
from splatline.sim import golden
from splatline.sim.cosim.player.jobs import Outcome

SIZE = "700x520"  # two tiles of 512 columns by two of 512 lines


def pixels(path):
    return np.asarray(Image.open(path))


@pytest.fixture
def verilog_of_tiles(monkeypatch):
    """Puts a simulation in place that draws with the golden renderer, then spoils some pixels."""
    spoilt: list[tuple[int, int]] = []
    runs = []

    def simulate(frames, stall, seed):
        runs.append((len(frames), stall, seed))
        outcomes = []
        for frame in frames:
            raster = golden.render(frame)
            for place in spoilt:
                raster.colour[place] ^= 1
            outcomes.append(Outcome([raster], np.zeros((0, 2), np.uint64), 1000, {}))
        return outcomes

    monkeypatch.setattr(render_tiles, "simulate_all", simulate)
    return spoilt, runs


@pytest.mark.parametrize("samples", [1, 4])
def test_the_picture_is_that_of_a_larger_engine(run, folder, cloud, samples, monkeypatch):
    monkeypatch.setattr(render_command, "fits_engine", lambda request: False)
    options = ("--size", SIZE, "--preset", "wide2048", "--samples", samples, "--zoom", 1.4)
    assert run("render", cloud, *options, "-o", "a.png", "--depth", "ad.png",
               "--stats", "a.json").exit_code == 0  # fmt: skip
    monkeypatch.undo()
    monkeypatch.chdir(folder)
    assert run("render", cloud, *options, "-o", "b.png", "--depth", "bd.png",
               "--stats", "b.json").exit_code == 0  # fmt: skip
    assert np.array_equal(pixels("a.png"), pixels("b.png"))
    assert np.array_equal(pixels("ad.png"), pixels("bd.png"))
    tiles, whole = (json.loads((folder / name).read_text()) for name in ("a.json", "b.json"))
    for name in ("size", "elements", "drawn_pixels", "culled", "samples", "points", "depth_range"):
        assert tiles[name] == whole[name]
    assert set(whole) <= set(tiles)


def test_the_default_engine_draws_any_size_and_says_in_how_many_tiles(run, folder, cloud):
    result = run("render", cloud, "--size", SIZE, "--stats", "a.json")
    assert result.exit_code == 0
    assert pixels("ball.png").shape == (520, 700, 3)
    numbers = json.loads((folder / "a.json").read_text())
    assert numbers["tiles"] + numbers["tiles_empty"] == 4
    assert any("in 4 tiles" in note for note in numbers["notes"])
    assert 0 < numbers["words_twice"] < numbers["codewords"]
    assert numbers["cycles"] is None


def test_verilog_is_compared_and_its_cycles_added(run, folder, cloud, verilog_of_tiles):
    spoilt, runs = verilog_of_tiles
    options = ("--size", SIZE, "--engine", "rtl", "--stall", 0.25, "--seed", 7, "--zoom", 2)
    assert run("render", cloud, *options, "--stats", "a.json").exit_code == 0
    numbers = json.loads((folder / "a.json").read_text())
    assert runs == [(2, 0.25, 7), (2, 0.25, 7)]  # a run for a row of tiles
    assert numbers["cycles"] == 4000
    assert numbers["mismatched_pixels"] == 0
    spoilt += [(20, 200), (20, 3)]  # the second is in the guard band of two tiles
    result = run("render", cloud, *options, "--stats", "a.json")
    assert result.exit_code == 1
    assert "6 pixels of the Verilog's picture differ" in result.stderr
    assert json.loads((folder / "a.json").read_text())["mismatched_pixels"] == 6


def test_the_verilog_itself_draws_tiles(run, folder, cloud):
    result = run("render", cloud, "--size", "530x40", "--engine", "rtl", "--stats", "a.json")
    assert result.exit_code == 0
    numbers = json.loads((folder / "a.json").read_text())
    assert numbers["mismatched_pixels"] == 0
    assert numbers["tiles"] + numbers["tiles_empty"] == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--size", SIZE, "--reference"], "--reference and --out-dir cannot draw in tiles"),
        (["--size", SIZE, "--out-dir", "set"], "--reference and --out-dir cannot draw in tiles"),
        (["--size", SIZE, "--engines", 2], "--engines cannot draw in tiles"),
        (["--size", SIZE, "--engine", "axi"], "--engine axi cannot draw in tiles"),
        (["--size", SIZE, "--shapes", "rom"], "--shapes rom cannot draw in tiles"),
        (["--size", "70000x40"], "at most 65536 pixels"),
        (["--size", SIZE, "--background", "white", "--up", "z", "--orbit", "0,0", "--fov", "500"],
         "field of view"),
    ],
)  # fmt: skip
def test_what_does_not_go_with_tiles_gets_one_line(run, folder, cloud, arguments, words):
    result = run("render", cloud, *arguments)
    assert result.exit_code == 2
    last = result.stderr.strip().splitlines()[-1]
    assert words in last
    assert not list(folder.iterdir())
