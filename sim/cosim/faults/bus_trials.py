"""Trials of accesses of the register bus on AXI within frames, and of aborts."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np

from splatline.contract.register_types import BusRegister

from .axi_stock import READ, WHOLE, AxiStock, access
from .packet_trials import check_errors
from .records import INITIAL, RASTER, WORDS, WRITE, Phase
from .stall_trials import film, random_stalls
from .stock import SIZES, writes_of
from .trial import Trial, cycle_bound, phase

__all__ = ["abort_trials", "access_trials"]

CYCLES = 700
"""Cycles in which an access comes."""

OPENED = 100
"""Cycle by which the frame of a phase is open: its registers are written by then."""

OKAY, SLVERR, DECERR = 0, 2 << 32, 3 << 32
RESPONSE = 3 << 32


def abort_trials(
    stock: AxiStock, rng: np.random.Generator, numbers: range, total: int
) -> Iterator[Trial]:
    """Yield frames that are aborted, in every cycle first; each ends, and the next is right."""
    config = stock.config
    cycles = min(CYCLES, total)
    errors = stock.map["ERROR"]
    allowed = sum(errors[name].mask for name in ("ABORTED", "X_OUTSIDE", "LINE_PAST"))
    abort = stock.map["CONTROL"]["ABORT"].mask
    for number in numbers:
        cycle = number * CYCLES // cycles if number < cycles else int(rng.integers(CYCLES))
        load = bool(rng.random() < 0.4)
        stalls = random_stalls(rng, 0.3)
        if load:
            # An initial raster that comes after the abort is not dropped: it is the next frame's.
            stalls[3 * INITIAL : 3 * INITIAL + 3] = 0
        part, digests = film(stock, rng, 1, load=load, stalls=stalls, seed=cycle, expected=0)
        while len(digests) > 1:  # an abort ends one of them
            part, digests = film(stock, rng, 1, load=load, stalls=stalls, seed=cycle, expected=0)
        clear = stock.write("ERROR", 0xFFFF_FFFF)
        part.writes = np.concatenate(
            [writes_of([clear]), part.writes, writes_of([stock.write("CONTROL", abort, at=cycle)])]
        )
        part.settings["hold"] += 1
        # Of an aborted frame the beats are dropped, which take a cycle each.
        part.settings["silence"] = cycle_bound(config, part)
        size = stock.size(rng)
        check = stock.take(rng, size)
        writes, count = check_errors(stock, size)
        after = phase(check.words, size, config, check.digests, writes=writes)
        answers = [[], [(~allowed, 0), *[(-1, 0)] * (count - 1)]]
        if number % 3 == 0:
            _stop(part, rng, cycle)
            resync = stock.write("CONTROL", stock.map["CONTROL"]["RESYNC"].mask)
            after.writes = np.concatenate([writes_of([resync]), writes])
            after.settings["hold"] += 1
            late = errors["END_WITHOUT_LAST"].mask  # of a packet that stops with its end word
            answers = [[], [(-1, 0), (~(allowed | late), 0), *answers[1][1:]]]
        yield Trial(f"abort in cycle {cycle}", [part, after], [None, [check.digests]], answers)


def _stop(part: Phase, rng: np.random.Generator, cycle: int) -> None:
    """Let the packets of a phase stop before their ends, as of a host that is gone."""
    part.words = part.words[: max(1, int(rng.integers(len(part.words))))]
    part.words["last"] = 0
    if part.initial is not None:
        part.initial = part.initial[: int(rng.integers(len(part.initial)))]
    stalls = part.settings["stalls"]
    stalls[3 * WORDS : 3 * WORDS + 3] = 0
    part.writes["at"][-1] = max(cycle, OPENED)
    part.settings["silence"] += OPENED + CYCLES
    part.settings["optional"] = 1


def access_trials(
    stock: AxiStock, rng: np.random.Generator, numbers: range, total: int
) -> Iterator[Trial]:
    """Yield films of two frames with an access of the bus, in every cycle first.

    It is a read of any address, a write that must be refused, or a write of a frame register, which
    is refused while a frame is open.
    """
    cycles = min(CYCLES, total)
    for number in numbers:
        cycle = number * CYCLES // cycles if number < cycles else int(rng.integers(CYCLES))
        yield (_frame_register if number % 3 == 2 else _refused)(stock, rng, cycle)


def _refused(stock: AxiStock, rng: np.random.Generator, cycle: int) -> Trial:
    """Return the trial of a read, or of a write that changes nothing."""
    offset = int(rng.integers(1 << stock.map.address_bits))
    if rng.random() < 0.6:
        offset &= 0x7F
    found = _register_at(stock, offset)
    if rng.random() < 0.5:
        kind, value = READ, 0
        readable = isinstance(found, BusRegister) and found.readable
        wanted = DECERR if found is None else OKAY if readable else SLVERR
    else:
        kind = int(rng.integers(WHOLE))  # a byte is missing
        value = int(rng.integers(1 << 32))
        wanted = DECERR if found is None else SLVERR
    part, digests = film(stock, rng, 2, stalls=random_stalls(rng, 0.2), seed=cycle)
    part.writes = np.concatenate(
        [part.writes, np.array([access(offset, value, kind, cycle)], WRITE)]
    )
    answers = [[*[(-1, 0)] * part.settings["hold"], (RESPONSE, wanted)]]
    name = f"{'read' if kind == READ else 'write'} at {offset:#x} in cycle {cycle}"
    return Trial(name, [part], [[digests]], answers)


def _register_at(stock: AxiStock, offset: int) -> BusRegister | str | None:
    """Return the register at an address, ``materials`` of their window, or None."""
    offset &= ~3
    window = stock.map.materials
    entry, place = divmod(offset - window.offset, window.stride)
    if 0 <= entry < window.entries and place < 4 * window.words:
        return "materials"
    return next((one for one in stock.map.registers if one.offset == offset), None)


def _frame_register(stock: AxiStock, rng: np.random.Generator, cycle: int) -> Trial:
    """Return the trial of a write to a frame register, refused or for the frames after it."""
    config = stock.config
    size = SIZES[int(rng.integers(2))]
    items = [stock.take(rng, size) for _ in range(2)]
    tables, changed = stock.tables, size
    name = str(rng.choice(["LAST_COLUMN", "LAST_LINE", "AMBIENT_GREEN"]))
    if name == "AMBIENT_GREEN":
        ambient = tables.ambient.copy()
        ambient[1] = value = int(rng.integers(1 << config.ambient_bits))
        tables = dataclasses.replace(tables, ambient=ambient)
    else:
        value = int(rng.integers(1, 40))
        changed = (value + 1, size[1]) if name == "LAST_COLUMN" else (size[0], value + 1)
    largest = (max(size[0], changed[0]), max(size[1], changed[1]))
    before = [digest for item in items for digest in item.digests]
    after = [digest for item in items for digest in stock.digests(item.words, changed, tables)]
    setup: list[tuple[Any, ...]] = [*stock.setup(size), stock.write(name, value, at=cycle)]
    stalls = random_stalls(rng, 0.2)
    # A frame is over once its end beat has left the engine, and would wait in the port's registers.
    stalls[3 * RASTER : 3 * RASTER + 3] = 0
    part = phase(
        np.concatenate([item.words for item in items]), largest, config, before,
        writes=writes_of(setup), hold=len(setup) - 1, stalls=stalls, seed=cycle,
        expected=0,
    )  # fmt: skip
    return Trial(f"{name} written in cycle {cycle}", [part], [[before, after]], [[]], overlap=1)
