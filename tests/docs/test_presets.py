"""The figures of ``docs/presets.md`` are those that are recorded."""

import re
from pathlib import Path

from splatline.contract.presets import PRESETS
from splatline.contract.variants import SHAPED
from splatline.flow.area.budgets import read_budgets
from splatline.flow.area.devices import smallest_device

TEXT = (Path(__file__).parents[2] / "docs/presets.md").read_text(encoding="utf-8")


def number(text):
    """Return a number that has separators of thousands."""
    return int(text.replace(",", ""))


def test_what_the_presets_take_is_what_is_recorded():
    cell = r"[^|]*\|"
    rows = re.findall(
        rf"^\| `([\w-]+)` \|{cell}{cell} ([\d,]+) \| ([\d,]+) \| ([\d,]+) \|", TEXT, re.MULTILINE
    )
    assert {name for name, *_ in rows} == {*PRESETS, *(config.name for config in SHAPED)}
    budgets = read_budgets()
    for name, *told in rows:
        taken = [number(count) for count in told]
        assert taken == [budgets[name][kind] for kind in ("lut4", "ff", "bram")], name


def test_the_devices_of_the_presets_are_the_smallest():
    rows = re.findall(r"^\| `([\w-]+)` \| (XC2V\d+) \| (XC7A\w+) \|", TEXT, re.MULTILINE)
    assert {name for name, *_ in rows} == set(PRESETS)
    for name, *told in rows:
        counts = read_budgets()[name]
        assert told == [smallest_device(family, counts) for family in ("Virtex-II", "Artix-7")]


def test_what_the_paper_s_engine_takes_is_what_is_recorded():
    budgets = read_budgets()
    for kind, name in {
        "lut4": "4-input LUTs", "ff": "flip-flops", "bram": "block RAMs", "mult": "multipliers",
    }.items():  # fmt: skip
        row = re.search(rf"^\| {name} \| ([\d,]+) \| ([\d,]+) ", TEXT, re.MULTILINE)
        told = [number(count) for count in row.groups()]
        assert told == [budgets["paper"][kind], budgets["paper, pins"][kind]]
    on_axi = re.search(r"`--top axi`\) it takes ([\d,]+) LUTs and ([\d,]+) flip-flops", TEXT)
    told = [number(count) for count in on_axi.groups()]
    assert told == [budgets["paper, axi"][kind] for kind in ("lut4", "ff")]
