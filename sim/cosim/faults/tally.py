"""Results of trials, as numbers that add up and that JSON holds."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Tally", "from_json", "to_json"]

SUMS = ("trials", "cycles", "words", "frames")
MAXIMA = ("silence", "nearest")


@dataclass
class Tally:
    """Results of trials; tallies add up.

    Parameters
    ----------
    trials, cycles, words, frames
        How many there were; code words that the engine took, and frames that were compared.
    silence
        Most cycles without progress in unstalled cycles.
    nearest
        Largest share of the bound on cycles that a phase without stalls took.
    wrong
        The trials that were not right, a line each.
    outcomes
        Of upsets: by module, ``register`` or ``memory``, and outcome.
    """

    trials: int = 0
    cycles: int = 0
    words: int = 0
    frames: int = 0
    silence: int = 0
    nearest: float = 0.0
    wrong: list[str] = field(default_factory=list)
    outcomes: Counter[tuple[str, str, str]] = field(default_factory=Counter)

    def add(self, other: Tally) -> None:
        """Add another tally."""
        for name in SUMS:
            setattr(self, name, getattr(self, name) + getattr(other, name))
        for name in MAXIMA:
            setattr(self, name, max(getattr(self, name), getattr(other, name)))
        self.wrong += other.wrong
        self.outcomes += other.outcomes


def to_json(tally: Tally) -> dict[str, Any]:
    """Return a tally as JSON holds it."""
    outcomes = [[*key, number] for key, number in sorted(tally.outcomes.items())]
    return {
        **{name: getattr(tally, name) for name in (*SUMS, *MAXIMA)},
        "wrong": tally.wrong,
        "outcomes": outcomes,
    }


def from_json(numbers: dict[str, Any]) -> Tally:
    """Return the tally of :func:`to_json`."""
    outcomes = {tuple(key): number for *key, number in numbers["outcomes"]}
    return Tally(**{**numbers, "wrong": list(numbers["wrong"]), "outcomes": Counter(outcomes)})
