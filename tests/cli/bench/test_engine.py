import json

import numpy as np
import pytest
from click.testing import CliRunner

from splatline.cli.bench.engine import command as bench_engine
from splatline.cli.bench.engine import measure as bench_engine_runs
from splatline.cli.bench.engine.targets import LEAST_RATE, TARGETS, judge, rate
from splatline.cli.main import main
from splatline.contract.presets import PAPER
from splatline.contract.raster import Raster

KEYS = {
    "scene", "quality", "preset", "elements", "codewords", "cycles", "cycles_per_element",
    "bound_cycles", "ratio", "raster_words", "elements_per_second",
}  # fmt: skip


def count_luts(presets, advance):
    """Two thousand each, at once."""
    for config in presets:
        advance(config.name)
    return {config.name: 2000 for config in presets}


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    """A small run, once: its report, its page and what it printed."""
    folder = tmp_path_factory.mktemp("engine")
    ball = folder / "ball.csv"
    normals = np.random.default_rng(7).normal(size=(2000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    np.savetxt(ball, np.hstack([normals, normals]), fmt="%.6f", delimiter=",",
               header="x,y,z,nx,ny,nz", comments="")  # fmt: skip
    arguments = [ball, "--scene", "knot", "--size", "63x48", "--preset", "paper"]
    arguments += ["--preset", "rgb24", "--splats", "auto", "--splats", "3", "--splats", "6.5"]
    arguments += ["--luts", "--out-dir", folder / "out"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bench_engine, "count_luts", count_luts)
        result = CliRunner().invoke(main, ["bench", "engine", *map(str, arguments)])
    assert result.exit_code == 0, result.output
    report = json.loads((folder / "out" / "engine.json").read_text())
    return report, (folder / "out" / "engine.md").read_text(), result


def test_each_frame_has_its_cycles_beside_its_bound(outcome):
    report, _, _ = outcome
    runs = report["runs"]
    assert len(runs) == 2 * 3 * 2 * 2
    assert {run["scene"] for run in runs} == {"knot", "ball"}
    assert {run["splats"] for run in runs} == {"auto", 3.0, 6.5}
    for run in runs:
        assert set(run) >= KEYS
        assert run["codewords"] > run["elements"] > 0
        assert run["cycles_per_element"] == pytest.approx(run["cycles"] / run["elements"], abs=1e-4)
        assert run["ratio"] == pytest.approx(run["cycles"] / run["bound_cycles"], abs=1e-4)
        assert 0 < run["raster_words"] <= 16 * 48
        assert run["elements_per_second_per_lut"] == round(
            1e8 * run["elements"] / run["cycles"] / 2000
        )


def test_the_page_is_printed_and_its_tables_are_whole(outcome):
    _, page, result = outcome
    assert page in result.stdout
    for heading in ("Targets", "Preset paper, 2,000 LUTs", "Preset rgb24, 2,000 LUTs"):
        assert f"\n## {heading}\n" in page
    tables = [block.splitlines() for block in page.split("\n\n") if block.startswith("| ")]
    assert len(tables) == 5
    assert all(row.count("|") == table[0].count("|") for table in tables for row in table)


def test_a_frame_of_few_elements_costs_few_cycles(outcome):
    few = outcome[0]["few"]
    assert [row["elements"] for row in few if row["preset"] == "paper"] == [1, 10, 100, 1000]
    # 64 x 64 pixels have 1,024 words: they are neither cleared nor sent.
    assert all(row["cycles"] < 40 + 25 * row["raster_words"] for row in few)
    ten = next(row for row in few if row["elements"] == 10)
    assert ten["raster_words"] < ten["cycles"] < 1024


def test_the_number_of_frames_is_known_before(outcome):
    said = [line for line in outcome[2].stderr.splitlines() if " %  " in line]
    assert [int(line.split("%")[0]) for line in said] == list(range(0, 100, 10))


def test_without_luts_their_columns_stay_empty(run, cloud, folder):
    result = run("bench", "engine", cloud, "--scene", "knot", "--size", "32x32", "--splats", "2",
                 "--quality", "fast", "--preset", "paper")  # fmt: skip
    assert result.exit_code == 0, result.output
    runs = json.loads((folder / "docs/bench/engine.json").read_text())["runs"]
    assert [(entry["scene"], entry["lut4"]) for entry in runs] == [("knot", None), ("ball", None)]
    assert "LUT" not in result.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--scene", "sea"), "no scene named 'sea'"),
        (("none.ply",), "none.ply: no such file"),
        (("knot.csv", "--scene", "knot"), "two clouds are called 'knot'"),
        (("--out-dir", "knot.csv"), "is a file"),
        (("--splats", "0"), "'0' is not a splat size; write auto, or a diameter above 0 in pixels"),
        (
            ("--size", "9999x4"),
            "the image is 9999x4; an engine of preset paper draws at most 512x1024",
        ),
    ],
)
def test_what_cannot_be_measured_is_said_in_one_line(run, folder, cloud, arguments, words):
    (folder / "knot.csv").write_bytes(cloud.read_bytes())
    result = run("bench", "engine", *arguments)
    assert result.exit_code == 2
    assert result.stderr.splitlines()[-1].startswith("splatline: ")
    assert words in result.stderr
    assert not (folder / "docs").exists()


def test_luts_without_yosys_say_what_to_install(run, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    result = run("bench", "engine", "--luts")
    assert result.exit_code == 2
    assert "'.[synth]'" in result.stderr.splitlines()[-1]


def test_words_are_drawn_if_any_of_their_pixels_is():
    raster = Raster.background(10, 2)
    for line, column in ((0, 0), (0, 3), (0, 9), (1, 4)):
        raster.depth[line, column] = PAPER.background_depth - 1
    assert bench_engine_runs._words_drawn(raster) == 3


def entry(quality, pixels, element=1.0, codeword=1.0, ratio=1.0, preset="paper"):
    return {
        "scene": "knot", "splats": pixels, "median_pixels": pixels, "quality": quality,
        "preset": preset, "cycles_per_element": element, "cycles_per_codeword": codeword,
        "ratio": ratio,
    }  # fmt: skip


def test_the_rates_are_those_of_small_splats():
    def rated(quality, pixels, figure, scene="knot"):
        run = entry(quality, pixels) | {"elements_per_second_per_lut": figure, "lut4": 2000}
        return run | {"scene": scene}

    runs = [
        rated("fast", 2.0, LEAST_RATE),
        rated("fast", 3.0, LEAST_RATE + 9, "terrain"),
        rated("fast", 4.0, LEAST_RATE - 1),
        rated("fast", 6.5, 9),
        rated("exact", 3.0, 9),
    ]
    assert rate(runs) == [
        {
            "preset": "paper", "lut4": 2000, "runs": 3, "runs_met": 2, "most": LEAST_RATE + 9,
            "scene": "terrain", "median": LEAST_RATE, "least": LEAST_RATE - 1,
        }
    ]  # fmt: skip
    assert rate([run | {"elements_per_second_per_lut": None} for run in runs]) == []


def test_the_verdicts_are_those_of_the_targets():
    runs = [
        entry("fast", 2.0, element=1.10),
        entry("fast", 4.0, element=1.1),
        entry("fast", 5.0, element=9.0),
        entry("fast", 6.5, element=1.86, codeword=1.5),
        entry("exact", 3.0, element=9.0, codeword=1.11),
        entry("exact", 6.5, codeword=1.1, ratio=1.08),
        entry("exact", 6.5, codeword=1.0, preset="wide"),
    ]
    verdicts = {(row["preset"], row["target"]): row for row in judge(runs)}
    assert list(verdicts) == [
        *(("paper", name) for name in TARGETS), ("wide", "exact"), ("wide", "bound"),
    ]  # fmt: skip
    assert {
        key: (row["figure"], row["runs_met"], row["runs"]) for key, row in verdicts.items()
    } == {
        ("paper", "small"): (1.10, 2, 2),
        ("paper", "large"): (1.86, 0, 1),
        ("paper", "exact"): (1.11, 1, 2),
        ("paper", "bound"): (1.08, 5, 6),
        ("wide", "exact"): (1.0, 1, 1),
        ("wide", "bound"): (1.0, 1, 1),
    }
    assert [row["met"] for row in verdicts.values()] == [True, False, False, False, True, True]
