"""The page of areas by family has every row, and block RAM in each simple engine's."""

import re
from pathlib import Path

from splatline.flow.area.budgets import read_budgets
from splatline.flow.area.families import FAMILY_FLOWS

TEXT = (Path(__file__).parents[2] / "docs/families.md").read_text(encoding="utf-8")
ENGINES = ("rgb24", "rgb24-simple", "small-simple")


def test_each_family_holds_the_simple_engines_in_block_ram():
    rows = re.findall(r"^\| ([\w-]+) \| ([^|]+) \| ([^|]+) \| [^|]+ \| ([^|]+) \|", TEXT, re.M)
    families = [flow.name for flow in FAMILY_FLOWS.values()]
    assert [row[:2] for row in rows[1:]] == [(e, f) for e in ENGINES for f in families]
    lost = {(engine, family) for engine, family, luts, _ in rows[1:] if luts == "-"}
    assert lost == {("rgb24", "iCE40 UP5K"), ("rgb24", "Cyclone V")}


def test_the_counts_of_the_default_on_a_virtex_2_are_its_budget():
    """Both come of the same commands."""
    (row,) = re.findall(r"^\| rgb24 \| Virtex-II \| ([\d,| ]+) \|", TEXT, re.M)
    told = [int(cell.replace(",", "")) for cell in row.split("|")]
    assert told == list(read_budgets()["rgb24"].values())
