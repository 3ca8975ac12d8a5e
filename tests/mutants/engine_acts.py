"""The fast bench of an engine: frames of every kind, with the golden renderer's pictures."""

import dataclasses
from collections.abc import Iterator

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.sim.cosim.player.frames import Job
from tests.support.random_frames import films, frame_of, nonsense, random_raster, shapes

from .frames import (
    FULL,
    Words,
    any_control,
    borders,
    bright,
    corners,
    equal_depths,
    every_row,
    extremes,
    few_far_apart,
    rounding,
    wide_line,
)  # fmt: skip
from .job_act import FREE, act_of
from .odd_inputs import odd_beats, odd_writes
from .program import SHY, Act
from .timed_acts import timed_acts
from .waiting_acts import waiting_acts

__all__ = ["engine_acts"]

STALLED = ({"codewords": 90, "tables": 128, "initial": 100, "raster": 160}, {})
SLOW_RASTER = ({"raster": 60}, {"raster": 40})
BURSTS = ({"codewords": 128, "initial": 40}, {"codewords": 24, "initial": 9})
STARVED = ({"initial": 200, "raster": 100, "codewords": 220}, {"raster": 90})
WAITS = ({"raster": SHY, "codewords": 180}, {"codewords": 3})
STALLS = (FREE, STALLED, SLOW_RASTER, BURSTS, STARVED, WAITS)
"""Rates and bursts of the streams: none stalls, all do, one starves another, one waits for it."""

SIZE = (37, 41)
"""Width and height of most images: no multiple of a word or of the window."""


def engine_acts(config: EngineConfig, seed: int = 1) -> list[Act]:
    """Return the acts of an engine's fast bench; the first begins with a reset."""
    rng, other, third = (np.random.default_rng(seed + n) for n in (0, 4, 8))
    return [
        act_of("after reset", Job(frame=shapes(rng, 60, *SIZE, config=config)), reset_edges=1),
        *_single(rng, config),
        *_films(rng, config),
        *_initial(rng, config),
        _raster_down_to_the_last_line(third, config),
        *waiting_acts(other, config),
        *timed_acts(other, config),
        *_resets(rng, config),
    ]


def _single(rng, config: EngineConfig) -> Iterator[Act]:
    """Yield single frames, without stalls, at the exact number of cycles, and with stalls."""
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
        "rounding": rounding(rng, config, *SIZE),
        "rounding again": rounding(rng, config, *SIZE),
        "rounding once more": rounding(rng, config, *SIZE),
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
    frames = [bright(rng, config, bit) for bit in range(config.ambient_bits)]
    yield act_of("bright", Job(frame=frames[0], followed_by=frames[1:]))
    for number, stalls in enumerate(STALLS[:4]):
        frames = [shapes(rng, 50, *size, config=config) for size in (SIZE, (52, 23), (20, 60))]
        yield act_of(
            "tables between", Job(frame=frames[0], followed_by=frames[1:], seed=number), stalls
        )
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
    for number, stalls in enumerate(STALLS):
        # Two frames are open when the writes of the third come.
        pair = [shapes(rng, count, *SIZE, config=config) for count in (120, 9)]
        pair = [dataclasses.replace(frame, tables=tables) for frame in pair]
        third = shapes(rng, 40, 30, 50, config=config)
        job = Job(frame=pair[0], followed_by=[pair[1], third], seed=number)
        yield act_of("tables behind two", job, stalls, written=[0, 2])
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
            second = shapes(rng, 30, 33, 20, config=config)
            last = random_raster(rng, *SIZE, 0.1, config)
            job = Job(
                frame=shapes(rng, 60, *size, config=config),
                followed_by=[second, frame_of([], *SIZE, config=config)],
                initial=[random_raster(rng, *size, share, config), None, last],
                seed=number,
                initial_waits=number % 2 == 1,
            )
            yield act_of("over rasters", job, stalls)
    frame = shapes(rng, 50, *SIZE, config=config)
    job = Job(frame=frame, initial=random_raster(rng, *SIZE, 0.4, config))
    yield odd_beats(act_of("odd beats", job), rng, frame)
    yield odd_beats(act_of("odd beats, stalled", job, STALLED), rng, frame)
    for number, job in enumerate(films(rng, [{}, {}], config)):
        yield act_of("long film", job, STALLS[number % len(STALLS)], limit=400_000)


def _raster_down_to_the_last_line(rng, config: EngineConfig) -> Act:
    """Return a frame over a raster of all lines: elements may lie below those that are loaded.

    So each bit of a line's number is at work while a beat waits for its line.
    """
    width, height = config.pixels_per_word, config.max_height
    words = Words(config, rng)
    while words.line < height - 30:
        words.at(words.line + int(rng.integers(9, 30)))
        words.add(FULL, 0, z=0)  # nearer than the raster
    raster = random_raster(rng, width, height, 0.9, config)
    raster.depth[raster.depth == 0] = 1
    job = Job(frame=words.frame(width, height), initial=raster)
    return act_of("a raster down to the last line", job, limit=400_000)


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
