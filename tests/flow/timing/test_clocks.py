"""The recorded clocks are those that the manual tells."""

import re
from pathlib import Path

import pytest

from splatline.contract.presets import PRESETS
from splatline.flow.timing import clocks

PAGE = Path(__file__).parents[3] / "docs/presets.md"
ROW = re.compile(
    r"^\| `([\w-]+)` \|.*\| (LFE5U-\d+F|none) \| (?:([\d.]+) MHz \(([\d.]+) to ([\d.]+)\)|-) \|$",
    re.MULTILINE,
)


def test_every_preset_has_a_clock_and_the_command_that_made_it():
    recorded = clocks.read_clocks()
    assert set(PRESETS) <= set(recorded)
    for name, clock in recorded.items():
        options = name.replace(", ", " --top ")
        assert clock["command"] == f"splatline pnr --preset {options} --seed 1 --tries 4 --record"


def test_the_table_of_the_presets_has_the_recorded_clocks():
    recorded = clocks.read_clocks()
    rows = {row[1]: row for row in ROW.finditer(PAGE.read_text(encoding="utf-8"))}
    assert set(rows) == set(PRESETS)
    for name, row in rows.items():
        clock = recorded[name]
        told = [None if number is None else float(number) for number in row.groups()[2:]]
        assert told == [clock["median_mhz"], clock["low_mhz"], clock["high_mhz"]]
        assert row[2] == (clock["device"] or "none").removesuffix("-6BG381")


def test_a_clock_is_recorded_with_its_seeds(monkeypatch, tmp_path):
    monkeypatch.setattr(clocks, "CLOCKS", tmp_path / "clocks.json")
    result = {
        "preset": "plane",
        "top": "pins",
        "device": "LFE5U-25F-6BG381",
        "median_mhz": 81.94,
        "rates_mhz": {"3": 79.21, "4": 84.67},
    }
    clocks.record(result)
    clocks.record({**result, "preset": "paper"})
    recorded = clocks.read_clocks()
    assert list(recorded) == ["paper", "plane"]
    assert recorded["plane"] == {
        "device": "LFE5U-25F-6BG381",
        "seeds": [3, 4],
        "median_mhz": pytest.approx(81.9),
        "low_mhz": 79.2,
        "high_mhz": 84.7,
        "command": "splatline pnr --preset plane --seed 3 --tries 2 --record",
    }
