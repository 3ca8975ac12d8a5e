"""Material of the trials: small frames of every kind, with golden's pictures of them."""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.fields import Register
from splatline.contract.frame import Frame, Tables
from splatline.contract.raster import Raster
from splatline.contract.raster_beats import to_beats
from splatline.sim.golden.renderer import render

from .frames import KINDS, digest_of, random_frame, random_raster, random_tables
from .records import WRITE, are_ends

__all__ = ["Item", "Stock", "frames_of", "table_write"]

SIZES = ((40, 32), (16, 24), (64, 48), (17, 25), (33, 47), (61, 33), (48, 40), (20, 31))
"""Sizes of images: columns and lines. Some are whole words and laps of the window."""


class Item(NamedTuple):
    """A frame, and the digest of golden's picture; frames that follow an end word are part of it.

    Parameters
    ----------
    words
        Code words, an end word last.
    digests
        Of the picture of each frame, from background.
    loaded
        The same, the first one from the size's initial raster.
    beats
        Of all pictures from background, without the end beats.
    """

    words: npt.NDArray[np.uint64]
    digests: list[int]
    loaded: list[int]
    beats: int


def table_write(address: int, data: int, config: EngineConfig, at: int = 0) -> tuple[Any, ...]:
    """Return a table write as a record ``WRITE``, offered from a cycle on."""
    payload = address << config.table_address.lsb | data << config.table_data.lsb
    return (at, (payload & (1 << 64) - 1, payload >> 64), 0)


def frames_of(words: npt.NDArray[np.uint64], config: EngineConfig) -> list[npt.NDArray[np.uint64]]:
    """Return the frames of a stream, each with its end word; words after the last are left out."""
    return np.split(words, np.flatnonzero(are_ends(words, config)) + 1)[:-1]


class Stock:
    """Frames, tables and initial rasters, all from one seed.

    Parameters
    ----------
    config
        The engine's configuration.
    seed
        Of all that is random.
    """

    def __init__(self, config: EngineConfig, seed: int) -> None:
        self.config = config
        rng = np.random.default_rng(seed)
        self.tables = random_tables(rng, config)
        self.rasters = {size: random_raster(rng, *size, 0.1, config) for size in SIZES}
        self.items = {
            (size, kind): self._item(random_frame(rng, kind, *size, config), size)
            for size in SIZES
            for kind in KINDS
        }

    def _item(self, words: npt.NDArray[np.uint64], size: tuple[int, int]) -> Item:
        """Return a frame with its digests."""
        digests = self.digests(words, size)
        first = frames_of(words, self.config)[0]
        loaded = digest_of(first, self.tables, *size, self.config, self.rasters[size])
        frames = [
            Frame(part, self.tables, *size, self.config) for part in frames_of(words, self.config)
        ]
        beats = sum(len(to_beats(render(frame))) - 1 for frame in frames)
        return Item(words, digests, [loaded, *digests[1:]], beats)

    def digests(
        self,
        words: npt.NDArray[np.uint64],
        size: tuple[int, int],
        tables: Tables | None = None,
    ) -> list[int]:
        """Return the digests of golden's pictures of a stream's frames."""
        tables = self.tables if tables is None else tables
        return [
            digest_of(frame, tables, *size, self.config) for frame in frames_of(words, self.config)
        ]

    def take(self, rng: np.random.Generator, size: tuple[int, int], *kinds: str) -> Item:
        """Return a frame of a size, of one of the kinds or of any."""
        return self.items[size, str(rng.choice(kinds or KINDS))]

    def size(self, rng: np.random.Generator) -> tuple[int, int]:
        """Return one of ``SIZES``."""
        return SIZES[int(rng.integers(len(SIZES)))]

    def setup(self, size: tuple[int, int], *, load: bool = False) -> list[tuple[Any, ...]]:
        """Return the writes of all frame registers."""
        base = self.config.register_base
        values = {
            **{Register.AMBIENT_RED + n: int(self.tables.ambient[n]) for n in range(3)},
            Register.LAST_COLUMN: size[0] - 1,
            Register.LAST_LINE: size[1] - 1,
            Register.CONTROL: int(load) << Register.CONTROL_LOAD,
        }
        return [table_write(base + n, value, self.config) for n, value in values.items()]

    def material(self, index: int, tables: Tables | None = None) -> tuple[Any, ...]:
        """Return the write of a material."""
        tables = self.tables if tables is None else tables
        data = 0
        for kind, table in enumerate((tables.diffuse, tables.specular)):
            for channel in range(3):
                lsb = self.config.coefficient(kind, channel).lsb
                data |= int(table[index, channel]) << lsb
        return table_write(index, data, self.config)

    @functools.cached_property
    def materials(self) -> list[tuple[Any, ...]]:
        """The writes of all materials."""
        return [self.material(index) for index in range(self.config.register_base)]

    def initial(self, raster: Raster) -> npt.NDArray[np.uint64]:
        """Return the beats of an initial raster, with a limb of TLAST: shape (n, limbs + 1)."""
        return with_last(to_beats(raster))


def with_last(beats: npt.NDArray[np.uint64]) -> npt.NDArray[np.uint64]:
    """Return beats with a further limb, which is 1 in the last of them."""
    last = np.zeros((len(beats), 1), np.uint64)
    last[-1:] = 1
    return np.concatenate([beats, last], axis=1)


def writes_of(writes: list[tuple[Any, ...]]) -> npt.NDArray[Any]:
    """Return records ``WRITE``."""
    return np.array(writes, WRITE)
