import io

import numpy as np
import pytest
from PIL import Image

from splatline.plots import sheet

STATS = {
    "cloud": "/scans/a_lion.ply", "size": [512, 512], "preset": "paper", "points": 138632,
    "view": {"orbit": (30.0, 20.0), "fov": 35.0}, "culled": {"outside": 3, "facing_away": 4},
    "elements": 101573, "codewords": 101839, "control_words": 266, "cycles": 123456,
    "cycles_per_element": 1.2345, "mismatched_pixels": 0, "psnr_db": 27.88, "ssim": None,
}  # fmt: skip


def random_panels(count, width, height, seed=6):
    rng = np.random.default_rng(seed)
    levels = rng.integers(0, 256, (count, height, width, 3))
    return [sheet.Panel(rgb / 255.0, f"Panel {n}", "what it is") for n, rgb in enumerate(levels)]


def compose(panels, stats=STATS):
    with Image.open(io.BytesIO(sheet.compose(panels, stats))) as picture:
        return np.asarray(picture.convert("RGB"))


def find(figure, picture):
    """Places in a figure at which a picture is found, pixel for pixel."""
    high, wide = picture.shape[:2]
    corner = (figure[: 1 - high or None, : 1 - wide or None] == picture[0, 0]).all(axis=2)
    return [
        (int(y), int(x))
        for y, x in np.argwhere(corner)
        if (figure[y : y + high, x : x + wide] == picture).all()
    ]


@pytest.mark.parametrize("count", [4, 5])
@pytest.mark.parametrize("size", [(400, 380), (420, 40), (60, 512)])
def test_every_picture_is_in_the_figure_pixel_for_pixel(count, size):
    panels = random_panels(count, *size)
    figure = compose(panels)
    places = []
    for panel in panels:
        found = find(figure, np.rint(panel.rgb * 255).astype(np.uint8))
        assert len(found) == 1
        places += found
    # Rows and columns of a grid, none over another.
    assert places == sorted(places)
    wide, high = size
    for n, (top, left) in enumerate(places):
        for other_top, other_left in places[n + 1 :]:
            assert abs(top - other_top) >= high or abs(left - other_left) >= wide


def test_a_small_picture_is_enlarged_by_a_whole_factor():
    panels = random_panels(4, 30, 20)
    picture = np.rint(panels[3].rgb * 255).astype(np.uint8)
    enlarged = picture.repeat(12, axis=0).repeat(12, axis=1)
    assert len(find(compose(panels), enlarged)) == 1


def test_a_large_picture_is_reduced_to_means():
    panels = [sheet.Panel(np.zeros((9, 2049, 3)), "", "")] * 4
    panels[0].rgb[:, ::3] = 0.6  # a third of every block of 3 x 3
    figure = compose(panels)
    assert figure.shape[1] < 3 * 2049
    assert len(find(figure, np.full((3, 683, 3), 51, np.uint8))) == 4


@pytest.mark.parametrize("count", [4, 5])
def test_the_table_has_room_beside_a_flat_picture(count):
    figure = compose(random_panels(count, 400, 8))
    border = np.concatenate([figure[-10:].reshape(-1, 3), figure[:, -20:].reshape(-1, 3)])
    assert (border == figure[0, 0]).all()


def texts(stats):
    return [(row.label, row.value) for row in sheet._rows(stats)]


def test_the_table_shows_the_numbers_that_there_are():
    assert texts(STATS) == [
        ("Cloud", None), ("Points", "138,632"), ("Left out", "7"), ("Elements drawn", "101,573"),
        ("Code words", "101,839"), ("of them control words", "266"),
        ("Verilog", None), ("Clock cycles", "123,456"), ("Cycles an element", "1.234"),
        ("Pixels unlike golden", "0"),
        ("Engine against reference", None), ("PSNR", "27.88 dB"),
    ]  # fmt: skip
    assert texts({"cycles": None, "psnr_db": None}) == []


def test_a_mismatch_is_shown_in_another_colour():
    colours = {count: sheet._rows({"mismatched_pixels": count})[1].colour for count in (0, 1, 99)}
    assert colours == {0: sheet.GOOD, 1: sheet.BAD, 99: sheet.BAD}
    panels = random_panels(5, 360, 360)
    good = compose(panels, {**STATS, "mismatched_pixels": 0})
    bad = compose(panels, {**STATS, "mismatched_pixels": 9})
    assert (good != bad).any()


@pytest.mark.parametrize("name", [r"$\frac{ {a} %d$.ply", "\N{CJK UNIFIED IDEOGRAPH-72EE}.ply", ""])
def test_any_name_can_be_a_title(name):
    assert compose(random_panels(4, 40, 40), {"cloud": name}).any()


def test_no_numbers_make_a_figure_too():
    assert compose(random_panels(4, 40, 40), {}).any()


def test_the_figure_is_the_same_every_time():
    panels = random_panels(5, 100, 50)
    assert sheet.compose(panels, STATS) == sheet.compose(panels, STATS)


@pytest.mark.parametrize("count", [3, 6])
def test_only_four_or_five_pictures_have_room(count):
    with pytest.raises(ValueError, match=f"not {count}"):
        sheet.compose(random_panels(count, 8, 8), {})


def test_pictures_of_two_sizes_are_refused():
    panels = [*random_panels(3, 8, 8), *random_panels(1, 9, 8)]
    with pytest.raises(ValueError, match="one size"):
        sheet.compose(panels, {})
