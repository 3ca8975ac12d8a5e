"""Trials of single-event upsets: a bit of state is flipped in one cycle of two frames."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from .records import AFTER_FAILURE, AFTER_WRONG, DONE, HANG, SKIPPED, UNLESS_HUNG
from .stall_trials import film
from .stock import Stock, writes_of
from .trial import Trial, silence_bound
from .upsets import Register

__all__ = ["OUTCOMES", "outcome_of", "upset_trials"]

CYCLES = 600
"""Cycles of a film in which an upset may come."""

IN_MEMORY = 0.25
"""Share of the trials whose bit is one of a memory."""

OUTCOMES = (
    "right",
    "this film wrong, the next right",
    "wrong until tables are written",
    "wrong until a reset",
    "hangs until a reset",
    "until reset and tables",
    "not cleared",
)


def upset_trials(
    stock: Stock, rng: np.random.Generator, numbers: Sequence[int], state: list[Register]
) -> Iterator[tuple[Trial, Register]]:
    """Yield a trial of an upset for each number, with the register or memory that it hits.

    Every bit of a register is as likely as every other, and so is every bit of a memory. A film of
    two frames has the upset. Then come, each if the one before it went wrong: two frames with the
    tables as they are, two with tables written anew, one after a reset, one after a reset with all
    tables. Each trial starts with a reset, since a bit that is flipped in a pixel far away stays.
    """
    bits = np.array([part.bits * part.rows for part in state], np.float64)
    memory = np.array([part.rows > 1 for part in state])
    shares = [np.where(chosen, bits, 0) / bits[chosen].sum() for chosen in (~memory, memory)]
    for _ in numbers:
        which = int(rng.choice(len(state), p=shares[int(rng.random() < IN_MEMORY)]))
        part = state[which]
        place = (which, int(rng.integers(part.bits)), int(rng.integers(part.rows)))
        yield _trial(stock, rng, place), part


def _trial(stock: Stock, rng: np.random.Generator, place: tuple[int, int, int]) -> Trial:
    """Return the trial of an upset of register, bit and row."""
    size = stock.size(rng)
    tables = [*stock.materials, *stock.setup(size)]
    begin = stock.config.clear_cycles  # from then on elements are drawn
    plan: list[tuple[int, dict[str, Any]]] = [
        (2, {
            "setup": False, "writes": writes_of(tables), "hold": len(tables), "reset_edges": 1,
            "upset_at": int(rng.integers(begin, begin + CYCLES)), "upset": place,
        }),
        (2, {"setup": False, "condition": UNLESS_HUNG}),
        (2, {"setup": False, "writes": writes_of(tables), "condition": AFTER_WRONG}),
        (1, {"condition": AFTER_FAILURE, "reset_edges": 1}),
        (1, {
            "setup": False, "writes": writes_of(tables), "condition": AFTER_FAILURE,
            "reset_edges": 1,
        }),
    ]  # fmt: skip
    silence = silence_bound(stock.config, size[1], after_reset=True)
    parts = [
        film(
            stock,
            rng,
            count,
            "dense",
            "top",
            "nonsense",
            size=size,
            silence=silence,
            flush=2,
            **settings,
        )
        for count, settings in plan
    ]
    return Trial("upset", [part for part, _ in parts], [[digests] for _, digests in parts])


def outcome_of(trial: Trial, results: Any, frames: Sequence[Any]) -> int:
    """Return the place in ``OUTCOMES`` of what came of an upset."""
    wanted = [digests[0] if digests else [] for digests in trial.digests]
    right = [
        int(result["outcome"]) == DONE
        and not result["breaches"]
        and int(result["closed"]) == len(digests)
        and np.array_equal(found["digest"], np.array(digests, np.int64))
        for result, digests, found in zip(results, wanted, frames, strict=True)
    ]
    played = [int(result["outcome"]) != SKIPPED for result in results]
    hung = any(int(result["outcome"]) == HANG for result in results)
    if played[1] and right[1]:
        return 0 if right[0] else 1
    if played[1] and not played[2] and not hung:
        return 1  # the second of the two frames was right
    if played[2] and right[2]:
        return 2
    if right[3]:
        return 4 if hung else 3
    return 5 if right[4] else 6
