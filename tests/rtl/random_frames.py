"""Frames for the engine's tests: random, and made to hurt."""

import numpy as np

from splatline.host.frame import Frame, Tables
from splatline.host.order import advance_word, end_word
from splatline.rtl.format import PAPER
from splatline.sim import golden
from splatline.sim.raster import Raster

__all__ = ["frame_of", "nonsense", "random_raster", "random_tables", "shapes", "word"]

END = end_word(PAPER)


def word(rows, x, z, *, mode=1, diffuse=0, specular=0, material=0):
    """A code word with four rows of (first, last)."""
    scans = sum((first | last << 3) << 6 * row for row, (first, last) in enumerate(rows))
    fields = (
        (mode, 0),
        (scans, 1),
        (diffuse, 25),
        (specular, 32),
        (material, 39),
        (x, 46),
        (z, 55),
    )
    return sum(value << lsb for value, lsb in fields)


def random_tables(rng):
    return Tables(
        rng.integers(0, 1 << 13, 3), rng.integers(0, 64, (128, 3)), rng.integers(0, 64, (128, 3))
    )


def frame_of(words, width=512, height=512, seed=0):
    """A frame of words and its end word."""
    stream = np.array([*map(int, words), END], np.uint64)
    return Frame(stream, random_tables(np.random.default_rng(seed)), width, height)


def nonsense(rng, count, width, height, advance=0.05):
    """Any 64 bits at all, but with no end of the frame among them and steps to advance."""
    words = rng.integers(0, 1 << 64, count, np.uint64)
    stepping = rng.random(count) < advance
    words[stepping] = [advance_word(int(n), PAPER) for n in rng.integers(0, 12, stepping.sum())]
    ends = golden.decode(words, PAPER)["end"]
    words[ends] &= ~np.uint64(1 << PAPER.control_end.lsb)
    return frame_of(words, width, height, int(rng.integers(1 << 30)))


def shapes(rng, count, width, height, largest=8):
    """Elements like a host's: convex, mostly small, sorted by line, up to and over the borders."""
    lines = np.sort(rng.integers(0, height + 4, count))
    words, before = [], 0
    for line in lines:
        if line > before:
            words.append(advance_word(int(line - before), PAPER))
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
                int(rng.integers(0, min(width + 3, 512))),
                34 * int(rng.integers(16)),  # few depths, so that ties are common
                mode=int(rng.integers(2)),
                diffuse=int(rng.integers(128)),
                specular=int(rng.integers(128)),
                material=int(rng.integers(128)),
            )
        )
    return frame_of(words, width, height, int(rng.integers(1 << 30)))


def random_raster(rng, width, height, share):
    """A picture in which a share of the pixels is drawn."""
    raster = Raster.background(width, height)
    drawn = rng.random((height, width)) < share
    raster.depth[drawn] = 34 * rng.integers(0, 15, drawn.sum())
    raster.colour[drawn] = rng.integers(0, 8, (drawn.sum(), 3))
    return raster
