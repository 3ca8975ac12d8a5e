import json

import pytest
from PIL import Image

from splatline.cli.options import drawing as engines
from splatline.cli.options.cloud_and_view import DEFAULT_SCENE
from splatline.host.scenes.scenes import SCENES
from splatline.sim.cosim.simulator import SimulationError

KEYS = {
    "points", "culled", "elements", "codewords", "control_words", "cycles", "cycles_per_element",
    "mismatched_pixels", "seconds",
}  # fmt: skip
QUALITY = {
    "psnr_db", "psnr_foreground_db", "ssim", "hole_fraction", "silhouette_iou", "depth_rmse",
}  # fmt: skip


def files(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_a_cloud_becomes_a_picture_of_its_name_and_size(run, folder, cloud):
    result = run("render", cloud, "--size", "48x32")
    assert result.exit_code == 0, result.stderr
    assert files(folder) == ["ball.png"]
    with Image.open(folder / "ball.png") as picture:
        assert picture.size == (48, 32)
        assert picture.format == "PNG"
        assert len(picture.convert("RGB").getcolors(48 * 32)) > 10
    assert "2,000" in result.stdout


def test_the_statistics_hold_what_the_manual_lists(run, folder, cloud):
    result = run("render", cloud, "--size", "32x32", "--stats", "ball.json")
    assert result.exit_code == 0, result.stderr
    numbers = json.loads((folder / "ball.json").read_text())
    assert set(numbers) >= KEYS
    assert not set(numbers) & QUALITY
    assert numbers["points"] == 2000
    assert numbers["points"] == numbers["elements"] + sum(numbers["culled"].values())
    assert numbers["cycles"] is None
    assert numbers["view"]["up"] == "y"
    assert {"read", "spacing", "golden"} <= set(numbers["seconds"])


def test_specks_are_closed_unless_they_are_kept(run, folder):
    common = ("render", "--scene", "knot", "--size", "200x200", "--splat-size", "0.01")
    drawn = {}
    for specks in ("close", "keep"):
        options = ("--specks", specks, "-o", f"{specks}.png", "--stats", "knot.json")
        result = run(*common, *options)
        assert result.exit_code == 0, result.stderr
        drawn[specks] = json.loads((folder / "knot.json").read_text()), result.stdout
    closed, kept = (drawn[specks][0] for specks in ("close", "keep"))
    assert closed["specks"] > 100
    assert "specks" not in kept
    assert closed["drawn_pixels"] > kept["drawn_pixels"]
    assert closed["codewords"] >= kept["codewords"] + closed["specks"]
    assert f"pixels closed │ {closed['specks']:,}" in drawn["close"][1]
    assert (folder / "close.png").read_bytes() != (folder / "keep.png").read_bytes()


def test_the_reference_adds_the_measures_of_error(run, folder, cloud):
    result = run("render", cloud, "--size", "64x64", "--reference", "--stats", "ball.json")
    assert result.exit_code == 0, result.stderr
    numbers = json.loads((folder / "ball.json").read_text())
    assert set(numbers) >= KEYS | QUALITY
    assert 10.0 < numbers["psnr_foreground_db"] < 60.0
    assert numbers["silhouette_iou"] > 0.8


def test_samples_are_averaged_and_counted_together(run, folder, cloud):
    numbers = {}
    for samples in ("1", "4"):
        options = ["--size", "64x64", "--samples", samples, "--reference", "--stats", "ball.json"]
        result = run("render", cloud, *options)
        assert result.exit_code == 0, result.stderr
        assert ("samples a pixel" in result.stdout) == (samples == "4")
        numbers[samples] = json.loads((folder / "ball.json").read_text())
    one, four = numbers["1"], numbers["4"]
    assert (one["samples"], four["samples"]) == (1, 4)
    # Discs overlap, and the one depth a splat has is not averaged away.
    assert four["psnr_db"] > one["psnr_db"] + 2.0
    assert 3.8 * one["codewords"] < four["codewords"] < 4.2 * one["codewords"]
    assert set(one) == set(four)


def test_the_view_follows_the_options(run, folder, cloud):
    pictures = []
    for options in ([], ["--orbit", "-100,40"], ["--zoom", "2"], ["--up", "z"], ["--fov", "80"],
                    ["--splat-size", "0.5"], ["--background", "#102030"]):  # fmt: skip
        assert run("render", cloud, "--size", "32x32", "-o", "a.png", *options).exit_code == 0
        pictures.append((folder / "a.png").read_bytes())
    assert len(set(pictures)) == len(pictures)


def test_the_background_has_the_colour_asked_for(run, folder, cloud):
    assert run("render", cloud, "--size", "32x32", "--background", "#102030").exit_code == 0
    with Image.open(folder / "ball.png") as picture:
        assert picture.convert("RGB").getpixel((0, 0)) == (0x10, 0x20, 0x30)


def test_depth_is_a_picture_too(run, folder, cloud):
    assert run("render", cloud, "--size", "32x24", "--depth", "depth.png").exit_code == 0
    with Image.open(folder / "depth.png") as picture:
        assert picture.size == (32, 24)


def test_verilog_that_agrees_with_golden_passes(run, folder, cloud, verilog):
    result = run("render", cloud, "--size", "32x32", "--engine", "rtl", "--stall", "0.25",
                 "--seed", "9", "--stats", "a.json")  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert verilog[1] == [(0.25, 9)]
    numbers = json.loads((folder / "a.json").read_text())
    assert numbers["mismatched_pixels"] == 0
    assert numbers["cycles"] == 4321
    assert numbers["cycles_per_element"] == pytest.approx(4321 / numbers["elements"])
    assert (numbers["seconds"]["rtl_build"], numbers["seconds"]["rtl_run"]) == (1.0, 2.0)
    said = result.stderr.splitlines()
    build = said.index("Writing the Verilog and building its simulator, if they are new ...")
    assert said[build + 1] == "Simulating the Verilog ..."


def test_verilog_that_differs_from_golden_fails_but_shows_its_picture(run, folder, cloud, verilog):
    verilog[0].extend([(0, 0), (16, 16)])
    result = run("render", cloud, "--size", "32x32", "--engine", "rtl", "--stats", "a.json")
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1].startswith("splatline: 2 pixels")
    assert json.loads((folder / "a.json").read_text())["mismatched_pixels"] == 2
    assert files(folder) == ["a.json", "ball.png"]


def test_the_verilog_on_its_buses_is_compared_too(run, folder, cloud, verilog, monkeypatch):
    monkeypatch.setattr(engines, "_simulate_on_buses", engines._simulate)
    result = run("render", cloud, "--size", "32x32", "--engine", "axi", "--stall", "0.5",
                 "--stats", "a.json")  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert verilog[1] == [(0.5, 1)]
    numbers = json.loads((folder / "a.json").read_text())
    assert (numbers["engine"], numbers["stall"], numbers["cycles"]) == ("axi", 0.5, 4321)


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (SimulationError("the simulation stopped\nlast line"), 1, "the simulation stopped\nlast"),
        (ModuleNotFoundError("no", name="cocotb_tools"), 2, "the simulation needs cocotb_tools"),
    ],
)
def test_a_simulation_that_cannot_be_says_why(run, folder, cloud, monkeypatch, error, code, words):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr("splatline.sim.cosim.player.frames.simulate_frame", fail)
    result = run("render", cloud, "--size", "16x16", "--engine", "rtl")
    assert result.exit_code == code
    assert words in result.stderr
    assert "Traceback" not in result.stderr
    assert not files(folder)


def test_a_folder_gets_the_whole_set(run, folder, cloud, verilog):
    result = run("render", cloud, "--size", "64x64", "--engine", "rtl", "--out-dir", "build/ball")
    assert result.exit_code == 0, result.stderr
    names = ["depth.png", "difference.png", "engine.png", "figure.png", "golden.png",
             "reference.png", "stats.json"]  # fmt: skip
    assert files(folder) == [f"build/ball/{name}" for name in names]
    numbers = json.loads((folder / "build/ball/stats.json").read_text())
    assert set(numbers) >= KEYS | QUALITY


@pytest.mark.parametrize("scene", SCENES)
def test_the_help_names_every_scene(run, scene):
    assert scene in run("render", "--help").stdout
    assert DEFAULT_SCENE in SCENES


def test_a_cloud_in_the_current_folder_is_not_written_over(run, folder, cloud):
    target = folder / "ball.png"
    target.write_bytes(cloud.read_bytes())
    result = run("render", "ball.png")
    assert result.exit_code == 2
    assert "over the input" in result.stderr
    assert target.read_bytes() == cloud.read_bytes()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["absent.ply"], "absent.ply"),
        (["{cloud}", "-o", "nowhere/a.png"], "no folder nowhere"),
        (["{cloud}", "-o", "a.jpg"], "must end in .png"),
        (["{cloud}", "--depth", "a.tif"], "must end in .png"),
        (["{cloud}", "-o", "a.png", "--depth", "a.png"], "two outputs"),
        (["{cloud}", "--out-dir", "{cloud}"], "is a file"),
        (["{cloud}", "--fov", "200"], "field of view"),
        (["{cloud}", "--zoom", "0"], "zoom"),
        (["{cloud}", "--size", "70000x8"], "65536"),
        (["{cloud}", "--zoom", "1e6", "--splat-size", "1e-9"], "in view"),
        (["{cloud}", "--zoom", "1e98"], "a zoom of 1e+98 does not go with"),
        (["{cloud}", "--fov", "1e-9"], "must be at least 1e-05 and below 180 degrees"),
        (["--scene", "nowhere"], "terrain"),
    ],
)
def test_bad_input_gets_one_line_code_2_and_leaves_nothing(run, folder, cloud, arguments, words):
    result = run("render", *(text.format(cloud=cloud) for text in arguments))
    assert result.exit_code == 2, (result.stdout, result.stderr, result.exception)
    message = result.stderr.splitlines()[-1]
    assert message.startswith("splatline: ")
    assert words in message
    assert sum("splatline:" in line for line in result.stderr.splitlines()) == 1
    assert "Traceback" not in result.stderr
    assert not files(folder)


@pytest.mark.parametrize("content", [b"", b"ply\nformat ascii 1.0\n", b"\x00\x01\x02"])
@pytest.mark.parametrize("suffix", ["ply", "pcd", "csv", "npz", "xyz", "stl"])
def test_a_broken_file_gets_one_line_code_2_and_leaves_nothing(
    run, folder, tmp_path, suffix, content
):
    path = tmp_path / f"broken.{suffix}"
    path.write_bytes(content)
    result = run("render", path, "--stats", "a.json")
    assert result.exit_code == 2, (result.stderr, result.exception)
    assert result.stderr.splitlines()[-1].startswith("splatline: ")
    assert "broken" in result.stderr.splitlines()[-1]
    assert not files(folder)
