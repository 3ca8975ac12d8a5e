"""Small random frames, tables and rasters, and the digests of golden's pictures of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import ROWS, EngineConfig
from splatline.contract.fields import Field
from splatline.contract.frame import Frame, Tables
from splatline.contract.raster import Raster
from splatline.contract.raster_beats import to_beats
from splatline.host.compiled_cache import cached_njit
from splatline.host.encode.sort_by_line import advance_word, end_word
from splatline.sim.golden.renderer import render

__all__ = [
    "KINDS",
    "any_bits",
    "digest_of",
    "ended",
    "random_frame",
    "random_raster",
    "random_tables",
]

_Words = npt.NDArray[np.uint64]
KINDS = ("dense", "sparse", "top", "bottom", "far", "nonsense", "empty")


def any_bits(rng: np.random.Generator, count: int, config: EngineConfig) -> _Words:
    """Return code words of random bits: shape (count,), or (count, 2) of plane words."""
    words = rng.integers(0, 1 << 64, (count, 2), np.uint64)
    words[:, 1] &= np.uint64(0xFFFF_FFFF)
    return words if config.plane else words[:, 0].copy()


def ended(words: _Words, config: EngineConfig) -> _Words:
    """Return code words with an end word behind them."""
    end = np.zeros((1, *words.shape[1:]), np.uint64)
    end.reshape(-1)[0] = end_word(config)
    return np.concatenate([words, end])


def random_tables(rng: np.random.Generator, config: EngineConfig) -> Tables:
    """Return random tables; small entries are common, so that not every colour saturates."""
    size = (config.register_base, 3)

    def numbers(bits: int, shape: tuple[int, ...]) -> npt.NDArray[np.int64]:
        return rng.integers(0, 1 << bits, shape) >> rng.integers(0, bits, shape)

    bits = config.coefficient_bits
    return Tables(numbers(config.ambient_bits - 1, (3,)), numbers(bits, size), numbers(bits, size))


def random_raster(
    rng: np.random.Generator, width: int, height: int, share: float, config: EngineConfig
) -> Raster:
    """Return a raster with a share of its pixels drawn, at few depths, so that ties are common."""
    raster = Raster.background(width, height, config)
    drawn = rng.random((height, width)) < share
    raster.depth[drawn] = config.background_depth // 15 * rng.integers(0, 15, drawn.sum())
    raster.colour[drawn] = rng.integers(0, config.channel_max + 1, (drawn.sum(), 3))
    return raster


def random_frame(
    rng: np.random.Generator, kind: str, width: int, height: int, config: EngineConfig
) -> _Words:
    """Return the code words of a frame, its end word included, of one of ``KINDS``."""
    count = {"dense": 120, "sparse": 12, "empty": 0, "far": 10}.get(kind, 40)
    words = any_bits(rng, count, config)
    low = words[:, 0] if config.plane else words  # a view
    if kind != "nonsense":
        _put(low, config.x, rng.integers(0, min(width + 3, config.max_width), count))
        few = rng.random(count) < 0.5
        rows = rng.integers(0, 1 << 6, (count, ROWS))
        # Half of the rows are as of a disc: about the middle, wider below.
        half = rng.integers(0, 4, (count, 1)) * np.arange(1, ROWS + 1) // ROWS
        rows = np.where(rng.random((count, 1)) < 0.6, 3 - half | (4 + half) << 3, rows)
        for row in range(ROWS):
            _put(low, Field(config.scans.lsb + 6 * row, 6), rows[:, row])
        if not config.plane:
            step = config.background_depth // 15
            _put(low[few], config.z, step * rng.integers(0, 16, few.sum()))
    steps = rng.random(count) < 0.3
    lines = {"top": height // 3, "bottom": height // 4}.get(kind, height)
    gaps = rng.integers(0, max(2, 2 * lines // max(1, steps.sum())) + 1, steps.sum())
    words[steps] = 0
    low[steps] = np.array([advance_word(0, config)], np.uint64)
    _put(low, config.x, np.where(steps, 0, _get(low, config.x)))
    spread = np.zeros(count, np.int64)
    spread[steps] = gaps
    low |= np.where(steps, spread, 0).astype(np.uint64) << np.uint64(config.x.lsb)
    if kind == "bottom":
        first = np.zeros((1, *words.shape[1:]), np.uint64)
        first.reshape(-1)[0] = advance_word(height - lines, config)
        words = np.concatenate([first, words])
    return ended(words, config)


def _get(low: _Words, field: Field) -> _Words:
    """Return a field of each word."""
    return low >> np.uint64(field.lsb) & np.uint64(field.mask)


def _put(low: _Words, field: Field, values: npt.NDArray[Any]) -> None:
    """Set a field of each word."""
    low &= ~np.uint64(field.mask << field.lsb)
    low |= values.astype(np.uint64) << np.uint64(field.lsb)


def digest_of(
    words: _Words,
    tables: Tables,
    width: int,
    height: int,
    config: EngineConfig,
    initial: Raster | None = None,
) -> int:
    """Return the digest of golden's picture of a frame, as the player computes it."""
    frame = Frame(words, tables, width, height, config)
    return int(_digest(to_beats(render(frame, initial, bands=1))))


@cached_njit()
def _digest(beats: Any) -> Any:
    """Return the digest of all beats but the last, as ``Raster.take`` in ``beats.h``."""
    digest = np.uint64(1)
    for beat in range(len(beats) - 1):
        for limb in range(beats.shape[1]):
            digest = (digest ^ beats[beat, limb]) * np.uint64(0x9E3779B97F4A7C15)
            digest ^= digest >> np.uint64(32)
    return np.int64(digest)
