"""Trials of long films on AXI, whose counters must not drift."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from splatline.contract.frame import are_control

from .axi_stock import AxiStock
from .records import WORD, Phase
from .stall_trials import random_stalls
from .stock import writes_of
from .trial import Trial, phase

__all__ = ["FRAMES", "counter_trials"]

FRAMES = 12
"""Frames of the stock in a trial; those that follow an end word come on top."""


def counter_trials(
    stock: AxiStock, rng: np.random.Generator, numbers: range, total: int
) -> Iterator[Trial]:
    """Yield films under stalls, after each of which the counters are read.

    They are cleared before the first one only: what is read is the sum since then.
    """
    config = stock.config
    clear = stock.write("CONTROL", stock.map["CONTROL"]["CLEAR"].mask)
    reads = writes_of([stock.read(name) for name in ("FRAMES", "ELEMENTS", "WORDS")])
    frames = elements = beats = 0
    for number in numbers:
        size = stock.size(rng)
        items = [stock.take(rng, size) for _ in range(FRAMES)]
        words = np.concatenate([item.words for item in items])
        digests = [digest for item in items for digest in item.digests]
        setup = [*([clear] if number == numbers.start else []), *stock.setup(size)]
        part = phase(
            words, size, config, digests, writes=writes_of(setup),
            stalls=random_stalls(rng, 0.2), seed=int(rng.integers(1 << 40)),
        )  # fmt: skip
        frames += len(digests)
        low = words[:, 0] if config.plane else words
        elements += int((~are_control(low, config)).sum())
        beats += sum(item.beats for item in items)
        counted = Phase(np.zeros(0, WORD), writes=reads, frames=0)
        answers = [(-1, frames), (-1, elements), (-1, beats)]
        yield Trial("counters", [part, counted], [[digests], [[]]], [[], answers])
