"""The page of Python mutants."""

import json
import re
from importlib import metadata
from pathlib import Path

from tests.python_mutants.equal import EQUAL
from tests.python_mutants.groups import GROUPS

__all__ = ["GOAL", "write_page"]

GOAL = 0.85
"""Share that the tests of a group must notice, of the mutants that are not equal."""


def write_page(kept: Path, page: Path) -> list[str]:
    """Write the page from the verdicts in a folder; return what misses the goal, a line each."""
    told, survived = [], []
    rows = [
        "# Mutants of the Python code\n",
        "How well would the tests notice a fault of the software? `make python-mutants` changes one"
        " operator, number or condition of a file, and runs the tests of its group until one fails."
        f" Mutants are chosen at random by cosmic-ray {metadata.version('cosmic-ray')}. Those that"
        " only change annotations, or how numba compiles, are left out. So are operators that are"
        " replaced by one of another kind, such as `+` by `<<`.\n",
        "The *score* is the share of the noticed, those that hang included, among those that are"
        " not shown to be equal.\n",
        "| group | files | seeds | mutants | noticed | hung | equal | left | score | goal |",
        "|---|---|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for group in GROUPS:
        files = sorted(kept.glob(f"{group.name}-*.json"))
        verdicts = [each for file in files for each in json.loads(file.read_text())]
        left = [each for each in verdicts if each["verdict"] == "survived"]
        survived += left
        equal = sum(_reason(each) != "" for each in left)
        noticed, hung = (
            sum(each["verdict"] == verdict for each in verdicts) for verdict in ("noticed", "hung")
        )
        score = (noticed + hung) / max(1, len(verdicts) - equal)
        if score < GOAL:
            told.append(f"{group.name}: {score:.0%} are noticed, not {GOAL:.0%}")
        seeds = ", ".join(re.sub(r".*-", "", file.stem) for file in files) or "none"
        modules = ", ".join(f"`{pattern}`" for pattern in group.modules)
        rows.append(
            f"| {group.name} | {modules} | {seeds} | {len(verdicts)} | {noticed} | {hung} | {equal}"
            f" | {len(left) - equal} | {score:.0%} | {GOAL:.0%} |"
        )
    for title, is_equal in (("Equal", True), ("Not noticed", False)):
        rows += [f"\n## {title}\n", *_table([e for e in survived if bool(_reason(e)) == is_equal])]
    page.write_text("\n".join([*rows, ""]))
    return told


def _reason(mutant: dict) -> str:
    """Return why a mutant changes no result; nothing if it may."""
    return EQUAL.get((mutant["file"], mutant["after"]), "")


def _table(mutants: list[dict]) -> list[str]:
    """Return the rows of a table of mutants."""
    rows = ["| file | line | is | with the change | why it is equal |\n|---|---:|---|---|---|"]
    for each in sorted(mutants, key=lambda each: (each["file"], each["line"])):
        before, after = (each[name].replace("|", "\\|") for name in ("before", "after"))
        cells = f"`{each['file']}`", each["line"], f"`{before}`", f"`{after}`", _reason(each)
        rows.append(f"| {' | '.join(map(str, cells))} |")
    return rows if mutants else ["None."]
