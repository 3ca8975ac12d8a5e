"""Acts of the bench, and the file that it reads."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from .tops import Design

__all__ = ["ANY_LEVEL", "LAST_OF_FRAME", "RASTER_STALLS", "SHY", "Act", "Items", "write_program"]

LAST_OF_FRAME = 1
"""Flag of a code word that ends its frame."""

ANY_LEVEL = 2 << 1
"""Flag of an output's item with which the level of ``irq`` does not count."""

RASTER_STALLS = 1 << 3
"""Flag of an output's item: its lowest word is the number of cycles in which a beat waited."""

SHY = 512
"""Rate of an output that is ready only once something was offered."""

SHOWN = np.uint32(1 << 31)
"""In a count of items before an input's: those that are offered count as well."""

HELD = SHOWN
"""In a count of items before an output's: it is not ready until then."""

MANY = (1 << 32) - 1
"""Most cycles of an act that may take any."""


@dataclass
class Items:
    """What goes over a stream in an act.

    Parameters
    ----------
    payload
        Shape (n, limbs), uint64, lowest limb first.
    mask
        Bits of an output that count, same shape; all if not given.
    after
        By name of a stream, how many of its items are taken before each: shape (n,).
    shown
        By name of an input, how many of its items are at least offered before each: shape (n,).
    held
        By name of a stream, how many of its items are taken before an output is ready for each:
        shape (n,).
    flags
        Shape (n,): see ``LAST_OF_FRAME`` and ``ANY_LEVEL``.
    """

    payload: npt.NDArray[np.uint64]
    mask: npt.NDArray[np.uint64] | None = None
    after: dict[str, npt.NDArray[np.int64]] = field(default_factory=dict)
    shown: dict[str, npt.NDArray[np.int64]] = field(default_factory=dict)
    held: dict[str, npt.NDArray[np.int64]] = field(default_factory=dict)
    flags: npt.NDArray[np.int64] | None = None


@dataclass
class Act:
    """Some frames with their stalls.

    Parameters
    ----------
    kind
        What it shows, for the table.
    items
        By name of a stream; a stream that is not named has none.
    rates, bursts
        By name of a stream, the share 0..256 of the cycles in which it goes, or ``SHY``; and the
        longest time for which it does or does not go.
    reset_edges
        Clock edges of a reset before the act; 0: none.
    cut
        Cycle in which the act is cut off, which needs a reset in the next one; 0: none.
    least_cycles, most_cycles
        Cycles from the first code word taken to the last beat, both included.
    quiet
        Cycles after the last item in which nothing further may come.
    """

    kind: str
    items: dict[str, Items]
    rates: dict[str, int] = field(default_factory=dict)
    bursts: dict[str, int] = field(default_factory=dict)
    seed: int = 1
    reset_edges: int = 0
    cut: int = 0
    limit: int = 60_000
    least_cycles: int = 0
    most_cycles: int = MANY
    quiet: int = 16


def write_program(path: Path, design: Design, acts: Sequence[Act]) -> None:
    """Write the file of some acts for a design's bench."""
    names = [channel.name for channel in design.channels]
    heads = [
        len(design.inputs),
        len(design.outputs),
        design.payload_words,
        names.index("codewords"),
        names.index("raster") - len(design.inputs),
        len(acts),
    ]
    parts = [np.array(heads, np.uint32)]
    for act in acts:
        cycles = [act.least_cycles, act.most_cycles]
        head = [act.reset_edges, act.cut, act.limit, *cycles, act.seed, act.quiet]
        parts.append(np.array(head, np.uint32))
        for number, channel in enumerate(design.channels):
            items = act.items.get(channel.name, Items(np.zeros((0, 1), np.uint64)))
            rows = _rows(items, names, design.payload_words, channel.width, number, design)
            head = [act.rates.get(channel.name, 256), act.bursts.get(channel.name, 1), len(rows)]
            parts += [np.array(head, np.uint32), rows.reshape(-1)]
    path.write_bytes(np.concatenate(parts).astype("<u4").tobytes())


def _rows(
    items: Items, names: list[str], words: int, width: int, number: int, design: Design
) -> npt.NDArray[np.uint32]:
    """Return the rows of a stream's items: flags, gates, payload, mask."""
    count = len(items.payload)
    flags = np.zeros(count, np.uint32) if items.flags is None else items.flags
    gates = np.zeros((count, len(names)), np.uint32)
    for name, after in items.after.items():
        gates[:, names.index(name)] = after
    for flag, counts in ((SHOWN, items.shown), (HELD, items.held)):
        for name, count_before in counts.items():
            gates[:, names.index(name)] = flag | np.asarray(count_before, np.uint32)
    parts = [np.asarray(flags, np.uint32)[:, None], gates, _words(items.payload, words)]
    if number >= len(design.inputs):
        every = np.zeros((1, -(-width // 64)), np.uint64)
        for limb in range(every.shape[1]):
            every[0, limb] = (1 << min(64, width - 64 * limb)) - 1
        mask = every if items.mask is None else items.mask
        parts.append(_words(np.broadcast_to(mask, (count, mask.shape[1])), words))
    return np.concatenate(parts, axis=1)


def _words(limbs: npt.NDArray[np.uint64], words: int) -> npt.NDArray[np.uint32]:
    """Return limbs as words of 32 bits, filled up with zeros."""
    split = np.ascontiguousarray(limbs).astype("<u8").view(np.uint32)
    result = np.zeros((len(limbs), max(words, split.shape[1])), np.uint32)
    result[:, : split.shape[1]] = split
    return result[:, :words]
