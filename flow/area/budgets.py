"""What each preset may take: recorded in ``budgets.json``, so that growth is a change one can see.

The counts are exact and the same on every machine, hence so are the budgets: a preset that needs
one LUT more says so with ``splatline synth --record``.
"""

from __future__ import annotations

import json
from pathlib import Path

__all__ = ["BUDGETS", "budget_name", "over_budget", "read_budgets", "record"]

BUDGETS = Path(__file__).with_name("budgets.json")
"""By preset, ``lut4``, ``ff``, ``bram`` and ``mult``."""


def read_budgets() -> dict[str, dict[str, int]]:
    """Return the recorded counts of every preset that has any."""
    return json.loads(BUDGETS.read_text()) if BUDGETS.exists() else {}


def budget_name(preset: str, top: str = "engine") -> str:
    """Return what a preset's budget is recorded as: by itself, or within another top module."""
    return preset if top == "engine" else f"{preset}, {top}"


def over_budget(counts: dict[str, int], budget: dict[str, int] | None) -> dict[str, int]:
    """Return by how many each kind of resource is over its budget; nothing where none is."""
    return {
        kind: counts[kind] - allowed
        for kind, allowed in (budget or {}).items()
        if counts[kind] > allowed
    }


def record(preset: str, counts: dict[str, int]) -> None:
    """Make a preset's counts its budget; the others' stay."""
    budgets = {**read_budgets(), preset: counts}
    rows = (f"  {json.dumps(name)}: {json.dumps(row)}" for name, row in sorted(budgets.items()))
    BUDGETS.write_text("{\n" + ",\n".join(rows) + "\n}\n")
