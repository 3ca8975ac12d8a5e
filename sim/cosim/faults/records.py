"""The records that Python and the player in C++ share, and batches of phases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.frame import are_control

__all__ = [
    "AFTER_FAILURE", "AFTER_WRONG", "ALWAYS", "BREACHES", "BURSTS", "CLOSED", "DONE", "FRAME",
    "HANG", "INITIAL", "PHASE", "PORTS", "RANDOM", "RASTER", "RESET", "RESULT", "SHY", "SKIPPED",
    "UNLESS_HUNG", "WILLING", "WORD", "WORDS", "WRITE", "WRITES", "WRITTEN", "Batch", "Phase",
    "are_ends", "code_words",
]  # fmt: skip

WORDS, WRITES, INITIAL, RASTER = PORTS = range(4)
"""The ports, as in ``stalls.h``."""

WILLING, CLOSED, RANDOM, BURSTS, SHY = range(5)
"""The patterns of stalls, as in ``stalls.h``."""

ALWAYS, AFTER_FAILURE, UNLESS_HUNG, AFTER_WRONG = range(4)
"""When a phase is played, as in ``player.cpp``."""

SKIPPED, DONE, HANG, RESET = range(4)
"""Outcomes of a phase, as in ``player.cpp``."""

BREACHES = {
    1: "a pixel outside the image",
    2: "a beat out of order",
    4: "a beat or a pixel that should not be there",
    8: "an offered beat changed",
    16: "a beat outside a frame",
    32: "more frames than were sent",
}
"""Bits of ``Breach`` in ``beats.h``."""


def _record(*fields: tuple[str, int]) -> np.dtype[Any]:
    """Return a structured type of int64 fields, or short arrays of them."""
    return np.dtype(
        [(name, np.int64, (size,)) if size > 1 else (name, np.int64) for name, size in fields]
    )


PHASE = _record(
    ("condition", 1), ("reset_edges", 1), ("words", 2), ("writes", 2), ("initial", 2),
    ("frames", 2), ("hold", 1), ("stalls", 12), ("reset_at", 1), ("upset_at", 1), ("upset", 3),
    ("limit", 1), ("silence", 1), ("last_column", 1), ("last_line", 1), ("expected", 1),
    ("seed", 1), ("flush", 1), ("optional", 1),
)  # fmt: skip
RESULT = _record(
    *((name, 1) for name in ("outcome", "cycles", "silence", "breaches", "opened", "closed")),
    *((name, 1) for name in ("words", "written")),
)
FRAME = _record(*((name, 1) for name in ("digest", "beats", "offered", "opened", "closed")))
WRITTEN = _record(*((name, 1) for name in ("offered", "cycle", "opened", "closed", "answer")))
WORD = np.dtype([("data", np.uint64, (2,)), ("keep", np.uint64), ("last", np.uint64)])
WRITE = np.dtype([("at", np.uint64), ("data", np.uint64, (2,)), ("kind", np.uint64)])


def code_words(words: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[Any]:
    """Return code words as records ``WORD``, whole, with TLAST in every end word."""
    records = np.zeros(len(words), WORD)
    if config.plane:
        records["data"] = words
    else:
        records["data"][:, 0] = words
    records["keep"] = (1 << codeword_stream_bytes(config)) - 1
    records["last"] = are_ends(words, config)
    return records


def are_ends(words: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[np.bool_]:
    """Return where the end words are among code words of an engine."""
    low = words[:, 0] if config.plane else words
    ends = low >> np.uint64(config.control_end.lsb) & np.uint64(1) == 1
    return are_control(low, config) & ends


class Phase:
    """A phase to play; its attributes are the fields of ``PHASE`` and what is sent.

    Parameters
    ----------
    words, writes, initial
        Records ``WORD`` and ``WRITE``, and beats with a last limb for AXI: shape (n, limbs + 1).
    frames
        The frames that may come of it.
    settings
        Fields of ``PHASE``.
    """

    def __init__(
        self,
        words: npt.NDArray[Any],
        *,
        writes: npt.NDArray[Any] | None = None,
        initial: npt.NDArray[np.uint64] | None = None,
        frames: int = 1,
        **settings: Any,
    ) -> None:
        self.words = words
        self.writes = np.zeros(0, WRITE) if writes is None else writes
        self.initial = initial
        self.frames = frames
        self.settings = {
            "hold": len(self.writes), "reset_at": -1, "upset_at": -1, "limit": 100_000,
            "silence": 2_000, **settings,
        }  # fmt: skip


class Batch:
    """Phases in succession, as arrays for the player.

    Parameters
    ----------
    phases
        What is played.
    limbs
        Limbs of 64 bits of a beat.
    """

    def __init__(self, phases: Sequence[Phase], limbs: int) -> None:
        self.phases = np.zeros(len(phases), PHASE)
        none = np.zeros((0, limbs + 1), np.uint64)
        beats = [none if phase.initial is None else phase.initial for phase in phases]
        for name, lengths in (
            ("words", [len(phase.words) for phase in phases]),
            ("writes", [len(phase.writes) for phase in phases]),
            ("initial", [len(part) for part in beats]),
            ("frames", [phase.frames for phase in phases]),
        ):
            ends = np.cumsum(lengths)
            self.phases[name] = np.stack([ends - lengths, ends], axis=1)
        for record, phase in zip(self.phases, phases, strict=True):
            for name, value in phase.settings.items():
                record[name] = value
        self.words = np.concatenate([phase.words for phase in phases])
        self.writes = np.concatenate([phase.writes for phase in phases])
        self.beats = np.ascontiguousarray(np.concatenate(beats))
        self.frames = int(self.phases["frames"][-1, 1])
