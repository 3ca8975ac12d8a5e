"""A trial: phases to play, and what must come of each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig

from .records import BREACHES, DONE, HANG, RESET, SKIPPED, Phase, code_words

__all__ = ["Trial", "cycle_bound", "faults_of", "phase", "silence_bound"]


class Trial(NamedTuple):
    """Phases to play in succession.

    Parameters
    ----------
    name
        What is done to the engine, in a few words.
    phases
        What is played.
    digests
        For each phase the digests that its frames must have; of a phase with table writes within
        its frames, one list for each number of writes that came before a frame.
    """

    name: str
    phases: list[Phase]
    digests: list[list[list[int]]]


def silence_bound(config: EngineConfig, height: int, *, after_reset: bool = False) -> int:
    """Return the most cycles without progress while every port is willing.

    See ``docs/contract.md``, "Time".
    """
    return height + 64 + after_reset * config.clear_cycles


def cycle_bound(config: EngineConfig, part: Phase) -> int:
    """Return the most cycles of the frames of a phase while every port is willing.

    See ``docs/contract.md``, "Time".
    """
    width, height = (part.settings.get(name, 0) + 1 for name in ("last_column", "last_line"))
    a_word = 1 if config.draws_blocks else 3 * config.block_words + 1
    beats = 0 if part.initial is None else len(part.initial)
    flushed = height * (-(-width // config.raster_pixels) + 1)
    a_frame = flushed + height + 64
    clearing = config.clear_cycles if part.settings.get("reset_edges") else 0
    sent = a_word * len(part.words) + len(part.writes) + 2 * beats
    return clearing + sent + max(1, part.frames) * a_frame


def phase(
    words: npt.NDArray[np.uint64],
    size: tuple[int, int],
    config: EngineConfig,
    digests: Sequence[int],
    **settings: Any,
) -> Phase:
    """Return a phase of code words, whose last frame is known."""
    after_reset = bool(settings.get("reset_edges"))
    return Phase(
        code_words(words, config),
        frames=len(digests),
        last_column=size[0] - 1,
        last_line=size[1] - 1,
        **{
            "expected": digests[-1] if digests else 0,
            "silence": silence_bound(config, size[1], after_reset=after_reset),
            # An empty frame may be out before the window is cleared.
            "flush": config.clear_cycles if after_reset else 2,
            **settings,
        },
    )


def faults_of(
    trial: Trial, results: Any, frames: Any, written: Any, bounds: Sequence[float]
) -> list[str]:
    """Return what is wrong with what came of a trial, which must be right in every phase.

    Parameters
    ----------
    trial
        The trial.
    results
        Records ``RESULT`` of its phases.
    frames, written
        Records ``FRAME`` and ``WRITTEN`` of each phase.
    bounds
        The most cycles of each phase.
    """
    wrong = []
    for number, (part, result) in enumerate(zip(trial.phases, results, strict=True)):
        where = f"phase {number}"
        outcome = int(result["outcome"])
        if outcome == SKIPPED:
            continue
        if outcome == HANG:
            wrong.append(f"{where} hangs in cycle {result['cycles']}")
        if result["cycles"] > bounds[number]:
            wrong.append(f"{where} takes {result['cycles']} cycles")
        breaches = int(result["breaches"])
        wrong += [f"{where}: {text}" for bit, text in BREACHES.items() if breaches & bit]
        wrong += [
            f"{where}: {text}"
            for text in _unlike(
                part, trial.digests[number], result, frames[number], written[number]
            )
        ]
        if outcome == RESET and part.settings["reset_at"] < 0:
            wrong.append(f"{where} was reset")
    return wrong


def _unlike(
    part: Phase, expected: list[list[int]], result: Any, frames: Any, written: Any
) -> list[str]:
    """Return which frames of a phase are not golden's."""
    closed = int(result["closed"])
    outcome = int(result["outcome"])
    wanted = len(expected[0])
    if outcome == DONE and closed != wanted:
        return [f"{closed} of {wanted} frames ended"]
    if len(expected) > 1:  # a write came before some of the frames
        late = written[part.settings["hold"] :]
        if (late["opened"] != late["closed"]).any() and outcome == DONE:
            return ["a table write was taken while a frame was open"]
        before = [int((late["opened"] <= n).sum()) for n in range(closed)]
        right = [expected[count][n] for n, count in enumerate(before)]
    else:
        right = expected[0][:closed]
    digests = frames["digest"][:closed]
    return [
        f"frame {n} is not golden's" for n in np.flatnonzero(digests != np.array(right, np.int64))
    ]
