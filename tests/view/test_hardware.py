"""What a picture means in hardware."""

import json

import pytest

from splatline.contract.presets import PRESETS
from splatline.flow.area.budgets import read_budgets
from splatline.flow.timing.clocks import read_clocks
from splatline.sim.cycles.cycles import count_cycles
from splatline.view.draw import Settings, draw
from splatline.view.hardware import PRESET_TITLES, picture_numbers, preset_facts
from tests.view.views import ball

SIZE = (128, 96)


@pytest.fixture(scope="module")
def live():
    return ball().read(None)


@pytest.fixture(scope="module")
def camera(live):
    return ball().home(live, SIZE)


def test_presets_have_the_recorded_areas_and_clocks():
    facts = {row["name"]: row for row in preset_facts()}
    assert set(facts) == set(PRESETS) == set(PRESET_TITLES)
    for name, row in facts.items():
        assert {kind: row[kind] for kind in ("lut4", "ff", "bram", "mult")} == read_budgets()[name]
        assert row["clock_mhz"] == read_clocks()[name]["median_mhz"]
        assert row["title"]


@pytest.mark.parametrize(
    ("preset", "samples", "size"),
    [("rgb24", 1, SIZE), ("rgb24", 4, SIZE), ("plane", 1, (600, 96)), ("swift", 1, SIZE)],
)
def test_the_numbers_are_those_of_the_frames(live, camera, preset, samples, size):
    drawing = draw(live, camera, size, Settings(preset=PRESETS[preset], samples=samples))
    numbers = picture_numbers(drawing)
    assert json.loads(json.dumps(numbers, allow_nan=False)) == numbers
    cycles = sum(count_cycles(frame, after_reset=False) for frame in drawing.frames)
    assert numbers["cycles"] == cycles
    assert numbers["codewords"] == sum(len(frame.codewords) for frame in drawing.frames)
    assert numbers["cycles_per_element"] == cycles / numbers["elements"]
    assert numbers["samples"] == samples
    assert (numbers["width"], numbers["height"]) == size
    assert numbers["tiles"] == (2 if size[0] > 512 else 1)
    left_out = sum(numbers["left_out"].values())
    assert numbers["elements"] + left_out == samples * numbers["points"]
    clock = read_clocks()[preset]["median_mhz"]
    if clock is None:
        assert numbers["fps"] is None
    else:
        assert numbers["fps"] * cycles == pytest.approx(1e6 * clock)


def test_a_picture_of_nothing_has_no_cycles_an_element(live, camera):
    away = camera.looking_at((1e4, 0.0, 0.0))
    for size in (SIZE, (600, 96)):
        numbers = picture_numbers(draw(live, away, size))
        assert numbers["elements"] == 0
        assert numbers["cycles_per_element"] is None
