"""Trials of stalls: every port stalled by every pattern."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from .records import (
    BURSTS,
    CLOSED,
    INITIAL,
    PORTS,
    RANDOM,
    RASTER,
    SHY,
    WORDS,
    WRITES,
    Phase,
)  # fmt: skip
from .stock import Stock, writes_of
from .trial import Trial, phase

__all__ = ["film", "random_stalls", "stall_trials"]

PATTERNS = (
    *((CLOSED, first, cycles) for first in (0, 20, 150, 400) for cycles in (7, 300, 1500)),
    *((RANDOM, rate, 0) for rate in (16, 64, 128, 230)),
    *((BURSTS, *burst) for burst in ((1, 1), (1, 7), (5, 40), (40, 5), (3, 2))),
    *((SHY, cycles, 0) for cycles in (0, 1, 4, 30)),
)
"""A pattern with its two numbers; those of ``SHY`` without the ports that it minds."""

NAMES = {WORDS: "code words", WRITES: "table writes", INITIAL: "initial raster", RASTER: "raster"}


def random_stalls(rng: np.random.Generator, share: float) -> npt.NDArray[np.int64]:
    """Return stalls of all ports, each stalled with a probability: shape (12,)."""
    stalls = np.zeros((len(PORTS), 3), np.int64)
    for port in PORTS:
        if rng.random() < share:
            stalls[port] = _with_mask(PATTERNS[int(rng.integers(len(PATTERNS)))], port, rng)
    return stalls.ravel()


def _with_mask(
    pattern: tuple[int, int, int], port: int, rng: np.random.Generator
) -> tuple[int, ...]:
    """Return a pattern with the ports that it minds, at least one of the others."""
    kind, a, _b = pattern
    if kind != SHY:
        return pattern
    others = [other for other in PORTS if other != port]
    chosen = rng.choice(others, int(rng.integers(1, len(others) + 1)), replace=False)
    return kind, a, int(sum(1 << int(other) for other in chosen))


def film(
    stock: Stock,
    rng: np.random.Generator,
    count: int,
    *kinds: str,
    load: bool = False,
    setup: bool = True,
    **settings: Any,
) -> tuple[Phase, list[int]]:
    """Return a phase of frames of one size without gaps between, and their digests.

    With ``setup`` the frame registers are written before; ``settings`` are those of the phase.
    With ``load`` every frame starts from the size's initial raster.
    """
    config = stock.config
    size = settings.pop("size", None) or stock.size(rng)
    items = [stock.take(rng, size, *kinds) for _ in range(count)]
    if load:
        # A frame after an end word starts from the raster as well, so each has but one frame.
        items = [item for item in items if len(item.digests) == 1]
        items = items or [stock.items[size, "empty"]]
        settings["initial"] = np.concatenate([stock.initial(stock.rasters[size])] * len(items))
    digests = [digest for item in items for digest in (item.loaded if load else item.digests)]
    words = [item.words for item in items]
    if setup:
        settings["writes"] = writes_of(stock.setup(size, load=load))
    made = phase(np.concatenate(words), size, config, digests, **settings)
    return made, digests


def stall_trials(
    stock: Stock, rng: np.random.Generator, numbers: range, total: int
) -> Iterator[Trial]:
    """Yield films under stalls: each port with each pattern first, then all ports at random.

    The trials are those of ``numbers`` among ``total``, as of all functions of this kind.
    """
    single = [(port, pattern) for port in PORTS for pattern in PATTERNS]
    for number in numbers:
        if number < len(single):
            port, pattern = single[number]
            stalls = np.zeros((len(PORTS), 3), np.int64)
            stalls[port] = _with_mask(pattern, port, rng)
            name = f"{NAMES[port]} stalled by {tuple(map(int, stalls[port]))}"
            load = port == INITIAL or rng.random() < 0.3
        else:
            stalls = random_stalls(rng, 0.8).reshape(-1, 3)
            name, load = "all ports stalled", bool(rng.random() < 0.4)
        seed = int(rng.integers(1 << 40))
        part, digests = film(stock, rng, 3, load=load, stalls=stalls.ravel(), seed=seed)
        yield Trial(name, [part], [[digests]])
