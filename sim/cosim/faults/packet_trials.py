"""Trials of packets on AXI that are no frames: what a guard makes of them, and its errors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.frame import are_control

from .axi_stock import AxiStock
from .frames import any_bits, ended
from .records import are_ends
from .stall_trials import random_stalls
from .stock import writes_of
from .stream_trials import MUTATIONS, mutate
from .trial import Trial, phase

__all__ = ["check_errors", "guarded", "packet_trials"]

_Words = npt.NDArray[np.uint64]


def guarded(
    records: npt.NDArray[Any], size: tuple[int, int], config: EngineConfig
) -> tuple[list[_Words], set[str]]:
    """Return the frames that packets become (``docs/registers.md``, "Streams"), and their errors.

    Parameters
    ----------
    records
        Records ``WORD``; the last one has TLAST.
    size
        Columns and lines of the image.
    config
        The engine's configuration.
    """
    frames, errors = [], set()
    for packet in np.split(records, np.flatnonzero(records["last"]) + 1)[:-1]:
        words = packet["data"] if config.plane else packet["data"][:, 0]
        whole = packet["keep"] == (1 << codeword_stream_bytes(config)) - 1
        ends = np.flatnonzero(are_ends(words, config) & whole)
        stop = int(ends[0]) + 1 if len(ends) else len(packet)
        if not len(ends):
            errors.add("FRAME_ENDED_EARLY")
        elif stop < len(packet):
            errors.add("END_WITHOUT_LAST")
        if not whole[:stop].all():
            errors.add("PARTIAL_WORD")
        taken = words[:stop][whole[:stop]]
        frames.append(ended(taken, config))
        errors |= _positions(taken, size, config)
    return frames, errors


def _positions(words: _Words, size: tuple[int, int], config: EngineConfig) -> set[str]:
    """Return the errors of positions out of range (``docs/contract.md``, "On AXI")."""
    low = words[:, 0] if config.plane else words
    control = are_control(low, config)
    x = (low >> np.uint64(config.x.lsb) & np.uint64(config.x.mask)).astype(np.int64)
    steps = control & ~are_ends(words, config)
    line = np.cumsum(np.where(steps, x, 0))
    errors = set()
    if (~control & (x > size[0] - 1)).any():
        errors.add("X_OUTSIDE")
    if (steps & (line - 4 > size[1] - 1)).any():
        errors.add("LINE_PAST")
    return errors


def check_errors(stock: AxiStock, size: tuple[int, int]) -> tuple[npt.NDArray[Any], int]:
    """Return writes that read and clear ERROR and set the frame registers, and how many."""
    writes = [stock.read("ERROR"), stock.write("ERROR", 0xFFFF_FFFF), *stock.setup(size)]
    return writes_of(writes), len(writes)


def packet_trials(
    stock: AxiStock, rng: np.random.Generator, numbers: range, total: int
) -> Iterator[Trial]:
    """Yield packets whose words, TLAST and TKEEP have faults, and a whole frame behind them.

    Bits are flipped, words are lost, doubled or swapped; TLAST and TKEEP are flipped here and
    there. Each picture must be that of the frame which the guard makes, and ERROR must have the
    bits that the contract says, and no others.
    """
    config = stock.config
    for number in numbers:
        kind = MUTATIONS[number % len(MUTATIONS)]
        size = stock.size(rng)
        one, other = (
            np.concatenate([stock.take(rng, size).words for _ in range(2)]) for _ in range(2)
        )
        words = mutate(one, other, kind, rng, any_bits(rng, len(one), config))
        if config.plane:
            words[:, 1] &= np.uint64(0xFFFF_FFFF)
        words = ended(words, config)
        cleared, _ = check_errors(stock, size)
        part = phase(
            words, size, config, [0], writes=cleared, stalls=random_stalls(rng, 0.3),
            seed=int(rng.integers(1 << 40)),
        )  # fmt: skip
        records = part.words
        flips = rng.random((2, len(records))) < 2.0 / len(records) * (rng.random((2, 1)) < 0.6)
        records["last"] ^= flips[0]
        records["last"][-1] = 1
        bytes_ = rng.integers(0, 8, len(records)).astype(np.uint64)
        whole = records["keep"].copy()
        records["keep"][flips[1]] ^= (np.uint64(1) << bytes_)[flips[1]]
        if (records["keep"] != whole).all():
            records["keep"] = whole
        frames, errors = guarded(records, size, config)
        digests = [digest for frame in frames for digest in stock.digests(frame, size)[:1]]
        part.frames = len(digests)
        part.settings["expected"] = digests[-1]
        check = stock.take(rng, size, "dense", "top", "bottom")
        writes, count = check_errors(stock, size)
        after = phase(check.words, size, config, check.digests, writes=writes)
        mask = sum(stock.map["ERROR"][name].mask for name in errors)
        answers = [[], [(-1, mask), *[(-1, 0)] * (count - 1)]]
        yield Trial(f"packets {kind}", [part, after], [[digests], [check.digests]], answers)
