"""Clouds larger than the memory, and many files, through ``splatline render``."""

import json

import numpy as np
import pytest
from PIL import Image

from splatline.host.large import plan
from tests.host.large.test_draw_parts import hills, write_las
from tests.host.large.test_ply_pieces import faces, write_ply


@pytest.fixture
def scan(folder):
    return write_las(folder / "hills.laz", *hills(30_000, 5))


def numbers_of(folder):
    return json.loads((folder / "a.json").read_text())


def pixels(path):
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def test_a_file_that_needs_more_memory_is_drawn_in_parts(run, folder, scan, monkeypatch):
    small = ["--size", "96x96", "--stats", "a.json"]
    assert run("render", scan, *small, "-o", "whole.png").exit_code == 0
    assert "parts" not in numbers_of(folder)
    monkeypatch.setattr(plan, "PART_POINTS", 10_000)
    result = run("render", scan, *small, "-o", "parts.png", "--memory", "501M")
    assert result.exit_code == 0, result.stderr
    assert "drawn as one, in 3 parts" in " ".join(result.stdout.replace("│", " ").split())
    numbers = numbers_of(folder)
    assert numbers["parts"] == 3
    assert numbers["points"] == 30_000
    assert numbers["dropped"]["finer"] > 0
    assert numbers["view"]["up"] == "z"
    unlike = np.abs(pixels(folder / "whole.png") - pixels(folder / "parts.png")).mean()
    assert unlike < 12


def test_a_picture_larger_than_the_engine_s_is_drawn_in_tiles_of_parts(run, folder, scan):
    wide = ["--size", "700x540", "--orbit", "0,70", "--stats", "a.json"]
    result = run("render", scan, *wide, "-o", "tiles.png", "--memory", "501M")
    assert result.exit_code == 0, result.stderr
    numbers = numbers_of(folder)
    assert numbers["points"] == 30_000
    assert numbers["tiles"] == 4
    one = run("render", scan, *wide, "-o", "one.png", "--memory", "501M", "--preset", "wide2048")
    assert one.exit_code == 0, one.stderr
    assert "tiles" not in numbers_of(folder)
    tiles, whole = pixels(folder / "tiles.png"), pixels(folder / "one.png")
    assert tiles.shape == whole.shape == (540, 700, 3)
    assert np.abs(tiles - whole).mean() < 6  # wide2048 has coarser intensities


@pytest.mark.parametrize("memory", [[], ["--memory", "501M"]], ids=["whole", "parts"])
def test_noise_is_drawn_if_it_is_kept(run, folder, memory):
    positions, colours = hills(20_000, 5)
    classes = np.where(np.arange(20_000) < 600, 7, 2)
    write_las(folder / "a.laz", positions, colours, classification=classes)
    small = ["a.laz", "--size", "96x96", "--stats", "a.json", *memory]
    for keep, noise in (((), 600), (("--keep", "noise"), None)):
        result = run("render", *small, *keep)
        assert result.exit_code == 0, result.stderr
        assert numbers_of(folder)["dropped"].get("noise") == noise


def test_a_cloud_in_parts_is_coloured_by_height(run, folder, scan):
    small = ["--size", "96x96", "--stats", "a.json", "--memory", "501M"]
    result = run("render", scan, *small, "--colour", "height", "--map", "turbo")
    assert result.exit_code == 0, result.stderr
    assert "height along z" in result.stdout
    assert numbers_of(folder)["colour"]["map"] == "turbo"


def test_a_binary_ply_that_needs_more_memory_is_drawn_in_parts(run, folder, monkeypatch):
    monkeypatch.setattr(plan, "PART_POINTS", 10_000)
    write_ply(folder / "a.ply", after=[faces()])
    small = ["a.ply", "--size", "96x96", "--up", "z", "--stats", "a.json"]
    assert run("render", *small, "-o", "whole.png").exit_code == 0
    assert "parts" not in numbers_of(folder)
    result = run("render", *small, "-o", "parts.png", "--memory", "501M")
    assert result.exit_code == 0, result.stderr
    assert numbers_of(folder)["parts"] == 3
    assert numbers_of(folder)["points"] == 30_000
    unlike = np.abs(pixels(folder / "whole.png") - pixels(folder / "parts.png")).mean()
    assert unlike < 12
    sampled = run("render", *small, "--memory", "501M", "--sample", 500)
    assert sampled.exit_code == 0, sampled.stderr
    assert "parts" not in numbers_of(folder)


def test_many_files_are_one_cloud(run, folder, scan, cloud):
    positions, colours = hills(30_000, 6)
    write_las(folder / "other.las", positions + np.array([100, 0, 0]), colours)
    result = run("render", scan, "other.las", "--size", "96x96", "--stats", "a.json")
    assert result.exit_code == 0, result.stderr
    assert numbers_of(folder)["points"] == 60_000
    assert (folder / "hills.png").exists()
    result = run("encode", scan, "other.las", "-o", "a.frame")
    assert result.exit_code == 0, result.stderr
    assert run("play", "a.frame", "-o", "played.png").exit_code == 0


def test_dask_draws_the_same_picture(run, folder, scan, monkeypatch):
    pytest.importorskip("distributed", reason="needs the extra dask")
    monkeypatch.setattr(plan, "PART_POINTS", 10_000)
    alone = run("render", scan, "--size", "96x96", "-o", "one.png", "--memory", "501M")
    assert alone.exit_code == 0, alone.stderr
    result = run(
        "render", scan, "--size", "96x96", "-o", "many.png", "--dask", "local", "--stats", "a.json"
    )
    assert result.exit_code == 0, result.stderr
    assert np.array_equal(pixels(folder / "one.png"), pixels(folder / "many.png"))
    numbers = numbers_of(folder)
    assert (numbers["parts"], numbers["dask_tasks"]) == (3, 3 + 2)
    assert 0 < numbers["dask_bytes"] < 5 * 96 * 96 * 8


@pytest.mark.parametrize("samples", [1, 4])
def test_dask_draws_the_same_tiles(run, folder, scan, monkeypatch, samples):
    pytest.importorskip("distributed", reason="needs the extra dask")
    monkeypatch.setattr(plan, "PART_POINTS", 10_000)
    wide = ["--size", "700x1300", "--memory", "501M", "--samples", samples, "--stats", "a.json"]
    alone = run("render", scan, *wide, "-o", "one.png", "--depth", "one_depth.png")
    assert alone.exit_code == 0, alone.stderr
    numbers = numbers_of(folder)
    result = run(
        "render", scan, *wide, "-o", "many.png", "--depth", "many_depth.png", "--dask", "local"
    )
    assert result.exit_code == 0, result.stderr
    for name in ("{}.png", "{}_depth.png"):
        one, many = (folder / name.format(which) for which in ("one", "many"))
        assert one.read_bytes() == many.read_bytes()
    shared = numbers_of(folder)
    assert shared.pop("dask_tasks") == 3 + 3 * (3 + 1 + 1)
    assert 0 < shared.pop("dask_bytes") < 3 * samples * 700 * 1300 * 8
    assert shared.pop("seconds").keys() == numbers.pop("seconds").keys()
    assert shared == numbers


def test_verilog_of_a_cluster_s_tiles_is_simulated_here(run, folder, scan, monkeypatch):
    pytest.importorskip("distributed", reason="needs the extra dask")
    options = ["--size", "700x300", "--memory", "501M", "--dask", "local", "--engine", "rtl"]
    result = run("render", scan, *options, "--stats", "a.json")
    assert result.exit_code == 0, result.stderr
    assert numbers_of(folder)["mismatched_pixels"] == 0
    assert numbers_of(folder)["cycles"] > 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--reference"], "the exact reference is drawn of a cloud that fits the memory alone"),
        (["--shapes", "rom"], "--shapes rom goes with one cloud that fits the memory"),
        (["--sample", "5"], "--sample goes with one cloud that fits the memory"),
        (["--format", "laz"], "--format goes with one cloud that fits the memory"),
    ],
)
def test_what_does_not_go_with_parts_is_one_line(run, scan, options, message):
    result = run("render", scan, scan, "--size", "32x32", *options)
    assert result.exit_code == 2
    assert message in result.stderr.splitlines()[-1]


@pytest.mark.parametrize("size", ["2", "0G", "many", "-1G", "1e3G"])
def test_a_size_of_memory_that_is_none_is_one_line(run, scan, size):
    result = run("render", scan, f"--memory={size}")
    assert result.exit_code == 2
    assert "is no size of memory; write one like 500M or 2G" in result.stderr


def test_memory_and_dask_need_a_cloud(run):
    for option in ("--memory=1G", "--dask=local"):
        result = run("render", option)
        assert result.exit_code == 2
        assert "needs a CLOUD" in result.stderr


def test_a_missing_file_among_many_is_one_line(run, folder, scan):
    result = run("render", scan, "none.laz", "--size", "32x32")
    assert result.exit_code == 2
    assert "none.laz: cannot be read: No such file or directory" in result.stderr
    assert not list(folder.glob("*.png"))
