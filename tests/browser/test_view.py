"""`splatline view` in the browser: what is seen is what golden draws."""

import io
import shlex
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from .golden_terrain import golden
from .scripted_server import until

SMALL = {"viewport": {"width": 840, "height": 500}}  # a canvas of 512 x 500: no tiles
MIDDLE = (256, 250)
SPLATLINE = [sys.executable, "-c", "from splatline.cli.main import main; main()"]


def run(command, folder):
    """Run a command line of splatline."""
    words = shlex.split(command)
    assert words[0] == "splatline"
    subprocess.run([*SPLATLINE, *words[1:]], cwd=folder, check=True, capture_output=True)


def test_the_canvas_shows_goldens_pixels(terrain_viewer, open_page, screenshot):
    page = open_page(terrain_viewer.address)
    settings = page.settled()
    np.testing.assert_array_equal(page.pixels(), golden(settings, page.canvas_size()).rgba)
    assert page.text("#cloud") == "terrain"
    assert page.text("#facts") == "138,632 points"
    screenshot(page, "terrain")


@pytest.mark.parametrize(
    "gesture",
    [
        pytest.param(lambda page: page.drag(MIDDLE, (300, 200)), id="drag"),
        pytest.param(lambda page: page.drag(MIDDLE, (180, 300), button="right"), id="pan"),
        pytest.param(lambda page: page.page.mouse.wheel(0, -300), id="zoom"),
        pytest.param(lambda page: page.page.mouse.dblclick(200, 300), id="look"),
        pytest.param(lambda page: page.page.keyboard.press("5"), id="top"),
    ],
)
def test_after_a_gesture_the_canvas_shows_goldens_pixels(terrain_viewer, open_page, gesture):
    page = open_page(terrain_viewer.address, SMALL)
    before = page.settled()
    page.page.mouse.move(*MIDDLE)
    after = page.settled(lambda: gesture(page))
    assert after["camera"] != before["camera"]
    np.testing.assert_array_equal(page.pixels(), golden(after, page.canvas_size()).rgba)
    assert page.settled(lambda: page.page.keyboard.press("r"))["camera"] == before["camera"]


def test_settings_are_those_of_the_picture(terrain_viewer, open_page, screenshot):
    page = open_page(terrain_viewer.address, SMALL)
    page.settled()
    page.settled(lambda: page.page.select_option("#preset", "plane"))
    page.settled(lambda: page.page.select_option("#quality", "fast"))
    page.settled(lambda: page.page.select_option("#lights", "side"))
    page.settled(lambda: page.page.locator("#background").fill("#204060"))
    settings = page.settled(lambda: page.page.check("#samples input[value='4']", force=True))
    expected = golden(settings, page.canvas_size())
    chosen = [settings[name] for name in ("preset", "quality", "lights", "background", "samples")]
    assert chosen == ["plane", "fast", "side", "#204060", 4]
    np.testing.assert_array_equal(page.pixels(), expected.rgba)
    figures = page.text("#figures")
    assert f"{expected.counts['codewords']:,}" in figures
    assert f"{expected.counts['elements']:,}" in figures
    assert page.text("#clock").startswith("plane at ")
    screenshot(page, "settings")


def test_colour_by_a_field(terrain_viewer, open_page, screenshot):
    page = open_page(terrain_viewer.address, SMALL)
    page.settled()
    before = page.pixels()
    settings = page.settled(lambda: page.page.select_option("#colour-by", "height"))
    assert settings["colour"]["by"] == "height"
    assert (page.pixels() != before).any()
    settings = page.settled(lambda: page.page.select_option("#colour-map", index=2))
    assert settings["colour"]["map"] == page.page.input_value("#colour-map")
    screenshot(page, "height")


def test_depth_and_back(terrain_viewer, open_page, screenshot):
    page = open_page(terrain_viewer.address, SMALL)
    page.settled()
    before = page.pixels()
    page.settled(lambda: page.page.keyboard.press("d"))
    depth = page.pixels()
    assert (depth[..., 0] == depth[..., 2]).all() and (depth != before).any()
    assert page.page.get_attribute("#depth", "aria-pressed") == "true"
    screenshot(page, "depth")
    page.settled(lambda: page.page.click("#depth"))
    np.testing.assert_array_equal(page.pixels(), before)


def test_the_split_shows_the_papers_engine_beside_the_reference(
    terrain_viewer, open_page, screenshot
):
    page = open_page(terrain_viewer.address, SMALL)
    page.settled()
    settings = page.settled(lambda: page.page.check("#compare"))
    assert settings["split"] == {"left": "paper", "right": "reference"}
    page.stage(kind=2)
    half = page.canvas_size()[0] // 2
    as_paper = {**settings, "preset": "paper", "quality": "paper"}
    paper = golden(as_paper, page.canvas_size()).rgba
    np.testing.assert_array_equal(page.pixels()[:, :half], paper[:, :half])
    assert (page.pixels()[:, half:] != paper[:, half:]).any()
    assert "dB" in page.text("#figures")
    screenshot(page, "split")


def test_the_saved_png_is_the_picture(terrain_viewer, open_page):
    page = open_page(terrain_viewer.address, SMALL)
    settings = page.settled(lambda: page.drag(MIDDLE, (300, 230)))
    name, data = page.downloaded("#save-png")
    assert name == "terrain.png"
    saved = np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))
    np.testing.assert_array_equal(saved, golden(settings, page.canvas_size()).rgba)


def test_play_draws_the_saved_code_words(terrain_viewer, open_page, tmp_path):
    page = open_page(terrain_viewer.address, SMALL)
    page.settled()
    name, data = page.downloaded("#save-words")
    assert name == "terrain-words.zip"
    zipfile.ZipFile(io.BytesIO(data)).extractall(tmp_path)
    run("splatline play terrain.frame -o played.png", tmp_path)
    played = np.asarray(Image.open(tmp_path / "played.png").convert("RGBA"))
    np.testing.assert_array_equal(played, page.pixels())


def test_the_copied_command_draws_the_picture(terrain_viewer, open_page, tmp_path):
    allowed = ["clipboard-read", "clipboard-write"]
    page = open_page(terrain_viewer.address, SMALL, permissions=allowed)
    page.settled(lambda: page.drag(MIDDLE, (200, 220)))
    page.page.click("#copy")
    page.page.wait_for_selector("#command:not([hidden])")
    command = page.text("#command")
    page.page.wait_for_selector("#copy:text('Copied')")
    assert page.page.evaluate("navigator.clipboard.readText()") == command
    run(command, tmp_path)
    (made,) = Path(tmp_path).glob("*.png")
    np.testing.assert_array_equal(np.asarray(Image.open(made).convert("RGBA")), page.pixels())


def test_two_tabs_have_cameras_of_their_own(terrain_viewer, open_page):
    one, other = (open_page(terrain_viewer.address, SMALL) for _ in range(2))
    first = other.settled()
    one.settled()
    turned = one.settled(lambda: one.page.keyboard.press("1"))
    assert turned["camera"]["azimuth"] == 0
    assert other.told("settings")["camera"] == first["camera"]
    np.testing.assert_array_equal(other.pixels(), golden(first, other.canvas_size()).rgba)


def test_a_server_that_comes_back_shows_the_same_picture(view, open_page):
    server = view()
    page = open_page(server.address, SMALL)
    page.settled(lambda: page.page.keyboard.press("7"))
    page.settled(lambda: page.drag(MIDDLE, (300, 200), button="right"))
    page.settled(lambda: page.page.mouse.wheel(0, -200))
    before = page.settled(lambda: page.page.select_option("#lights", "side"))
    picture = page.pixels()
    page.settled(lambda: (server.kill(), view(port=server.port)))
    until(page.page, lambda: page.told("settings") == before)
    page.settled()
    np.testing.assert_array_equal(page.pixels(), picture)


def test_a_bad_file_is_one_line(view, open_page, tmp_path, screenshot):
    bad = tmp_path / "bad.csv"
    bad.write_text("x,y,z\n1,2\nno number,1,2\n")  # what is wrong at its beginning ends the command
    page = open_page(view(bad).address)
    page.page.wait_for_selector("#centre[data-state='error']")
    line = page.text("#centre-text")
    assert "bad.csv" in line and "\n" not in line
    screenshot(page, "bad_file")


def test_nothing_in_view_is_said_with_the_way_back(terrain_viewer, open_page, screenshot):
    page = open_page(terrain_viewer.address, SMALL)
    page.settled()
    page.page.mouse.move(*MIDDLE)
    for _ in range(2):
        page.settled(lambda: page.drag((10, 250), (500, 250), button="right"))
    page.page.wait_for_selector("#centre[data-state='empty']")
    screenshot(page, "nothing_in_view")
    page.settled(lambda: page.page.click("#centre-reset"))
    page.page.wait_for_selector("#centre", state="hidden")
