"""The page of Python mutants."""

import json
import re
from importlib import metadata
from pathlib import Path

from tests.python_mutants.groups import GROUPS

__all__ = ["GOAL", "write_page"]

GOAL = 0.85
"""Share of the mutants of a group that its tests must notice."""


def write_page(kept: Path, page: Path) -> None:
    """Write the page from the verdicts in a folder."""
    rows = [
        "# Mutants of the Python code\n",
        "`make python-mutants` changes one operator, number or condition of a file, and runs the"
        " tests of its group until one fails. Mutants are chosen at random by"
        f" cosmic-ray {metadata.version('cosmic-ray')}. Those that only change annotations, or how"
        " numba compiles, are left out, as are operators of another kind, which no compiler"
        " takes.\n",
        "| group | seeds | mutants | noticed | hung | survived | score | goal |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    survived = []
    for group in GROUPS:
        files = sorted(kept.glob(f"{group.name}-*.json"))
        verdicts = [each for file in files for each in json.loads(file.read_text())]
        if not verdicts:
            rows.append(f"| {group.name} | none | 0 | | | | | {GOAL:.0%} |")
            continue
        count = [
            sum(each["verdict"] == verdict for each in verdicts)
            for verdict in ("noticed", "hung", "survived")
        ]
        seeds = ", ".join(re.sub(r".*-", "", file.stem) for file in files)
        score = (count[0] + count[1]) / len(verdicts)
        rows.append(
            f"| {group.name} | {seeds} | {len(verdicts)} | {count[0]} | {count[1]} | {count[2]} |"
            f" {score:.0%} | {GOAL:.0%} |"
        )
        survived += [each for each in verdicts if each["verdict"] == "survived"]
    rows.append("\n## Not noticed\n")
    rows.append("| file | line | change |\n|---|---:|---|")
    rows += [
        f"| `{each['file']}` | {each['line']} | {each['operator'].removeprefix('core/')} |"
        for each in sorted(survived, key=lambda each: (each["file"], each["line"]))
    ]
    page.write_text("\n".join([*rows, ""]))
