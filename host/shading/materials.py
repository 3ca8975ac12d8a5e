"""Materials: a cloud's colours, reduced to a palette that fits the engine's table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Tables
from splatline.host.cloud.cloud import Cloud
from splatline.host.compiled_cache import cached_njit

from .lighting import Lighting

__all__ = ["Materials", "find_materials", "material_tables", "materials_of", "median_cut"]

MOST_MATERIALS = 128
"""Entries of the ``paper`` engine's table."""

LARGEST_PALETTE = 256  # of Pillow, and of indices of a byte

ROUNDS = 8
"""Rounds of k-means. Each further one gains 1 %."""

SAMPLED = 1 << 15
"""Most points from which a palette is found. More of them make it no better."""


@dataclass(frozen=True)
class Materials:
    """A palette, and each point's colour in it.

    Parameters
    ----------
    palette
        Shape (m, 3), uint8, m in 1..256.
    index
        Shape (n,), uint8.
    """

    palette: npt.NDArray[np.uint8]
    index: npt.NDArray[np.uint8]


def find_materials(cloud: Cloud, most: int = MOST_MATERIALS) -> Materials:
    """Return a palette for a cloud: its own colours if they are few, else the means of clusters.

    The clusters are those of Pillow's median cut, improved by Lloyd's algorithm (k-means), of a
    sample of the points. Each point has the nearest colour of the palette.

    Parameters
    ----------
    cloud
        The cloud.
    most
        Most materials; at most 256 are used.
    """
    most = min(most, LARGEST_PALETTE)
    colours = np.ascontiguousarray(cloud.colours, np.uint8)
    if (colours == colours[:1]).all():
        return Materials(colours[:1].copy(), np.zeros(len(colours), np.uint8))
    lookup = np.zeros(1 << 24, np.uint8)
    _mark(colours, lookup)
    keys = _marked(lookup)
    own = _colours_of(keys)
    if len(own) <= most:
        palette, nearest = own.astype(np.uint8), np.arange(len(own), dtype=np.uint8)
    else:
        palette = _find_palette(colours[:: -(-len(colours) // SAMPLED)], most)
        nearest = _nearest(palette, own)
    return _index(colours, lookup, keys, palette, nearest)


def materials_of(cloud: Cloud, palette: npt.NDArray[np.uint8]) -> Materials:
    """Return a cloud's materials in a palette that others share: of each colour the nearest."""
    colours = np.ascontiguousarray(cloud.colours, np.uint8)
    lookup = np.zeros(1 << 24, np.uint8)
    _mark(colours, lookup)
    keys = _marked(lookup)
    return _index(colours, lookup, keys, palette, _nearest(palette, _colours_of(keys)))


def _index(
    colours: npt.NDArray[np.uint8],
    lookup: npt.NDArray[np.uint8],
    keys: npt.NDArray[np.int64],
    palette: npt.NDArray[np.uint8],
    nearest: npt.NDArray[np.integer[Any]],
) -> Materials:
    """Return the materials of colours, given the palette's number for each colour that occurs."""
    lookup[keys] = nearest
    index = np.empty(len(colours), np.uint8)
    _look_up(colours, lookup, index)
    return Materials(palette, index)


def _marked(lookup: npt.NDArray[np.uint8]) -> npt.NDArray[np.int64]:
    """Return the numbers of the entries that are not 0, ascending; eight entries at a time."""
    eights = np.flatnonzero(lookup.view(np.uint64))
    numbers = (eights[:, np.newaxis] * 8 + np.arange(8)).ravel()
    return numbers[lookup[numbers] != 0]


def median_cut(colours: npt.NDArray[np.uint8], most: int, rounds: int = 0) -> npt.NDArray[np.uint8]:
    """Return a palette of colours by Pillow's median cut, improved by rounds of its k-means.

    Parameters
    ----------
    colours
        Shape (n, 3), uint8.
    most, rounds
        Most entries, and the rounds.
    """
    from PIL import Image

    image = Image.fromarray(np.ascontiguousarray(colours)[np.newaxis])
    reduced = image.quantize(
        most, Image.Quantize.MEDIANCUT, kmeans=rounds, dither=Image.Dither.NONE
    )
    return np.array(reduced.getpalette(), np.uint8).reshape(-1, 3)[:most]


def _find_palette(colours: npt.NDArray[np.uint8], most: int) -> npt.NDArray[np.uint8]:
    """Return the palette of a sample of a cloud's colours: shape (``most``, 3)."""
    keys, counts = np.unique(
        colours[:, 0].astype(np.int64) << 16 | colours[:, 1].astype(np.int64) << 8 | colours[:, 2],
        return_counts=True,
    )
    palette = median_cut(colours, most).astype(np.float64)
    return _refine(palette, _colours_of(keys), counts)


def _colours_of(keys: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return red, green and blue of colours as numbers: shape (n, 3)."""
    return np.stack([keys >> 16, keys >> 8 & 255, keys & 255], axis=-1)


@cached_njit()
def _mark(colours: Any, lookup: Any) -> None:
    """Set the entry of each colour that occurs."""
    for i in range(len(colours)):
        lookup[np.int64(colours[i, 0]) << 16 | np.int64(colours[i, 1]) << 8 | colours[i, 2]] = 1


@cached_njit(parallel=True)
def _look_up(colours: Any, lookup: Any, index: Any) -> None:
    """Set each point's entry of a table by colour."""
    for i in nb.prange(len(colours)):
        index[i] = lookup[
            np.int64(colours[i, 0]) << 16 | np.int64(colours[i, 1]) << 8 | colours[i, 2]
        ]


def _refine(
    palette: npt.NDArray[np.float64], colours: npt.NDArray[Any], counts: npt.NDArray[np.int64]
) -> npt.NDArray[np.uint8]:
    """Return a palette whose colours are the means of the colours nearest to each."""
    for _ in range(ROUNDS):
        nearest = _nearest(palette, colours)
        weight = np.bincount(nearest, counts, len(palette))
        for channel in range(3):
            total = np.bincount(nearest, counts * colours[:, channel], len(palette))
            np.divide(total, weight, out=palette[:, channel], where=weight > 0.0)
    return np.rint(palette).astype(np.uint8)


def _nearest(palette: npt.NDArray[Any], colours: npt.NDArray[np.int64]) -> npt.NDArray[np.uint8]:
    """Return the number of the palette's nearest colour for each colour; the first of several.

    Distances are in eighths of a level: three squares of at most 2,040 and a number of 8 bits fit
    32 bits. So a processor compares many entries at once.
    """
    eighths = np.rint(8.0 * palette).astype(np.int32)
    found = np.empty(len(colours), np.uint8)
    _find_nearest(np.ascontiguousarray(eighths.T), colours, found)
    return found


@cached_njit(parallel=True)
def _find_nearest(palette: Any, colours: Any, found: Any) -> None:
    """Set the number of the nearest entry of a palette of shape (3, m), in eighths."""
    reds, greens, blues = palette
    for i in nb.prange(len(colours)):
        red, green, blue = (
            np.int32(8 * colours[i, 0]), np.int32(8 * colours[i, 1]), np.int32(8 * colours[i, 2])
        )  # fmt: skip
        least = np.uint32(0xFFFFFFFF)
        for k in range(len(reds)):
            # numba has 64 bits for each difference and product, unless it is told otherwise.
            across, up, deep = (
                np.int32(reds[k] - red), np.int32(greens[k] - green), np.int32(blues[k] - blue)
            )  # fmt: skip
            square = np.uint32(np.int32(across * across) + np.int32(up * up))
            square = np.uint32(square + np.uint32(np.int32(deep * deep)))
            least = min(least, np.uint32(np.uint32(square << np.uint32(8)) | np.uint32(k)))
        found[i] = np.uint8(least & np.uint32(255))


def material_tables(
    materials: Materials, lighting: Lighting, config: EngineConfig, rounding: float = 0.5
) -> Tables:
    """Return the engine's tables for a palette under a lighting.

    kd is scaled so that white at the largest D gives the largest level. I0 holds the rounding
    offset: one half by default, which rounds to nearest. In ``paper``, kd is at most
    round(7 * 1024 / 127) = 56 and ks at most 56 gloss, within 6 bits for a gloss up to 1. I0 is
    512, at most 1024.

    Parameters
    ----------
    materials, lighting, config
        The palette, the lights and surface, and the engine.
    rounding
        Rounding offset in [0, 1) of a level, added before truncation.
    """
    scale = config.channel_max * (1 << config.colour_shift) / config.diffuse.mask
    largest = (1 << config.coefficient_bits) - 1
    diffuse = np.zeros((1 << config.material_bits, 3), np.int64)
    diffuse[: len(materials.palette)] = np.rint(materials.palette / 255.0 * scale)
    gloss = min(round(lighting.gloss * scale), largest)
    specular = np.full_like(diffuse, gloss)
    level = 1 << config.colour_shift
    ambient = np.full(3, round(rounding * level), np.int64)
    return Tables(ambient, np.minimum(diffuse, largest), specular)
