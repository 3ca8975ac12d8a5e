"""Trials of streams that no host would send: each has a picture, since any bits are a code word."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.frame import are_control
from splatline.contract.raster import Raster
from splatline.contract.raster_beats import LIMB
from splatline.host.encode.sort_by_line import advance_word

from .frames import any_bits, digest_of, ended
from .loaded import loaded_raster
from .stall_trials import film, random_stalls
from .stock import Stock, with_last, writes_of
from .trial import Trial, phase

__all__ = ["initial_trials", "mutate", "nonsense_trials", "stream_trials"]

_Words = npt.NDArray[np.uint64]
MUTATIONS = ("cut", "doubled", "shuffled", "filled", "flipped", "interleaved", "reversed")


def mutate(
    words: _Words, other: _Words, kind: str, rng: np.random.Generator, noise: _Words
) -> _Words:
    """Return a stream with a fault.

    Parameters
    ----------
    words, other
        Two streams: shape (n, ...).
    kind
        One of ``MUTATIONS``.
    rng
        Chooses the places.
    noise
        As many words of any bits as ``words`` has.
    """
    count = len(words)
    begin, end = np.sort(rng.integers(0, count + 1, 2))
    if kind == "cut":
        return np.delete(words, np.s_[begin:end], axis=0)
    if kind == "doubled":
        return np.insert(words, end, words[begin:end], axis=0)
    if kind == "interleaved":
        both = np.concatenate([words, other])
        order = rng.random(len(both))
        order[:count].sort()
        order[count:].sort()
        return both[np.argsort(order, kind="stable")]
    words = words.copy()
    if kind == "shuffled":
        rng.shuffle(words[begin:end], axis=0)
    elif kind == "filled":
        words[begin:end] = noise[begin:end]
    elif kind == "reversed":
        words[begin:end] = words[begin:end][::-1].copy()
    else:
        flat = words.reshape(count, -1)
        flips = int(rng.integers(1, 12))
        rows = rng.integers(0, count, flips)
        bits = rng.integers(0, flat.shape[1] * LIMB, flips)
        np.bitwise_xor.at(
            flat, (rows, bits // LIMB), np.uint64(1) << (bits % LIMB).astype(np.uint64)
        )
    return words


def stream_trials(
    stock: Stock, rng: np.random.Generator, numbers: range, total: int
) -> Iterator[Trial]:
    """Yield films whose stream of code words has a fault, and a whole frame behind it."""
    config = stock.config
    for number in numbers:
        kind = MUTATIONS[number % len(MUTATIONS)]
        size = stock.size(rng)
        one, other = (
            np.concatenate([stock.take(rng, size).words for _ in range(2)]) for _ in range(2)
        )
        words = _clean(mutate(one, other, kind, rng, any_bits(rng, len(one), config)), config)
        yield _with_check(stock, rng, words, size, f"code words {kind}")


def nonsense_trials(
    stock: Stock, rng: np.random.Generator, numbers: range, total: int
) -> Iterator[Trial]:
    """Yield frames of 64 words of random bits.

    In a third of them the lines advance slowly, and in a third by thousands: past every line that
    the engine can count.
    """
    config = stock.config
    for number in numbers:
        words = any_bits(rng, 64, config)
        low = words[:, 0] if config.plane else words
        if number % 3 == 1:
            control = are_control(low, config)
            low[control] &= ~np.uint64(config.x.mask - 7 << config.x.lsb)
        elif number % 3 == 2:
            empty, end = advance_word(0, config), np.uint64(1 << config.control_end.lsb)
            low[::3] = low[::3] & ~end | np.uint64(empty)
            low[::3] &= ~np.uint64(config.scans.mask << config.scans.lsb) | np.uint64(empty)
        yield _with_check(stock, rng, words, stock.size(rng), "words of any bits")


def initial_trials(
    stock: Stock, rng: np.random.Generator, numbers: range, total: int
) -> Iterator[Trial]:
    """Yield frames from an initial raster with a fault, and a frame from a whole one."""
    config = stock.config
    for number in numbers:
        kind = MUTATIONS[number % len(MUTATIONS)]
        size = stock.size(rng)
        item = stock.take(rng, size)
        while len(item.digests) > 1:
            item = stock.take(rng, size)
        beats, other = (stock.initial(raster)[:-1, :-1] for raster in _two(stock, rng, size))
        noise = _any_beats(rng, max(len(beats), 1), config)
        if len(beats):
            beats = mutate(beats, other, kind, rng, noise)
        beats[:, -1] &= ~np.uint64(0) >> np.uint64(LIMB * beats.shape[1] - config.raster_end.lsb)
        end = np.zeros((1, beats.shape[1]), np.uint64)
        end[0, config.raster_end.lsb // LIMB] = 1 << config.raster_end.lsb % LIMB
        raster = loaded_raster(beats, *size, config)
        wanted = [digest_of(item.words, stock.tables, *size, config, raster)]
        part = phase(
            item.words, size, config, wanted, initial=with_last(np.concatenate([beats, end])),
            writes=writes_of(stock.setup(size, load=True)), stalls=random_stalls(rng, 0.4),
            seed=number,
        )  # fmt: skip
        after, digests = film(stock, rng, 1, load=bool(rng.random() < 0.5), size=size)
        yield Trial(f"initial raster {kind}", [part, after], [[wanted], [digests]])


def _two(stock: Stock, rng: np.random.Generator, size: tuple[int, int]) -> tuple[Raster, Raster]:
    """Return the initial rasters of a size and of any other one."""
    return stock.rasters[size], stock.rasters[stock.size(rng)]


def _any_beats(rng: np.random.Generator, count: int, config: EngineConfig) -> _Words:
    """Return beats of random bits, without an end."""
    return rng.integers(0, 1 << LIMB, (count, -(-config.raster_end.end // LIMB)), np.uint64)


def _clean(words: _Words, config: EngineConfig) -> _Words:
    """Return words without the bits that a port lacks."""
    if config.plane:
        words[:, 1] &= np.uint64(0xFFFF_FFFF)
    return words


def _with_check(
    stock: Stock, rng: np.random.Generator, words: _Words, size: tuple[int, int], name: str
) -> Trial:
    """Return the trial of a stream, ended, and of a frame that follows with or without a gap."""
    config = stock.config
    words = ended(words, config)
    digests = stock.digests(words, size)
    check = stock.take(rng, size, "dense", "top", "bottom")
    settings: dict[str, Any] = {
        "writes": writes_of(stock.setup(size)),
        "stalls": random_stalls(rng, 0.3),
        "seed": int(rng.integers(1 << 40)),
    }
    if rng.random() < 0.5:
        together = [*digests, *check.digests]
        part = phase(np.concatenate([words, check.words]), size, config, together, **settings)
        return Trial(name, [part], [[together]])
    parts = [
        phase(words, size, config, digests, **settings),
        phase(check.words, size, config, check.digests),
    ]
    return Trial(name, parts, [[digests], [check.digests]])
