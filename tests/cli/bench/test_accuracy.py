import json

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from splatline.cli.bench.accuracy.measure import measure
from splatline.cli.bench.accuracy.planes import judge_means, plane_section
from splatline.cli.bench.accuracy.sweep import (
    FLOAT,
    FLOAT_DEPTHS,
    FLOAT_ONE_DEPTH,
    TWICE,
    Sweep,
    plan,
    plane_presets,
)
from splatline.cli.bench.accuracy.targets import TARGETS, judge
from splatline.cli.bench.accuracy.write import write_accuracy
from splatline.cli.bench.command import ACCURACY_SIZES
from splatline.cli.main import main
from splatline.contract.variants import CONFIGS
from splatline.host.encode.quality import QUALITIES
from splatline.host.scenes import knot
from splatline.host.visibility.skips import SKIPS

KEYS = {
    "scene", "quality", "preset", "skips", "cloud", "view", "splat_size", "dropped", "engine",
    "size", "points", "culled", "elements", "codewords", "control_words", "depth_range",
    "drawn_pixels", "cycles", "cycles_per_element", "seconds", "versions", "machine", "psnr_db",
    "psnr_foreground_db", "ssim", "hole_fraction", "silhouette_iou", "depth_rmse",
}  # fmt: skip


def ball(path):
    """A sphere of 800 points, coloured by place."""
    normals = np.random.default_rng(7).normal(size=(800, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rows = np.hstack([normals, normals, np.round(127.5 * (normals + 1.0))])
    head = "x,y,z,nx,ny,nz,red,green,blue"
    np.savetxt(path, rows, fmt="%.6f", delimiter=",", header=head, comments="")
    return path


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    """A quick run, once: its folder and result. The scene has as many points as the image."""
    folder = tmp_path_factory.mktemp("bench")
    arguments = ["--scene", "knot", "--quick", "--size", "48x40", "--no-pictures", "ball"]
    arguments += ["--out-dir", folder / "out"]
    cloud = ball(folder / "ball.csv")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(knot, "POINTS", 2000)
        result = CliRunner().invoke(main, ["bench", "accuracy", str(cloud), *map(str, arguments)])
    assert result.exit_code == 0, result.stderr
    return folder / "out", result


def test_a_quick_run_writes_numbers_page_plots_and_pictures(quick):
    out, result = quick
    numbers = json.loads((out / "accuracy.json").read_text())
    assert numbers["size"] == [48, 40]
    assert {"machine", "tools", "runs", "ladders", "targets"} <= set(numbers)
    runs = numbers["runs"]
    assert all(set(entry) >= KEYS for entry in runs)
    assert f"{len(runs)} runs" in result.stdout

    assert {entry["scene"] for entry in runs} == {"knot", "ball"}
    for scene in ("knot", "ball"):
        here = [entry for entry in runs if entry["scene"] == scene]
        fitted = [entry for entry in here if entry["splats"] == "auto"]
        engines = {(entry["quality"], entry["preset"]) for entry in fitted if entry["preset"]}
        assert engines == {
            *((name, preset) for name in QUALITIES for preset in ("paper", "rgb24")),
            ("exact", "plane"),
        }
        assert {entry["quality"] for entry in fitted if not entry["preset"]} == {
            FLOAT, FLOAT_DEPTHS, FLOAT_ONE_DEPTH}  # fmt: skip
        assert {entry["switched"] for entry in fitted} == {None, *SKIPS}
        assert {entry["splats"] for entry in here} == {"auto", 3.5}
        sampled = [entry for entry in here if entry["samples"] > 1]
        assert {(entry["splats"], entry["preset"], entry["samples"]) for entry in sampled} == {
            (3.5, "paper", 4),
            ("auto", "paper", 4),
            *(("auto", preset, samples) for preset in ("plane", None) for samples in (4, 16)),
        }
        middle = [entry for entry in sampled if entry["splats"] == 3.5]
        assert [entry["quality"] for entry in middle] == ["paper", "exact"]
    for entry in runs:
        assert entry["psnr_db"] > 5.0
        if entry["preset"]:
            assert entry["seconds"]["host"] > 0.0
            assert entry["seconds"]["golden"] > 0.0
            assert min(entry["processor_seconds"].values()) > 0.0
            assert entry["codewords"] > entry["elements"] > 0

    page = (out / "accuracy.md").read_text()
    for heading in ("Targets", "Planes", "Error budget", "Skips", "Pictures"):
        assert f"\n## {heading}\n" in page
    # Every row of a table has as many cells as its head.
    tables = [block.splitlines() for block in page.split("\n\n") if block.startswith("| ")]
    for table in tables:
        cells = table[0].count("|")
        assert cells > 4
        assert len(table) > 2
        assert all(row.count("|") == cells for row in table)
    for name in ("pareto", "pareto_scenes", "waterfall", "pictures/knot"):
        assert f"({name}.png)" in page
        with Image.open(out / f"{name}.png") as picture:
            assert picture.format == "PNG"
            assert picture.width > 300
    assert "pictures/ball" not in page
    assert not (out / "pictures/ball.png").exists()


def test_the_error_budget_has_every_step(quick):
    ladders = json.loads((quick[0] / "accuracy.json").read_text())["ladders"]
    paper = [row["step"] for row in ladders if (row["scene"], row["quality"]) == ("ball", "paper")]
    assert paper == [
        "one sample a pixel", "one depth a splat", "9-bit depth", "whole places",
        "whole diameters", "levels of n'", "shading table", "materials", "3-bit colour",
    ]  # fmt: skip
    exact = [
        row["step"]
        for row in ladders
        if (row["scene"], row["quality"], row["preset"]) == ("ball", "exact", "paper")
    ]
    assert exact == [
        "one sample a pixel", "one depth a fraction", "9-bit depth", "shading table", "materials",
        "3-bit colour",
    ]  # fmt: skip


def test_the_error_budget_of_planes_has_one_sample_a_pixel_and_sixteen(quick):
    ladders = json.loads((quick[0] / "accuracy.json").read_text())["ladders"]
    for samples, first in ((1, "one sample a pixel"), (16, "16 samples a pixel")):
        key = "ball", "plane", samples
        here = [
            row for row in ladders if (row["scene"], row["preset"], row["samples"]) == key
            and row["splats"] == "auto"
        ]  # fmt: skip
        assert [row["step"] for row in here] == [
            first, "12-bit depth", "7-bit slopes", "shading table", "materials", "8-bit colour",
        ]  # fmt: skip
    page = (quick[0] / "accuracy.md").read_text()
    assert "Preset `plane`, quality `exact \N{MULTIPLICATION SIGN}16`, splats of the" in page
    assert "Largest losses in the mean: " in page


def test_the_number_of_runs_is_known_before(quick):
    lines = quick[1].stderr.splitlines()
    said = [line for line in lines if " %  " in line and "Compiling" not in line]
    assert [int(line.split("%")[0]) for line in said] == list(range(0, 100, 10))


def test_every_engine_of_the_sweep_has_a_name_that_is_known():
    whole = Sweep((), ("terrain",), (None,), (24, 24))
    assert {run.preset for run in plan(whole, None)} - {None} <= set(CONFIGS)


def test_each_view_has_its_own_sheet(tmp_path):
    sweep = Sweep(
        (ball(tmp_path / "ball.csv"),), (), ((0.0, 0.0), (40.0, 10.0)), (24, 24),
        splats=(None,), presets=("paper",), ladders=(None,), repeats=1,
    )  # fmt: skip
    steps = []
    results, crops = measure(sweep, steps.append)
    assert len(steps) == sweep.total()
    assert {tuple(entry["orbit"]) for entry in results["runs"]} == set(sweep.views)
    files = write_accuracy(tmp_path / "out", results, crops)
    assert {"ball_0_0.png", "ball_40_10.png"} <= {path.name for path in files}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--scene", "sea"), "no scene named 'sea'"),
        (("none.ply",), "none.ply: no such file"),
        (("knot.csv", "--scene", "knot"), "two clouds are called 'knot'"),
        (("--out-dir", "knot.csv"), "is a file"),
        (("--no-pictures", "sea"), "no pictures of 'sea' to leave out; there are: terrain, knot"),
    ],
)
def test_what_cannot_be_measured_is_said_in_one_line(run, folder, cloud, arguments, words):
    (folder / "knot.csv").write_bytes(cloud.read_bytes())
    result = run("bench", "accuracy", *arguments, "--quick")
    assert result.exit_code == 2
    assert result.stderr.splitlines()[-1].startswith("splatline: ")
    assert words in result.stderr
    assert not (folder / "docs").exists()


def entry(quality, preset="paper", splats="auto", psnr=30.0, holes=0.0, words=110, samples=1):
    return {
        "scene": "knot", "orbit": [0.0, 0.0], "quality": quality, "preset": preset,
        "splats": splats, "psnr_db": psnr, "hole_fraction": holes, "codewords": words,
        "control_words": 10, "elements": 100, "switched": None,
        "samples": samples,
    }  # fmt: skip


def test_the_verdicts_are_those_of_the_targets():
    runs = [
        entry(FLOAT, None, psnr=33.0, holes=0.01),
        entry(FLOAT_ONE_DEPTH, None, psnr=32.0),
        entry("exact", psnr=31.6, holes=0.0109),
        entry(FLOAT_ONE_DEPTH, None, 7.0, psnr=30.0),
        entry("exact", splats=7.0, psnr=30.1),
        entry(FLOAT_ONE_DEPTH, None, 14.0, psnr=30.0),
        entry("exact", splats=14.0, psnr=29.9),
        entry("paper", splats=3.5, psnr=25.0),
        entry("exact", splats=3.5, psnr=33.9, samples=4),
        entry("paper", splats=3.5, psnr=27.0, samples=4),
        entry("exact", splats=3.5, psnr=31.0),
        entry("fast", splats=3.5, psnr=30.4, words=111),
    ]
    verdicts = {row["target"]: (row["figure"], row["met"]) for row in judge(runs)}
    assert verdicts == {
        "one_depth": (-0.4, True),
        "large": (-0.1, False),
        "over_paper": (6.0, True),
        "four_samples": (6.9, True),
        "fast": (0.6, False),
        "one_word": (1.01, False),
        "holes": (1.09, True),
    }
    assert list(verdicts) == [name for name in TARGETS if not name.startswith("plane")]


def test_planes_are_judged_at_both_sizes_and_in_the_mean():
    runs = [
        entry(FLOAT, None, psnr=38.0),
        entry(FLOAT, None, TWICE, psnr=35.0),
        entry(FLOAT_DEPTHS, None, psnr=44.0, samples=4),
        entry(FLOAT_DEPTHS, None, TWICE, psnr=42.0, samples=4),
        entry("exact", "plane", psnr=37.0),
        entry("exact", "plane", TWICE, psnr=33.7),
        entry("exact", "plane", psnr=43.6, samples=4),
        entry("exact", "plane", TWICE, psnr=41.6, samples=4),
        {**entry("exact", "plane", psnr=30.0, samples=4), "scene": "terrain"},
    ]
    verdicts = {row["target"]: (row["figure"], row["met"]) for row in judge(runs[:-1])}
    assert verdicts["plane"] == (-1.3, False)
    assert verdicts["plane_samples"] == (-0.4, True)
    means = [(row["samples"], row["psnr_db"], row["met"]) for row in judge_means(runs)]
    assert means == [(1, 37.0, None), (4, 36.8, False)]
    table = plane_section(runs)[-1]
    assert "| knot (0, 0) | twice as large | 35.0 / - / - | - / 42.0 / - | - / - / - |" in table
    assert "| -1.30, **not met** | -0.40, met |" in table
    assert plane_section(runs[:2]) == []


def test_every_engine_with_planes_is_measured_but_for_variants():
    assert plane_presets()[0] == "plane"
    assert all(CONFIGS[name].plane for name in plane_presets())
    assert set(plane_presets()) <= set(Sweep((), (), ()).presets)


def test_holes_where_float_has_none_are_infinitely_many():
    bar = entry(FLOAT, None)
    assert judge([bar, entry("exact")])[0]["met"]
    worse = judge([bar, entry("exact", holes=0.001)])[0]
    assert (worse["figure"], worse["met"]) == (None, False)


def test_every_size_that_the_command_takes_is_one_of_the_sweep():
    assert tuple(ACCURACY_SIZES.values()) == Sweep((), (), ()).splats
