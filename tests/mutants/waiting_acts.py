"""Acts in which a stream waits for another: what the engine owes by then must come.

An engine that waits for more than its contract says hangs here.
"""

from collections.abc import Iterator

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.frame import are_control
from splatline.sim.cosim.player.frames import Job
from tests.support.random_frames import random_raster

from .frames import FULL, Words
from .job_act import act_of, film
from .program import Act

__all__ = ["waiting_acts"]

SIZE = (37, 41)
WIDE = 301
LAST_SLOT = 47
"""A line in the last slot of a window of 16 lines."""


def waiting_acts(rng: np.random.Generator, config: EngineConfig) -> Iterator[Act]:
    """Yield acts for an engine."""
    yield _words_wait(rng, config)
    yield _rasters_wait(rng, config)
    yield _end_waits(rng, config)


def _words_wait(rng: np.random.Generator, config: EngineConfig) -> Act:
    """Each element comes once the lines that the one before it completes are out.

    An element at line y completes the lines above its block, which begins at y - 4.
    """
    words = Words(config, rng)
    for line in range(SIZE[1] + 4):
        words.at(line)
        words.add(FULL, line * 101 % WIDE, mode=0)
    frame = words.frame(WIDE, SIZE[1])
    act = act_of("words wait for lines", Job(frame=frame))
    out = _beats_above(act, config)
    after, complete = [], 0
    elements = iter(range(SIZE[1] + 4))
    for control in are_control(frame.codewords.reshape(len(frame.codewords), -1)[:, 0], config):
        after.append(out(complete))
        if not control:
            complete = next(elements) - 4
    act.items["codewords"].after = {"raster": np.array(after)}
    return act


def _rasters_wait(rng: np.random.Generator, config: EngineConfig) -> Act:
    """Each line of an initial raster comes once the lines above those being drawn are out.

    Once a beat of line b is offered, the lines above b are loaded. So the element whose last line
    is b - 1 is drawn, and the next one completes the line above its first one.
    """
    words = Words(config, rng)
    lines = config.tile_lines  # of an element
    for line in range(SIZE[1] + 5):
        words.at(line)
        words.add(FULL, line % (SIZE[0] - 9), mode=int(lines == 4))
    job = Job(
        frame=words.frame(*SIZE),
        initial=random_raster(rng, *SIZE, 0.4, config),
        write_tables="every",
    )
    act = act_of("rasters wait for lines", job)
    out = _beats_above(act, config)
    initial = act.items["initial"]
    of_beats = [*_lines(initial.payload, config), SIZE[1]]
    initial.after = {"raster": np.array([out(line - lines) for line in of_beats])}
    return act


def _end_waits(rng: np.random.Generator, config: EngineConfig) -> Act:
    """The last beat of a picture is taken once most words of the next one are: it is drawn."""
    first, second = Words(config, rng), Words(config, rng)
    first.at(LAST_SLOT)
    for x in range(0, 32, 8):
        first.add(FULL, x, mode=0)
    second.at(2)
    for n in range(60):
        second.add(FULL, n % 4 * 8, mode=0)
    frames = [words.frame(40, LAST_SLOT + 1) for words in (first, second)]
    act = film("end waits", frames)
    raster = act.items["raster"]
    last = len(_lines(raster.payload[: _first_end(raster.payload, config) + 1], config)) - 1
    held = np.zeros(len(raster.payload), np.int64)
    held[last:] = len(act.items["codewords"].payload) - 30
    raster.after, raster.held = {}, {"codewords": held}
    return act


def _lines(beats: np.ndarray, config: EngineConfig) -> list[int]:
    """Return the lines of beats but the end beat."""
    field = config.raster_line
    values = (int.from_bytes(row.astype("<u8").tobytes(), "little") for row in beats[:-1])
    return [value >> field.lsb & field.mask for value in values]


def _first_end(beats: np.ndarray, config: EngineConfig) -> int:
    """Return the number of the first end beat."""
    limb, bit = divmod(config.raster_end.lsb, 64)
    return int(np.flatnonzero(beats[:, limb] >> np.uint64(bit) & np.uint64(1))[0])


def _beats_above(act: Act, config: EngineConfig):
    """Return a function from a line to the number of beats that come of the lines above it."""
    lines = np.array(_lines(act.items["raster"].payload, config))
    return lambda line: int((lines < line).sum())
