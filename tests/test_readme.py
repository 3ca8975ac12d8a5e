"""The README is short, and what it shows works and is today's."""

import re
from pathlib import Path

from splatline.contract.presets import PRESETS
from splatline.flow.area.budgets import read_budgets
from tests.docs.test_presets import number
from tests.docs.test_python import python_blocks, save_as_shown

README = Path(__file__).parents[1] / "README.md"
TEXT = README.read_text(encoding="utf-8")


def test_it_is_short():
    lines = TEXT.splitlines()
    assert len(lines) <= 120
    assert max(map(len, lines)) <= 120


def test_its_moving_picture_is_no_larger_than_2_mb():
    assert (README.parent / "docs/terrain.webp").stat().st_size <= 2_000_000


def test_a_picture_is_saved_as_shown(tmp_path, monkeypatch):
    (block,) = python_blocks(README)
    save_as_shown(block, tmp_path, monkeypatch)


def test_the_manual_s_tables_have_the_same_figures():
    """``tests/docs/test_presets.py`` compares them with what is recorded."""
    page = README.parent / "docs/presets.md"
    clocks = dict(
        re.findall(r"^\| `([\w-]+)` \| XC2V\d+ .*\| (-|[\d.]+ MHz)", page.read_text(), re.M)
    )
    rows = re.findall(
        r"^\| `([\w-]+)` \| ([\d,]+) \| ([\d,]+) \| (\d+) \| [\d.]+ \| (-|[\d.]+ MHz) ", TEXT, re.M
    )
    assert {name for name, *_ in rows} == set(PRESETS)
    for name, *counts, clock in rows:
        budget = read_budgets()[name]
        assert [number(count) for count in counts] == [budget[k] for k in ("lut4", "ff", "bram")]
        assert clock == clocks[name], name


def test_what_the_paper_s_engine_takes_with_pins_is_what_is_recorded():
    told = re.search(r"`paper` takes ([\d,]+), ([\d,]+) and\s+(\d+)\s+with its pins", TEXT).groups()
    budget = read_budgets()["paper, pins"]
    assert [number(count) for count in told] == [budget[kind] for kind in ("lut4", "ff", "bram")]
