"""A trial: phases to play, and what must come of each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig

from .records import BREACHES, DONE, HANG, RESET, SKIPPED, Phase, code_words

SKEW = 8
"""Most cycles between an access at the port, or a code word there, and what it does."""

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
        For each phase the digests that its frames must have; of a phase with a table write within
        its frames two lists, without the write and with it. None: any picture, but whole frames.
    answers
        For each phase the answers of its table writes, on AXI: a mask, and the bits that it has.
    overlap
        Frames of which the first code words may be in the registers of the port, where they still
        wait for a table write.
    """

    name: str
    phases: list[Phase]
    digests: Sequence[Sequence[list[int]] | None]
    answers: Sequence[Sequence[tuple[int, int]]] = ()
    overlap: int = 0


def silence_bound(config: EngineConfig, height: int, *, after_reset: bool = False) -> int:
    """Return the most cycles without progress in unstalled cycles.

    See ``docs/contract.md``, "Time".
    """
    return height + 64 + after_reset * config.clear_cycles


def cycle_bound(config: EngineConfig, part: Phase) -> int:
    """Return the most cycles of the frames of a phase in unstalled cycles.

    See ``docs/contract.md``, "Time".
    """
    width, height = (part.settings.get(name, 0) + 1 for name in ("last_column", "last_line"))
    a_word = 2 if config.draws_blocks else 3 * config.block_words + 1
    beats = 0 if part.initial is None else len(part.initial)
    flushed = height * (-(-width // config.raster_pixels) + 1)
    a_frame = flushed + height + 64
    clearing = config.clear_cycles if part.settings.get("reset_edges") else 0
    sent = a_word * len(part.words) + len(part.writes) + 3 * beats
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
        unlike = _unlike(
            part, trial.digests[number], result, frames[number], written[number], trial.overlap
        )
        wrong += [f"{where}: {text}" for text in unlike]
        if trial.answers and outcome == DONE:
            answers = zip(trial.answers[number], written[number]["answer"].tolist(), strict=False)
            wrong += [
                f"{where}: access {n} is answered by {got:#x}, not {want:#x}"
                for n, ((mask, want), got) in enumerate(answers)
                if (got ^ want) & mask
            ]
        if outcome == RESET and part.settings["reset_at"] < 0:
            wrong.append(f"{where} was reset")
    return wrong


def _unlike(
    part: Phase,
    expected: Sequence[list[int]] | None,
    result: Any,
    frames: Any,
    written: Any,
    overlap: int,
) -> list[str]:
    """Return which frames of a phase are not golden's."""
    closed = int(result["closed"])
    wanted = part.frames
    if int(result["outcome"]) == DONE and closed != wanted:
        return [f"{closed} of {wanted} frames ended"]
    if expected is None:
        return []
    digests = frames["digest"][:closed].tolist()
    allowed = [{digest} for digest in expected[0][:closed]]
    if len(expected) > 1:
        late = written[part.settings["hold"]]
        if overlap and not late["answer"] and _was_open(frames, late):
            return ["a write to a frame register was not refused within a frame"]
        if int(result["outcome"]) == DONE and not late["answer"]:
            if late["opened"] - late["closed"] > 2 * overlap:
                return ["a table write was taken while a frame was open"]
            before = frames[: int(late["opened"])]
            if not overlap and (before["offered"] > late["offered"]).any():
                return ["a frame was opened before a table write that was offered before it"]
            for n in range(max(int(late["opened"]) - overlap, 0), closed):
                allowed[n].add(expected[1][n])
            for n in range(int(late["opened"]), closed):
                allowed[n] = {expected[1][n]}
    return [f"frame {n} is not golden's" for n in range(closed) if digests[n] not in allowed[n]]


def _was_open(frames: Any, late: Any) -> bool:
    """Return whether a frame was open for certain when an access of the bus was made."""
    begun = np.maximum(frames["opened"], np.concatenate([[0], frames["closed"][:-1]]))
    return bool(
        ((begun + SKEW <= late["offered"]) & (frames["closed"] > late["offered"] + SKEW)).any()
    )
