"""Random frames and corner cases for tests of the engine."""

import dataclasses

import numpy as np

from splatline.contract.frame import Frame, Tables, are_control
from splatline.contract.plane import LOW_BITS, SIDES, Z_FRACTION
from splatline.contract.presets import PAPER
from splatline.contract.raster import Raster
from splatline.host.encode.sort_by_line import advance_word, end_word
from splatline.sim.cosim.player.frames import Job
from tests.support.plane_words import array_of, integers_of

__all__ = ["films", "frame_of", "nonsense", "random_raster", "random_tables", "shapes", "word"]


def word(rows, x, z, *, mode=1, diffuse=0, specular=0, material=0, plane=0, config=PAPER):
    """Return a code word with four rows of (first, last); with planes a flat one at whole depth.

    ``plane``: bits of a plane word's moved ends and slopes, at their places.
    """
    scans = sum((first | last << 3) << 6 * row for row, (first, last) in enumerate(rows))
    fields = (
        (mode, config.mode),
        (scans, config.scans),
        (diffuse, config.diffuse),
        (specular, config.specular),
        (material, config.material),
        (x, config.x),
        (z << Z_FRACTION if config.plane else z, config.z),
    )
    return sum(value << field.lsb for value, field in fields) | plane


def random_plane(rng, config):
    """Return moved ends for ``word``, and in half of all cases slopes; 0 for other engines."""
    if not config.plane:
        return 0
    sides = int(rng.integers(1 << SIDES)) << config.side(0, 0).lsb
    fields = config.z.lsb if rng.random() < 0.5 else config.slope_x.lsb
    return sides | int(rng.integers(1 << fields - LOW_BITS)) << LOW_BITS


def random_tables(rng, config=PAPER):
    """Return random tables. Small entries are common, so that not every colour saturates."""

    def numbers(bits, size):
        return rng.integers(0, 1 << bits, size) >> rng.integers(0, bits, size)

    size = (config.register_base, 3)
    ambient = numbers(config.ambient_bits - 1, 3)
    return Tables(
        ambient, numbers(config.coefficient_bits, size), numbers(config.coefficient_bits, size)
    )


def frame_of(words, width=512, height=512, seed=0, config=PAPER):
    """Return a frame of words, with an end word."""
    stream = [*map(int, words), end_word(config)]
    stream = array_of(stream) if config.plane else np.array(stream, np.uint64)
    tables = random_tables(np.random.default_rng(seed), config)
    return Frame(stream, tables, width, height, config)


def nonsense(rng, count, width, height, advance=0.05, config=PAPER):
    """Return a frame of words of random bits, without end words, and with words that advance."""
    words = rng.integers(0, 1 << 64, count, np.uint64)
    stepping = rng.random(count) < advance
    words[stepping] = [advance_word(int(n), config) for n in rng.integers(0, 12, stepping.sum())]
    words[are_control(words, config)] &= ~np.uint64(1 << config.control_end.lsb)
    if config.plane:
        words = integers_of(np.stack([words, rng.integers(0, 1 << 32, count, np.uint64)], axis=1))
    return frame_of(words, width, height, int(rng.integers(1 << 30)), config)


def shapes(rng, count, width, height, largest=8, config=PAPER):
    """Return a frame as of a host: convex elements, mostly small, sorted, also over the borders."""
    lines = np.sort(rng.integers(0, height + 4, count))
    step = config.background_depth // 15
    words, before = [], 0
    for line in lines:
        if line > before:
            words.append(advance_word(int(line - before), config))
            before = line
        size = int(rng.integers(1, largest + 1))
        rows = []
        for row in range(4):
            if 3 - row >= (size + 1) // 2:
                rows.append((1, 0))
                continue
            half = int(rng.integers(1, (size + 1) // 2 + 1))
            rows.append((4 - half, 3 + half))
        words.append(
            word(
                rows,
                int(rng.integers(0, min(width + 3, config.max_width))),
                step * int(rng.integers(16)),  # few depths, so that ties are common
                mode=int(rng.integers(2)),
                diffuse=int(rng.integers(config.diffuse.mask + 1)),
                specular=int(rng.integers(config.specular.mask + 1)),
                material=int(rng.integers(config.material.mask + 1)),
                plane=random_plane(rng, config),
                config=config,
            )
        )
    return frame_of(words, width, height, int(rng.integers(1 << 30)), config)


def random_raster(rng, width, height, share, config=PAPER):
    """Return a raster with a share of its pixels drawn."""
    raster = Raster.background(width, height, config)
    drawn = rng.random((height, width)) < share
    raster.depth[drawn] = config.background_depth // 15 * rng.integers(0, 15, drawn.sum())
    raster.colour[drawn] = rng.integers(0, config.channel_max + 1, (drawn.sum(), 3))
    return raster


def films(rng, every_rates, config=PAPER):
    """Yield jobs of several frames of one size and with the same tables, without gaps between.

    Frames are full, empty, or have elements at the top, at the bottom or far apart, in random
    order. Heights are whole laps of the window or not. Lines have one stretch of dirty bits or
    several. There is an initial raster or none. Streams stall at the rates given.
    """
    for seed, rates in enumerate(every_rates):
        for width, height, share in (
            *((40, 32, 0), (300, 37, 0), (40, 48, 0), (500, 5, 0)),
            *((200, 61, 0.05), (40, 64, 0.3)),
        ):
            frames = []
            for kind in rng.permutation(["full", "full", "top", "bottom", "few", "none"] * 2):
                count = {"full": 150, "few": 3, "none": 0}.get(kind, 30)
                lines = {"top": height // 3, "bottom": height // 4}.get(kind, height)
                frame = shapes(rng, count, width, lines, config=config)
                if kind == "bottom":
                    drawn = frame.codewords[:-1]
                    drawn = integers_of(drawn) if config.plane else drawn
                    words = [advance_word(height - lines, config), *drawn]
                    frame = frame_of(words, config=config)
                tables = frames[0].tables if frames else frame.tables
                frames.append(dataclasses.replace(frame, width=width, height=height, tables=tables))
            yield Job(
                frame=frames[0],
                followed_by=frames[1:],
                initial=random_raster(rng, width, height, share, config) if share else None,
                initial_waits=seed % 2 == 1,
                write_tables="first",
                rates=rates,
                seed=seed,
            )
    yield _on_a_late_line(config)


def _on_a_late_line(config):
    """Return a job with an element as near as the only pixel of the initial raster, which stays.

    In the frame before, the last two lines are far apart, and the first of them is long.
    """
    initial = Raster.background(64, 40, config)
    initial.depth[7, 0], initial.colour[7, 0] = 200, (1, 2, 3)
    empty = [(1, 0)] * 3
    long = [word([(0, 7), *empty], 8 * n, 5, config=config) for n in range(8)]
    last = word([(0, 7), *empty], 0, 5, config=config)
    words = [advance_word(10, config), *long, advance_word(7, config), last]
    before = frame_of(words, config=config)
    late = word([*empty, (0, 0)], 0, 200, diffuse=9, config=config)
    frames = [
        dataclasses.replace(frame, width=64, height=40, config=config, tables=tables)
        for tables in [random_tables(np.random.default_rng(0), config)]
        for frame in (before, frame_of([advance_word(8, config), late], config=config))
    ]
    return Job(frame=frames[0], followed_by=frames[1:], initial=initial, write_tables="first")
