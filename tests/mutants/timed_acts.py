"""Acts with bounds on their cycles, from what the engine's parts say of their throughput."""

from collections.abc import Iterator

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.contract.raster import Raster
from splatline.sim.cosim.player.frames import Job
from splatline.sim.cycles.cycles import count_cycles
from tests.support.random_frames import frame_of

from .frames import DOT, FULL, Words
from .job_act import act_of, film
from .program import Act

__all__ = ["timed_acts"]

EMPTY = (1, 0)
SLACK = 100
"""Cycles that a bound leaves for latencies, stretches and the last lines."""


def timed_acts(rng: np.random.Generator, config: EngineConfig) -> Iterator[Act]:
    """Yield acts for an engine."""
    for number in range(4):
        yield act_of("half pixels", Job(frame=_half_pixels(rng, config, number)), exact=True)
        yield act_of("stretches", Job(frame=_stretches(rng, config, number)), exact=True)
    for first_line in (36, 26):
        yield _beside_last_lines(rng, config, first_line)
    yield _far_end(rng, config)
    if not config.draws_blocks:
        yield _flush_beside_load(rng, config)
        yield _load_waits(rng, config)
        yield _load_beside_tiles(rng, config)
        yield _load_presses(rng, config)
        yield _load_beside_flush(rng, config)
        yield from (_loads_alone(config, place) for place in range(8))


def _half_pixels(rng, config: EngineConfig, number: int) -> Frame:
    """Return a frame of elements whose centre lies at half a pixel, each beside the one before."""
    words = Words(config, rng)
    x = 30
    for _ in range(90):
        words.at(words.line + int(rng.integers(1, 5)))
        rows = [tuple(sorted(map(int, rng.integers(0, 8, 2)))) for _ in range(4)]
        if rng.random() < 0.5:
            rows[3] = int(rng.integers(4, 8)), int(rng.integers(4))  # raised: its ends are swapped
        else:
            rows[0] = 7 - int(rng.integers(2)), 2  # shifted: without pixels
        words.add(rows, x, mode=0)
        x = (x + int(rng.integers(-4, 9))) % 60
    return words.frame(70, words.line + 4)


def _stretches(rng, config: EngineConfig, number: int) -> Frame:
    """Return a frame whose lines reach stretches of dirty bits from right to left."""
    words = Words(config, rng)
    width = config.max_width
    for line in range(4, 400, 40):
        right = width - 9
        for step in range(3):
            words.at(line + step * (4 + number % 2 * 3))
            for _ in range(int(rng.integers(1, 9))):
                words.add(FULL, right - int(rng.integers(40)), mode=int(rng.integers(2)))
            right -= int(rng.integers(2)) * width // 4
    return words.frame(width, 400)


def _beside_last_lines(rng, config: EngineConfig, first_line: int) -> Act:
    """The next frame's elements are drawn while the last lap's lines of the one before leave.

    So a film takes less than its frames alone, by a cycle for each of these elements.
    """
    first, second = Words(config, rng), Words(config, rng)
    for line in range(first_line + 4, 48, 4):
        first.at(line)
        for x in range(0, config.max_width, 8):
            first.add(FULL, x)
    first.at(48)
    first.add(FULL, 0)
    second.at(4)
    elements = 200
    for n in range(elements):
        second.add([EMPTY, EMPTY, EMPTY, (0, 0)], n % 64 * 8)
    frames = [words.frame(config.max_width, 48) for words in (first, second)]
    alone = sum(count_cycles(frame, after_reset=False) for frame in frames)
    return film("beside last lines", frames, most_cycles=alone - elements // 3)


def _far_end(rng, config: EngineConfig) -> Act:
    """A frame ends with elements at the last line that the engine counts to, far below the image.

    The window has moved there when the next frame comes, and has to come back for its elements.
    """
    frames = []
    for line in (20, 45, 33, 60, 18):
        words = Words(config, rng)
        words.at(line)
        words.add(FULL, line % 30)
        words.at(line + 4)
        words.add(FULL, line % 9, mode=0)
        words.at(5 << config.line_bits)
        for _ in range(2):  # of one pixel: the second waits, and with it the end word
            words.add(DOT, line % 30)
        frames.append(words.frame(40, 64))
    return film("far end", frames)


def _beats(config: EngineConfig, width: int, height: int, words: dict[int, int]) -> Raster:
    """Return a raster with so many words from the left in each line."""
    raster = Raster.background(width, height, config)
    for line, count in words.items():
        raster.depth[line, : count * config.raster_pixels] = 3
    return raster


def _dots_then(rng, config: EngineConfig, dots: int) -> Words:
    """Return words of a frame with some words of line 7 drawn."""
    words = Words(config, rng)
    words.at(11)
    for n in range(dots):
        words.add(DOT, n * config.pixels_per_word)
    return words


def _three_rows(words: Words, config: EngineConfig, count: int, free: int) -> None:
    """Add elements of three of the lines 8 to 11, a tile each; one row of lanes stays free."""
    words.at(12)
    row = (0, config.pixels_per_word - 1)
    for n in range(count):
        rows = [EMPTY if k == free else row for k in range(4)]
        words.add(rows, n % 8 * config.pixels_per_word)


def _over(kind: str, frame: Frame, start: Raster, wait_for: int, **cycles: int) -> Act:
    """Return the act of a frame over a raster; its beats but the first wait for code words."""
    act = act_of(kind, Job(frame=frame, initial=start, write_tables="every"), **cycles)
    beats = act.items["initial"]
    after = np.full(len(beats.payload), wait_for)
    after[0] = 0
    beats.after = {"codewords": after}
    return act


def _flush_beside_load(rng, config: EngineConfig) -> Act:
    """A flush goes beside tiles at least every other cycle, though a load waits for its row."""
    dots, tiles = 100, 300
    words = _dots_then(rng, config, dots)
    _three_rows(words, config, tiles, 3)
    frame = words.frame(config.max_width, 24)
    start = _beats(config, frame.width, frame.height, {19: 1, 20: 2})
    most = dots + tiles + SLACK
    return _over("flush beside load", frame, start, dots + 4, most_cycles=most)


def _load_waits(rng, config: EngineConfig) -> Act:
    """Loads four lines below the tiles' first one wait for tiles that use their row."""
    loads, tiles = 100, 500
    words = _dots_then(rng, config, 4)
    _three_rows(words, config, tiles, 3)
    frame = words.frame(config.max_width, 24)
    start = _beats(config, frame.width, frame.height, {19: 1, 20: loads})
    return _over("load waits", frame, start, 8, least_cycles=tiles + 3 * loads)


def _load_beside_tiles(rng, config: EngineConfig) -> Act:
    """Loads of a row of lanes that tiles leave free cost no tile a cycle."""
    loads, tiles = 100, 300
    words = Words(config, rng)
    _three_rows(words, config, tiles, 0)
    frame = words.frame(config.max_width, 24)
    start = _beats(config, frame.width, frame.height, {16: loads})
    return _over("load beside tiles", frame, start, 0, most_cycles=tiles + loads + SLACK)


def _load_presses(rng, config: EngineConfig) -> Act:
    """Loads of rows that all tiles use go alone, so that those behind them go beside the tiles.

    Loads take two cycles each. There are more of the last one's word than a line has words.
    """
    loads, tiles = 250, 600
    words = Words(config, rng)
    _three_rows(words, config, tiles, 2)
    frame = words.frame(config.max_width, 24)
    start = _beats(config, frame.width, frame.height, {16: 2, 17: 1, 18: 1})
    act = _over("load presses", frame, start, 20, most_cycles=tiles + 2 * SLACK)
    beats, times = act.items["initial"], [1, 1, 1, loads, 1]
    beats.payload = np.repeat(beats.payload, times, axis=0)
    beats.after = {"codewords": np.repeat(beats.after["codewords"], times)}
    return act


def _load_beside_flush(rng, config: EngineConfig) -> Act:
    """Loads take two cycles each, and flushes go in the other one."""
    words = 100
    drawn = _dots_then(rng, config, words)
    drawn.at(24)
    drawn.add(FULL, 0)
    frame = drawn.frame(config.max_width, 32)
    start = _beats(config, frame.width, frame.height, {19: 1, 20: words, 24: 1})
    most = words + 3 * words + SLACK
    return _over("load beside flush", frame, start, len(drawn.words), most_cycles=most)


def _loads_alone(config: EngineConfig, place: int) -> Act:
    """A load of one word in a stretch of dirty bits costs the flush of its pair, and no other.

    That are two cycles for the load and two for the flush. ``place``: number of four words in the
    stretch.
    """
    width, height = config.max_width, 60
    start = Raster.background(width, height, config)
    for line in range(height):
        words = np.arange(4 * place + line % 4, width // config.pixels_per_word, 32)
        start.depth[line, words * config.pixels_per_word] = 3
    loads = height * len(words)
    frame = frame_of([], width, height, config=config)
    most = 4 * loads + SLACK
    return act_of("loads alone", Job(frame=frame, initial=start), most_cycles=most)
