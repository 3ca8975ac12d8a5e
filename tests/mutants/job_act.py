"""Jobs of the player as acts of the bench: the same frames, tables, rasters and stalls."""

import dataclasses

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.contract.raster_beats import to_beats
from splatline.sim.cosim.player.frames import Job
from splatline.sim.cycles.cycles import count_cycles

from .program import ANY_LEVEL, LAST_OF_FRAME, Act, Items

__all__ = ["FREE", "act_of", "film"]

FREE = ({}, {})
"""Rates and bursts of streams that never stall."""


def act_of(
    kind: str, job: Job, stalls=FREE, *, exact: bool = False, written=None, **options
) -> Act:
    """Return the act of a job.

    ``exact``: it has to take the cycles of the cycle model. ``written``: numbers of the frames with
    table writes, if the job has them for every frame.
    """
    config = job.frame.config
    frames, starts = job.frames, job.starts
    words = [frame.codewords.reshape(len(frame.codewords), -1) for frame in frames]
    ends = np.cumsum([len(each) for each in words])
    begins = ends - [len(each) for each in words]
    items, rates = {}, stalls[0]
    writes = job.table_writes()
    numbers = range(len(writes)) if written is None else written
    # A frame's writes may come in any order.
    order = np.random.default_rng(job.seed)
    writes = [writes[number][order.permutation(len(writes[number]))] for number in numbers]
    waits = np.zeros(ends[-1], np.int64)
    if writes:
        lengths = [len(each) for each in writes]
        before = [begins[number - 1] + 1 if number else 0 for number in numbers]
        after = np.repeat(before, lengths)
        items["tables"] = Items(np.concatenate(writes), after={"codewords": after})
        for number, end, length in zip(numbers, np.cumsum(lengths), lengths, strict=True):
            # A frame's words wait for its writes; for their first, if they come without a gap.
            all_at_once = number and rates.get("tables", 256) == 256
            waits[begins[number] :] = end - length + 1 if all_at_once else end
    flags = np.zeros(ends[-1], np.int64)
    flags[ends - 1] = LAST_OF_FRAME
    items["codewords"] = Items(np.concatenate(words), shown={"tables": waits}, flags=flags)
    beats = [to_beats(picture) for picture in job.pictures()]
    items["raster"] = _expected(beats, begins, ends, config)
    given = [(number, to_beats(start)) for number, start in enumerate(starts) if start is not None]
    if given:
        out = np.cumsum([0, *(len(each) for each in beats)])
        after = np.concatenate([np.full(len(each), out[number]) for number, each in given])
        gates = {"raster": after} if job.initial_waits else {}
        items["initial"] = Items(np.concatenate([each for _, each in given]), after=gates)
    if exact:
        cycles = count_cycles(frames[0], after_reset=False)
        options = {"least_cycles": cycles, "most_cycles": cycles, **options}
    options = {"seed": job.seed, **options}
    return Act(kind, items, *stalls, **options)


def film(kind: str, frames: list[Frame], **options) -> Act:
    """Return the act of frames with the tables of the first one."""
    frames = [dataclasses.replace(frame, tables=frames[0].tables) for frame in frames]
    job = Job(frame=frames[0], followed_by=frames[1:], write_tables="first")
    return act_of(kind, job, **options)


def _expected(beats, begins, ends, config: EngineConfig) -> Items:
    """Return the beats that must come: none before its frame, no end before the frame's end."""
    payload = np.concatenate(beats)
    mask = np.full_like(payload, ~np.uint64(0))
    end = config.raster_end.lsb
    after, at = [], 0
    for number, each in enumerate(beats):
        after += [begins[number] + 1] * (len(each) - 1) + [ends[number]]
        at += len(each)
        mask[at - 1] = 0
        mask[at - 1, end // 64] = np.uint64(1) << np.uint64(end % 64)
    flags = np.full(len(payload), ANY_LEVEL)
    # Bits above the beat do not come.
    if config.raster_end.end % 64:
        mask[:, -1] &= np.uint64((1 << config.raster_end.end % 64) - 1)
    return Items(payload, mask, {"codewords": np.array(after)}, flags=flags)
