"""Chains on the command line: their Verilog, a picture, and the page of measurements."""

import json

import numpy as np
import pytest

from splatline.cli.bench.chain.page import rate
from splatline.cli.options import drawing as engines
from splatline.host.encode.partition import partition
from splatline.host.encode.partition_methods import METHODS
from splatline.host.frame_file import load_frame
from splatline.plots import figure
from splatline.sim import golden
from splatline.sim.cosim.player import chains
from splatline.sim.cosim.player.jobs import Outcome, Times

SMALL = ("--size", "64x48")


def test_the_verilog_of_a_chain(run, folder):
    result = run("verilog", "--engines", 3, "--link", "load")
    assert result.exit_code == 0, result.output
    text = (folder / "splatline_rgb24_x3.v").read_text()
    description = json.loads((folder / "splatline_rgb24_x3.json").read_text())
    assert "module splatline_rgb24_chain3_engine(" in text
    assert "splatline_rgb24_chain3_merger" not in text
    assert (description["engines"], description["link"]) == (3, "load")
    assert sum(port["name"].startswith("codewords_") for port in description["ports"]) == 3 * 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--engines", 0), "0 is not in the range 1<=x<=64"),
        (("--engines", 2, "--top", "pins"), "give --engines or --top pins, not both"),
        (("--engines", 2, "--link", "glue"), "'glue' is not one of 'merge', 'load'"),
    ],
)
def test_what_is_no_chain_is_said_in_one_line(run, folder, arguments, words):
    result = run("verilog", *arguments)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())
    assert not list(folder.iterdir())


def test_a_picture_by_a_chain_is_compared_with_golden_s(run, folder, cloud, monkeypatch):
    wrong = []

    def simulate(parts, *, link, stall, seed, progress):
        raster = golden.render_parts(parts)
        raster.colour[raster.drawn] ^= np.uint8(bool(wrong))
        assert (len(parts), link) == (3, "load")
        return Outcome([raster], np.zeros((0, 2), np.uint64), 4321, {"build": 1.0, "run": 2.0})

    monkeypatch.setattr(chains, "simulate_parts", simulate)
    arguments = ("render", cloud, *SMALL, "--engine", "rtl", "--engines", 3, "--link", "load")
    result = run(*arguments, "--stats", "s.json")
    assert result.exit_code == 0, result.output
    stats = json.loads((folder / "s.json").read_text())
    assert (stats["engines"], stats["cycles"], stats["mismatched_pixels"]) == (3, 4321, 0)
    wrong.append(True)
    assert run(*arguments).exit_code == 1


def test_golden_draws_what_a_chain_would(run, folder, cloud, monkeypatch):
    monkeypatch.setattr(engines, "_simulate", None)
    arguments = ("--engines", 4, "-o", "four.png", "--depth", "depth.png")
    result = run("render", cloud, *SMALL, *arguments)
    assert result.exit_code == 0, result.output
    assert run("encode", cloud, *SMALL, "-o", "ball.frame").exit_code == 0
    frame = load_frame("ball.frame")
    expected = golden.render_parts(partition(frame, 4))
    assert expected.mismatches(golden.render(frame)) > 0  # where depths are equal
    figure.save_rgb("expected.png", expected.to_rgb(figure.BACKGROUND))
    figure.save_depth("expected_depth.png", expected)
    assert (folder / "four.png").read_bytes() == (folder / "expected.png").read_bytes()
    assert (folder / "depth.png").read_bytes() == (folder / "expected_depth.png").read_bytes()


@pytest.fixture
def fast_chains(monkeypatch):
    """Chains that are as fast as their largest part, and draw with the golden renderer."""

    def play(jobs, *, link, built):
        outcomes = []
        for job in jobs:
            cycles = max(len(part.codewords) for part in job.frames[0]) + 100
            rasters = job.pictures()
            beats = np.zeros((50 * len(rasters), 2), np.uint64)
            count = len(job.frames[0])
            times = [
                Times((n * cycles,) * count, ((n + 1) * cycles - 40,) * count, n * cycles + 9,
                      (n + 1) * cycles - 1)
                for n in range(len(rasters))
            ]  # fmt: skip
            outcomes.append(Outcome(rasters, beats, cycles, {}, times))
        return outcomes

    monkeypatch.setattr(chains, "play_chain", play)
    monkeypatch.setattr(chains, "build_chain", lambda *arguments: None)


def test_the_page_has_every_chain(run, folder, fast_chains):
    result = run(
        "bench", "chain", "--scene", "knot", *SMALL, "--elements", 2000, "--engines", 4,
        "--preset", "paper", "--clock", 50, "--out-dir", "o",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    report = json.loads((folder / "o/chain.json").read_text())
    runs = report["runs"]
    assert {run["engines"] for run in runs} == {1, 4}
    assert {run["method"] for run in runs} == set(METHODS)
    assert {run["scene"] for run in runs} == {"knot", "knot, filled"}
    assert {run["link"] for run in runs} == {"merge", "load"}
    for row in runs:
        assert abs(row["elements"] - 2000) < 200
        assert row["mismatched_pixels"] == 0
        assert (row["fill_cycles"], row["drain_cycles"]) == (9, 39)
        assert row["seconds"] == pytest.approx(row["cycles"] / 50e6)
        assert row["paper_seconds"] == 0.02
        if row["video_cycles"] is not None:
            assert row["video_fps"] == pytest.approx(50e6 / row["video_cycles"], abs=0.06)
            assert row["idle_cycles"] == row["idle_table_cycles"] == 39
    page = (folder / "o/chain.md").read_text()
    assert page in result.stdout
    assert "| 4 | paper | knot | " in page
    assert "0 pixels differ" in page


def test_speed_ups_are_over_one_engine_and_bound_by_the_raster():
    run = {
        "scene": "s", "preset": "p", "method": "columns", "elements": 10**8, "beats": 300,
        "video_cycles": None, "video_table_cycles": None,
    }  # fmt: skip
    one, host, eight = rate(
        [
            run | {"engines": 1, "cycles": 1600},
            run | {"engines": 1, "cycles": 2000, "method": "elements"},
            run | {"engines": 8, "cycles": 400},
        ],
        {"p": 100.0},
    )
    assert (one["speedup"], host["speedup"]) == (1.0, 1.0)
    assert (eight["speedup"], eight["speedup_host"]) == (4.0, 5.0)
    assert eight["bound"] == pytest.approx(1600 / 300, abs=1e-3)
    assert eight["paper_seconds"] == 1.0
    assert eight["video_fps"] is None
    (unknown,) = rate([run | {"engines": 1, "cycles": 1600, "video_cycles": 9}], {"p": None})
    assert unknown["seconds"] is unknown["video_fps"] is None
