"""The budget of each preset, recorded in ``budgets.json``: growth is visible as a change there.

Counts are exact and the same on every machine, and so are budgets. ``splatline synth --record``
records a new budget.
"""

from __future__ import annotations

from pathlib import Path

from splatline.flow.records import read_records, record_row

__all__ = ["BUDGETS", "budget_name", "over_budget", "read_budgets", "record"]

BUDGETS = Path(__file__).with_name("budgets.json")
"""``lut4``, ``ff``, ``bram`` and ``mult`` of each preset."""


def read_budgets() -> dict[str, dict[str, int]]:
    """Return the recorded counts, by preset."""
    return read_records(BUDGETS)


def budget_name(preset: str, top: str = "engine") -> str:
    """Return the name under which a preset's budget is recorded, in a top module."""
    return preset if top == "engine" else f"{preset}, {top}"


def over_budget(counts: dict[str, int], budget: dict[str, int] | None) -> dict[str, int]:
    """Return the excess over the budget, by kind of resource; only those over it."""
    return {
        kind: counts[kind] - allowed
        for kind, allowed in (budget or {}).items()
        if counts[kind] > allowed
    }


def record(preset: str, counts: dict[str, int]) -> None:
    """Record a preset's counts as its budget."""
    record_row(BUDGETS, preset, counts)
