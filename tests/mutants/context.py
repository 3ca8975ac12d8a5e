"""Shows that mutants are equal where the design uses them: what :mod:`.prove` leaves.

There a module gets any inputs. Here it gets those of the module that it is a part of, or its window
is followed from a reset on.
"""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from .cleared import may_be_cleared, prove_cleared
from .held_inputs import may_hold_inputs, prove_with_held_inputs
from .keep import ROOT, digest, versions
from .mutate import Mutant, prepared
from .prove import compare
from .rows import prove_row, row_of
from .tops import ENGINE, Design

__all__ = ["CONTEXTS", "prove_in_context"]

CONTEXTS = {
    "cleared": "equal in its window, but for what the clearing after a reset overwrites",
    "parent": "equal in the module that its own is a part of",
    "held": "equal in its window, with the inputs that an engine gives it",
}
"""How a mutant is compared, in this order."""

WHOLE = ("", "splatline", ENGINE)
"""Modules that are too large to compare."""

SECONDS = 150
"""Seconds of PDR in the module around."""

SOURCES = (
    "aig.py",
    "cleared.py",
    "cleared_ports.v",
    "clearing.py",
    "held_inputs.py",
    "invariants.py",
    "lockstep.py",
    "memories.v",
    "memory_ports.v",
    "renamed.py",
    "row_invariants.py",
    "row_ports.v",
    "rows.py",
    "wrapper.py",
)
"""Files that the answers depend on."""


def prove_in_context(design: Design, mutants: Sequence[Mutant]) -> Iterator[str]:
    """Yield for each mutant how it is shown to be equal: one of ``CONTEXTS``, or ``open``."""
    sources = [*(Path(__file__).with_name(name).read_text() for name in SOURCES), str(SECONDS)]
    name = f"{design.name}-{digest(prepared(design).name, sources, versions())}.json"
    kept = ROOT / "contexts" / name
    kept.parent.mkdir(parents=True, exist_ok=True)
    known = json.loads(kept.read_text()) if kept.exists() else {}
    for mutant in mutants:
        key = mutant.arguments()
        if key not in known:
            known[key] = _answer(design, mutant)
            kept.write_text(json.dumps(known, indent=1))
        yield known[key]


def _answer(design: Design, mutant: Mutant) -> str:
    """Return how a mutant is shown to be equal."""
    if may_be_cleared(design, mutant) and prove_cleared(design, mutant):
        return "cleared"
    if row_of(design, mutant) and prove_row(design, mutant):
        return "cleared"
    parent = mutant.module.rpartition("__")[0]
    if parent not in WHOLE and compare(design, [mutant], "parts", parent, SECONDS) == ["equal"]:
        return "parent"
    if may_hold_inputs(design, mutant) and prove_with_held_inputs(design, mutant):
        return "held"
    return "open"
