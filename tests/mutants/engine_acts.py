"""The fast bench of an engine: frames of every kind, with the golden renderer's pictures."""

import dataclasses
from collections.abc import Iterator

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.raster_beats import to_beats
from splatline.sim.cosim.player.frames import Job
from splatline.sim.cycles.cycles import count_cycles
from tests.support.random_frames import films, frame_of, nonsense, random_raster, shapes

from .frames import (
    any_control, borders, corners, equal_depths, every_row, extremes, few_far_apart, wide_line,
)  # fmt: skip
from .odd_inputs import odd_beats, odd_writes
from .program import ANY_LEVEL, LAST_OF_FRAME, SHY, Act, Items

__all__ = ["act_of", "engine_acts"]

FREE = ({}, {})
STALLED = ({"codewords": 90, "tables": 128, "initial": 100, "raster": 160}, {})
SLOW_RASTER = ({"raster": 60}, {"raster": 40})
BURSTS = ({"codewords": 128, "initial": 40}, {"codewords": 24, "initial": 9})
STARVED = ({"initial": 200, "raster": 100, "codewords": 220}, {"raster": 90})
WAITS = ({"raster": SHY, "codewords": 180}, {"codewords": 3})
STALLS = (FREE, STALLED, SLOW_RASTER, BURSTS, STARVED, WAITS)
"""Rates and bursts of the streams: none stalls, all do, one starves another, one waits for it."""

SIZE = (37, 41)
"""Width and height of most images: no multiple of a word or of the window."""


def act_of(kind: str, job: Job, stalls=FREE, *, exact: bool = False, **options) -> Act:
    """Return the act of a job; ``exact``: it has to take the cycles of the cycle model."""
    config = job.frame.config
    frames, starts = job.frames, job.starts
    words = [frame.codewords.reshape(len(frame.codewords), -1) for frame in frames]
    ends = np.cumsum([len(each) for each in words])
    begins = ends - [len(each) for each in words]
    items, rates = {}, stalls[0]
    writes = job.table_writes()
    waits = np.zeros(ends[-1], np.int64)
    if writes:
        written = np.cumsum([len(each) for each in writes])
        before = [0, *(begins[: len(writes) - 1] + 1)]
        after = np.repeat(before, [len(each) for each in writes])
        items["tables"] = Items(np.concatenate(writes), after={"codewords": after})
        for number, begin in enumerate(begins):
            # A frame's words wait for its writes; for their first, if they come without a gap.
            shown = written[min(number, len(written) - 1)]
            if number and number < len(written) and rates.get("tables", 256) == 256:
                shown = written[number - 1] + 1
            waits[begin:] = shown
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
    cycles = count_cycles(frames[0], after_reset=False) if exact else 0
    options = {"seed": job.seed, "exact_cycles": cycles, **options}
    return Act(kind, items, *stalls, **options)


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


def engine_acts(config: EngineConfig, seed: int = 1) -> list[Act]:
    """Return the acts of an engine's fast bench; the first begins with a reset."""
    rng = np.random.default_rng(seed)
    acts = [
        act_of("after reset", Job(frame=shapes(rng, 60, *SIZE, config=config)), reset_edges=1),
        *_single(rng, config),
        *_films(rng, config),
        *_initial(rng, config),
        *_resets(rng, config),
    ]
    return acts


def _single(rng, config: EngineConfig) -> Iterator[Act]:
    """Yield single frames, without stalls, at the exact number of cycles, and with stalls."""
    width, height = SIZE
    kinds = {
        "sparse": shapes(rng, 25, *SIZE, config=config),
        "dense": shapes(rng, 250, *SIZE, config=config),
        "empty": frame_of([], *SIZE, seed=3, config=config),
        "corners": corners(rng, config, *SIZE),
        "borders": borders(rng, config, *SIZE),
        "equal depths": equal_depths(rng, config, *SIZE),
        "extremes": extremes(rng, config, *SIZE),
        "any bits": nonsense(rng, 150, *SIZE, config=config),
        "far apart": few_far_apart(rng, config),
        "wide": wide_line(rng, config),
        "every row": every_row(rng, config),
        "every row again": every_row(rng, config),
        "one pixel": shapes(rng, 4, 1, 1, config=config),
    }
    for number, (kind, frame) in enumerate(kinds.items()):
        yield act_of(kind, Job(frame=frame), exact=True)
        again = Job(frame=frame, write_tables="none", seed=number + 1)
        if kind not in ("far apart", "wide", "empty", "every row again"):
            yield act_of(f"{kind}, stalled", again, STALLS[1 + number % 5])
    yield odd_writes(act_of("odd writes", Job(frame=kinds["extremes"])), rng, config)


def _films(rng, config: EngineConfig) -> Iterator[Act]:
    """Yield frames back to back: with tables, of other sizes, and with the tables of the first."""
    for number, stalls in enumerate(STALLS[:4]):
        frames = [shapes(rng, 50, *size, config=config) for size in (SIZE, (52, 23), (20, 60))]
        yield act_of("tables between", Job(frame=frames[0], followed_by=frames[1:], seed=number), stalls)
    for number, stalls in enumerate(STALLS):
        frames = [
            dataclasses.replace(frame, width=SIZE[0], height=SIZE[1], tables=None)
            for frame in (
                shapes(rng, 40, *SIZE, config=config),
                shapes(rng, 30, 37, 12, config=config),
                frame_of([], *SIZE, config=config),
                frame_of([], *SIZE, config=config),
                shapes(rng, 4, *SIZE, config=config),
                shapes(rng, 150, *SIZE, config=config),
                corners(rng, config, *SIZE),
            )
        ]
        tables = shapes(rng, 1, *SIZE, config=config).tables
        frames = [
            dataclasses.replace(frames[n], tables=tables) for n in rng.permutation(len(frames))
        ]
        film = Job(frame=frames[0], followed_by=frames[1:], write_tables="first", seed=number)
        yield act_of("film", film, stalls)
    ends = []
    for _ in range(16):
        frame = frame_of([any_control(rng, config, end=True)], *SIZE, config=config)
        ends.append(dataclasses.replace(frame, codewords=frame.codewords[:1], tables=tables))
    ends.append(dataclasses.replace(frames[0], tables=tables))
    film = Job(frame=ends[0], followed_by=ends[1:], write_tables="first")
    yield act_of("any end word", film)


def _initial(rng, config: EngineConfig) -> Iterator[Act]:
    """Yield frames over a raster, and films of them."""
    for number, stalls in enumerate(STALLS):
        wide = (config.max_width, 9)
        for size, share in ((SIZE, 0.4), ((64, 60), 0.02), (wide, (0.7, 0.1)[number % 2])):
            job = Job(
                frame=shapes(rng, 60, *size, config=config),
                followed_by=[shapes(rng, 30, 33, 20, config=config), frame_of([], *SIZE, config=config)],
                initial=[random_raster(rng, *size, share, config), None, random_raster(rng, *SIZE, 0.1, config)],
                seed=number,
                initial_waits=number % 2 == 1,
            )  # fmt: skip
            yield act_of("over rasters", job, stalls)
    frame = shapes(rng, 50, *SIZE, config=config)
    job = Job(frame=frame, initial=random_raster(rng, *SIZE, 0.4, config))
    yield odd_beats(act_of("odd beats", job), rng, frame)
    yield odd_beats(act_of("odd beats, stalled", job, STALLED), rng, frame)
    for job in list(films(rng, [{}], config))[-1:]:
        yield act_of("late line", job)


def _resets(rng, config: EngineConfig) -> Iterator[Act]:
    """Yield resets at several times, and what the engine does after each."""
    edges = 0
    clear = config.clear_cycles
    for number, cut in enumerate((3, 140, clear + 40, clear + 150, clear + 301, clear + 420)):
        over = random_raster(rng, *SIZE, 0.3, config) if number % 2 else None
        job = Job(
            frame=shapes(rng, 200, *SIZE, config=config),
            followed_by=[shapes(rng, 60, *SIZE, config=config)],
            initial=over,
            seed=number,
            write_tables="every" if number else "none",
        )
        yield act_of("reset", job, STALLS[number % 6], cut=cut, reset_edges=edges)
        edges = 1 + number % 2
    # A reset keeps the materials, and sets size and I0.
    frame = shapes(rng, 60, *SIZE, config=config)
    yield act_of("after resets", Job(frame=frame), reset_edges=1)
    dark = dataclasses.replace(frame.tables, ambient=np.zeros(3, np.int64))
    width, height = config.reset_size
    frame = dataclasses.replace(frame, tables=dark, width=width, height=height)
    yield act_of("what a reset keeps", Job(frame=frame, write_tables="none"), reset_edges=1)
    yield act_of("a frame after it", Job(frame=shapes(rng, 60, *SIZE, config=config)))
