"""Divides a frame among the engines of a chain; each gets a sorted stream of its own."""

from __future__ import annotations

import dataclasses
from typing import Any

import numba as nb
import numpy as np

from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.host.compiled_cache import cached_njit

from .partition_methods import DEFAULT_METHOD, METHODS
from .read_stream import read_stream
from .sort_by_line import advance_word, end_word
from .stand_ins import X_LSB, replace

__all__ = ["partition"]


def partition(frame: Frame, engines: int, method: str = DEFAULT_METHOD) -> list[Frame]:
    """Divide a frame's elements among engines.

    Every element goes to one engine, and each part has its own control words and end word. A chain
    draws the parts one over the other, the first part first. The picture is the one that a single
    engine draws, except for elements of equal depth on one pixel: the element of the earlier part
    stays, and ``columns`` also changes the order in a line.

    A strip of columns keeps an engine's elements together, so the engine sends few raster words.
    The two halves of a strip alternate, as an element that follows another into the same memory
    word costs a cycle.

    Parameters
    ----------
    frame
        Any code words with an end word; code words behind it are left out.
    engines
        Number of parts, at least 1.
    method
        One of ``METHODS``.

    Returns
    -------
    list of Frame
        The parts, with the frame's tables and size; ``counts`` has ``elements``.

    Raises
    ------
    InputError
        If there is no such method, the number of engines is below 1, or there is no end word.
    """
    if method not in METHODS:
        raise InputError(f"no partition method named {method!r}; there are: {', '.join(METHODS)}")
    if engines < 1:
        raise InputError(f"a partition has at least one engine, not {engines}")
    config = frame.config
    elements, lines = read_stream(frame.codewords, config)
    x_lsb = X_LSB if config.plane else config.x.lsb
    if method == "elements":
        owners = np.arange(len(elements), dtype=np.int64) % engines
    elif method == "lines":
        owners = _by_line(lines, engines)
    else:
        columns = (elements >> np.uint64(x_lsb) & np.uint64(config.x.mask)).astype(np.int64)
        order, owners = _by_column(columns, lines, engines, config.max_width)
        elements = elements[order]
    parts, sizes = _write(
        elements,
        lines,
        owners,
        engines,
        len(frame.codewords),
        advance_word(0, config),
        end_word(config),
        config.x.lsb,
        config.x.mask,
    )
    streams = [part[:size].copy() for part, size in zip(parts, sizes, strict=True)]
    if config.plane:
        streams = [replace(stream, frame.codewords) for stream in streams]
    counts = np.bincount(owners, minlength=engines)
    return [
        dataclasses.replace(frame, codewords=stream, counts={"elements": int(count)})
        for stream, count in zip(streams, counts, strict=True)
    ]


@cached_njit()
def _by_line(lines: Any, engines: int) -> Any:
    """Return the owners of whole lines: each goes to the engine with the fewest elements so far."""
    owners = np.empty(len(lines), np.int64)
    loads = np.zeros(engines, np.int64)
    begin = 0
    while begin < len(lines):
        end = begin
        while end < len(lines) and lines[end] == lines[begin]:
            end += 1
        least = int(np.argmin(loads))
        owners[begin:end] = least
        loads[least] += end - begin
        begin = end
    return owners


@cached_njit()
def _by_column(columns: Any, lines: Any, engines: int, width: int) -> tuple[Any, Any]:
    """Return the order of the elements by line and engine, and each one's owner.

    Running totals over all lines give the cuts of a line. So the engines' numbers of elements
    differ by one, or by a few if lines have fewer elements than there are engines.
    """
    count = len(columns)
    order = np.empty(count, np.int64)
    owners = np.empty(count, np.int64)
    following = np.empty(width + 1, np.int64)
    ranked = np.empty(count, np.int64)
    cuts = np.empty(engines + 1, np.int64)
    begin = 0
    while begin < count:
        end = begin
        while end < count and lines[end] == lines[begin]:
            end += 1
        following[:] = 0
        for i in range(begin, end):
            following[columns[i] + 1] += 1
        for column in range(width):
            following[column + 1] += following[column]
        for i in range(begin, end):
            ranked[following[columns[i]]] = i
            following[columns[i]] += 1
        cuts[0], cuts[engines] = 0, end - begin
        for engine in range(1, engines):
            cut = engine * end // engines - engine * begin // engines
            cuts[engine] = min(max(cut, cuts[engine - 1]), end - begin)
        for engine in range(engines):
            first, last = cuts[engine], cuts[engine + 1]
            for rank in range(first, last):
                position = _alternating(rank - first, last - first)
                order[begin + first + position] = ranked[rank]
                owners[begin + rank] = engine
        begin = end
    return order, owners


@nb.njit(inline="always")
def _alternating(rank: int, count: int) -> int:
    """Return where the word with a rank among ``count`` goes if the two halves alternate."""
    half = count + 1 >> 1
    return 2 * rank if rank < half else 2 * (rank - half) + 1


@cached_njit()
def _write(
    elements: Any,
    lines: Any,
    owners: Any,
    engines: int,
    room: int,
    advance: int,
    end: int,
    x_lsb: int,
    furthest: int,
) -> tuple[Any, Any]:
    """Return each engine's stream in a row of an array, and the streams' lengths.

    No part has more words than the frame, as it has at most one advance for each of the frame's.
    """
    parts = np.empty((engines, room), np.uint64)
    sizes = np.zeros(engines, np.int64)
    here = np.zeros(engines, np.int64)
    for i in range(len(elements)):
        owner = owners[i]
        while here[owner] < lines[i]:
            step = min(lines[i] - here[owner], furthest)
            parts[owner, sizes[owner]] = np.uint64(advance) | np.uint64(step) << np.uint64(x_lsb)
            sizes[owner] += 1
            here[owner] += step
        parts[owner, sizes[owner]] = elements[i]
        sizes[owner] += 1
    for owner in range(engines):
        parts[owner, sizes[owner]] = np.uint64(end)
        sizes[owner] += 1
    return parts, sizes
