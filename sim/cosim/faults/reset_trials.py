"""Trials of resets: in every cycle of a long frame, and at random."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .records import RANDOM, WORDS
from .stall_trials import film, random_stalls
from .stock import SIZES, Stock
from .trial import Trial

__all__ = ["CYCLES", "reset_trials"]

CYCLES = 2000
"""First cycles of a frame, in each of which a trial has its reset."""


def reset_trials(
    stock: Stock, rng: np.random.Generator, numbers: range, total: int
) -> Iterator[Trial]:
    """Yield films with a reset, and a frame after it that must be right.

    The cycles of the reset are ``CYCLES`` of one film, evenly spread if there are fewer trials;
    those above are at random in random films.
    """
    first = min(total, CYCLES)
    for number in numbers:
        load = bool(rng.random() < 0.3)
        seed = int(rng.integers(1 << 40))
        if number < first:
            cycle = number * CYCLES // first
            stalls = np.zeros(12, np.int64)
            stalls[3 * WORDS : 3 * WORDS + 2] = RANDOM, 12
            part, digests = film(
                stock, rng, 3, "dense", load=load, size=SIZES[2], seed=7, stalls=stalls,
                reset_at=cycle,
            )  # fmt: skip
        else:
            cycle = int(rng.integers(3000) * rng.random())
            stalls = random_stalls(rng, 0.5)
            part, digests = film(stock, rng, 3, load=load, stalls=stalls, seed=seed, reset_at=cycle)
        edges = int(rng.choice([1, 1, 2, 5]))
        after, wanted = film(
            stock, rng, 1, load=bool(rng.random() < 0.3), reset_edges=edges, seed=seed
        )
        yield Trial(f"reset in cycle {cycle}", [part, after], [[digests], [wanted]])
