"""Trials of table writes: offered in every cycle of two frames."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np

from splatline.contract.fields import Register
from splatline.contract.frame import Tables
from splatline.contract.raster import Raster

from .records import Phase
from .stall_trials import random_stalls
from .stock import SIZES, Stock, table_write, writes_of
from .trial import Trial, phase

__all__ = ["write_trials"]

CYCLES = 700
"""Cycles in which a write is offered first."""

KINDS = ("material", "ambient", "column", "line", "control", "ignored")


def write_trials(
    stock: Stock, rng: np.random.Generator, numbers: range, total: int
) -> Iterator[Trial]:
    """Yield films of two frames with a table write, and a frame after it with the new tables."""
    cycles = min(CYCLES, -(-total // len(KINDS)))
    for number in numbers:
        place, kind = divmod(number, len(KINDS))
        cycle = place * CYCLES // cycles if place < cycles else int(rng.integers(CYCLES))
        yield _trial(stock, rng, cycle, KINDS[kind])


def _trial(stock: Stock, rng: np.random.Generator, cycle: int, kind: str) -> Trial:
    """Return the trial of one write."""
    config = stock.config
    size = SIZES[int(rng.integers(2))]
    items = [stock.take(rng, size) for _ in range(3)]
    words = [item.words for item in items]
    tables, changed, write, restored = _change(stock, rng, kind, size)
    before = [digest for item in items for digest in item.digests]
    after = [digest for part in words for digest in stock.digests(part, changed, tables)]
    last = len(items[2].digests)
    largest = (max(size[0], changed[0]), max(size[1], changed[1]))
    setup = [*stock.setup(size), (cycle, *write[1:])]
    # With the load bit set a frame starts from an initial raster: one of background alone.
    empty = stock.initial(Raster.background(*size, config))
    stream = {"initial": np.concatenate([empty] * 8), "optional": 1} if kind == "control" else {}
    film = phase(
        np.concatenate(words[:2]), largest, config, before[:-last], writes=writes_of(setup),
        hold=len(setup) - 1, stalls=random_stalls(rng, 0.2), seed=cycle, expected=0, **stream,
    )  # fmt: skip
    check = phase(words[2], largest, config, after[-last:], **stream)
    phases = [film, check]
    digests = [[before[:-last], after[:-last]], [after[-last:]]]
    if restored:
        phases.append(Phase(np.zeros(0, film.words.dtype), writes=writes_of(restored), frames=0))
        digests.append([[]])
    return Trial(f"{kind} written in cycle {cycle}", phases, digests)


def _change(
    stock: Stock, rng: np.random.Generator, kind: str, size: tuple[int, int]
) -> tuple[Tables, tuple[int, int], tuple[object, ...], list[tuple[object, ...]]]:
    """Return tables and size after a write, the write, and what undoes that of a material."""
    config, tables = stock.config, stock.tables
    base = config.register_base
    if kind == "material":
        index = int(rng.integers(base))
        diffuse = tables.diffuse.copy()
        diffuse[index] = rng.integers(0, 1 << config.coefficient_bits, 3)
        tables = dataclasses.replace(tables, diffuse=diffuse)
        return tables, size, stock.material(index, tables), [stock.material(index)]
    if kind == "ambient":
        channel = int(rng.integers(3))
        ambient = tables.ambient.copy()
        ambient[channel] = rng.integers(1 << config.ambient_bits)
        tables = dataclasses.replace(tables, ambient=ambient)
        write = table_write(base + channel, int(ambient[channel]), config)
        return tables, size, write, []
    if kind == "column":
        width = int(rng.integers(1, 65))
        write = table_write(base + Register.LAST_COLUMN, width - 1, config)
        return tables, (width, size[1]), write, []
    if kind == "line":
        height = int(rng.integers(1, 49))
        write = table_write(base + Register.LAST_LINE, height - 1, config)
        return tables, (size[0], height), write, []
    if kind == "control":
        return tables, size, table_write(base + Register.CONTROL, 1, config), []
    # Addresses above the registers are ignored.
    address = int(rng.integers(base + 6, 2 * base))
    data = int(rng.integers(1 << min(config.table_data.width, 62)))
    return tables, size, table_write(address, data, config), []
