"""Small frames of every kind: corners, borders, ties, extremes, elements far apart."""

import dataclasses

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame, Tables
from splatline.host.encode.sort_by_line import advance_word
from tests.support.random_frames import frame_of, random_plane, word

__all__ = [
    "DOT",
    "FULL",
    "Words",
    "any_control",
    "any_empty_row",
    "borders",
    "bright",
    "corners",
    "equal_depths",
    "every_row",
    "extremes",
    "few_far_apart",
    "rounding",
    "wide_line",
]

FULL = [(0, 7)] * 4
EMPTY = [(1, 0)] * 3
DOT = [(0, 0), *EMPTY]


class Words:
    """Words of a frame by line: ``at`` moves to a line, ``add`` appends an element."""

    def __init__(self, config: EngineConfig, rng: np.random.Generator):
        self.config, self.rng = config, rng
        self.words: list[int] = []
        self.line = 0

    def at(self, line: int) -> None:
        """Move to a line."""
        most = self.config.x.mask
        while line > self.line:
            step = min(line - self.line, most)
            self.words.append(advance_word(step, self.config))
            self.line += step

    def add(self, rows, x: int, z: int | None = None, mode: int = 1) -> None:
        """Add an element with random colour, and random depth unless given."""
        config, rng = self.config, self.rng
        depth = int(rng.integers(config.background_depth)) if z is None else z
        self.words.append(
            word(
                rows, x, depth, mode=mode,
                diffuse=int(rng.integers(config.diffuse.mask + 1)),
                specular=int(rng.integers(config.specular.mask + 1)),
                material=int(rng.integers(config.material.mask + 1)),
                plane=random_plane(rng, config) if z is None else 0, config=config,
            )
        )  # fmt: skip

    def frame(self, width: int, height: int) -> Frame:
        """Return the frame with random tables."""
        seed = int(self.rng.integers(1 << 30))
        return frame_of(self.words, width, height, seed, self.config)


def corners(rng: np.random.Generator, config: EngineConfig, width: int, height: int) -> Frame:
    """Return a frame with a pixel in each corner and one in the middle."""
    words = Words(config, rng)
    for line in (0, height // 2, height - 1):
        words.at(line + 4)
        for x in (0, width - 1) if line != height // 2 else (width // 2,):
            words.add(DOT, x, z=int(rng.integers(config.background_depth)))
    return words.frame(width, height)


def borders(rng: np.random.Generator, config: EngineConfig, width: int, height: int) -> Frame:
    """Return a frame of whole blocks that each border of the image cuts, by every amount."""
    words = Words(config, rng)
    for line in [*range(5), *range(height - 4, height + 6)]:
        words.at(line)
        for x in range(width - 9, width + 1, 1 + line % 3):
            words.add(FULL, min(x, config.max_width - 1), mode=int(rng.integers(2)))
        words.add(FULL, line % 9, mode=0)
    return words.frame(width, height)


def equal_depths(rng: np.random.Generator, config: EngineConfig, width: int, height: int) -> Frame:
    """Return a frame of many elements over each other, of one depth or the next."""
    words = Words(config, rng)
    depth = config.background_depth // 2
    for line in range(0, height + 4, 3):
        words.at(line)
        for _ in range(14):
            rows = [tuple(sorted(map(int, rng.integers(0, 8, 2)))) for _ in range(4)]
            z = depth + int(rng.integers(-1, 1))
            words.add(rows, int(rng.integers(width)), z=z, mode=int(rng.integers(2)))
    return words.frame(width, height)


def extremes(rng: np.random.Generator, config: EngineConfig, width: int, height: int) -> Frame:
    """Return a frame with the least and the largest values of every field, one bit at a time."""
    words = Words(config, rng)
    mask = config.background_depth
    depths = [0, 1, mask, mask - 1, *(1 << bit for bit in range(config.depth_bits))]
    for number, z in enumerate([*depths, *(mask ^ d for d in depths)]):
        words.at(4 + number // 4 * 5)
        words.add(FULL, number % 4 * 9, z=z)
        words.add([(1, 6), (0, 7), (3, 3), (7, 7)], number % 4 * 9 + 1, z=max(z - 1, 0))
    for field in (config.diffuse, config.specular, config.material):
        words.at(words.line + 4)
        for bit in range(field.width):
            for value in (1 << bit, field.mask ^ 1 << bit):
                place = bit * 4 % max(1, width - 4)
                dot = word(DOT, place, 3 + bit, config=config, **{_name(field, config): value})
                words.words.append(dot)
    return words.frame(width, height)


def _name(field, config: EngineConfig) -> str:
    """Return the name of a colour's field."""
    names = {"diffuse": config.diffuse, "specular": config.specular, "material": config.material}
    return next(name for name, one in names.items() if one == field)


def few_far_apart(rng: np.random.Generator, config: EngineConfig) -> Frame:
    """Return a frame of the largest size with few elements: most lines are skipped."""
    words = Words(config, rng)
    width, height = config.max_width, config.max_height
    lines = {0, 7, *(1 << bit for bit in range(config.line_bits)), height - 1, height + 3}
    for line in sorted(lines):
        words.at(line)
        for bit in rng.permutation(config.x_bits)[:4]:
            words.add(FULL, (1 << int(bit)) + int(rng.integers(-1, 2)) & width - 1, mode=0)
        words.add(FULL, width - 1 - line % 9)
    return words.frame(width, height)


def wide_line(rng: np.random.Generator, config: EngineConfig, height: int = 12) -> Frame:
    """Return a frame of the largest width, drawn from border to border, more than once."""
    words = Words(config, rng)
    width = config.max_width
    for line in range(2, height + 3, 4):
        words.at(line)
        for _ in range(2):
            for x in rng.permutation(np.arange(0, width, 8)):
                words.add(FULL, int(x), mode=int(rng.integers(2)))
    return words.frame(width, height)


def any_empty_row(rng: np.random.Generator) -> tuple[int, int]:
    """Return first and last column of a row without pixels."""
    last = int(rng.integers(7))
    return int(rng.integers(last + 1, 8)), last


def any_control(rng: np.random.Generator, config: EngineConfig, *, end: bool, x: int = 0) -> int:
    """Return a control word with any empty rows, and anything in the bits that mean nothing."""
    diffuse = int(rng.integers(config.diffuse.mask + 1)) & ~1 | int(end)
    return word(
        [any_empty_row(rng) for _ in range(4)],
        int(rng.integers(config.x.mask + 1)) if end else x,
        int(rng.integers(config.background_depth)),
        mode=1, diffuse=diffuse,
        specular=int(rng.integers(config.specular.mask + 1)),
        material=int(rng.integers(config.material.mask + 1)),
        plane=random_plane(rng, config), config=config,
    )  # fmt: skip


def every_row(rng: np.random.Generator, config: EngineConfig) -> Frame:
    """Return a frame in which each row of a word has every pair of ends, in either mode.

    The word's other rows are random, or empty in any way; of a word without pixels in mode 1, which
    is a control word, X is 0. Elements do not overlap.
    """
    words = Words(config, rng)
    width = min(config.max_width, 512)
    across = (width - 12) // 10
    pairs = [(row, first, last) for row in range(4) for first in range(8) for last in range(8)]
    for number, (row, first, last) in enumerate(pairs):
        words.at(4 + number // across * 9)
        bare = rng.random() < 0.5
        rows = [
            any_empty_row(rng) if bare else tuple(map(int, rng.integers(0, 8, 2))) for _ in range(4)
        ]
        rows[row] = first, last
        mode = 1 if bare else int(rng.integers(2))
        if mode and all(one > other for one, other in rows):
            words.words.append(any_control(rng, config, end=False))
            mode = 0
        words.add(rows, number % across * 10 + int(rng.integers(3)), mode=mode)
    return words.frame(width, words.line + 5)


def rounding(rng: np.random.Generator, config: EngineConfig, width: int, height: int) -> Frame:
    """Return a frame whose colours are just below and at the next level, for each channel of I0."""
    step = 32
    fraction = 1 << config.colour_shift
    ambient = rng.integers(0, 3 * fraction, 3)
    shape = (1 << config.material_bits, 3)
    tables = Tables(ambient, np.ones(shape, np.int64), np.full(shape, step))
    words = Words(config, rng)
    words.at(4)
    for number, value in enumerate(ambient.tolist()):
        for below in (0, 1):
            missing = fraction - value % fraction - below
            material = int(rng.integers(shape[0]))
            dot = word(
                DOT, 5 * (2 * number + below), 5, diffuse=missing % step,
                specular=missing // step, material=material, config=config,
            )  # fmt: skip
            words.words.append(dot)
    return dataclasses.replace(words.frame(width, height), tables=tables)


def bright(rng: np.random.Generator, config: EngineConfig, bit: int) -> Frame:
    """Return a frame whose channels are one bit each of I0: ``bit`` and two others."""
    bits = config.ambient_bits
    ambient = np.array([1 << (bit + other) % bits for other in (0, 5, 11)])
    shape = (1 << config.material_bits, 3)
    tables = Tables(ambient, np.zeros(shape, np.int64), np.zeros(shape, np.int64))
    return dataclasses.replace(corners(rng, config, 9, 9), tables=tables)
