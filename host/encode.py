"""Encoding: from splats on the image to code words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from ..rtl.format import BLOCK, ROWS, EngineConfig
from .emit import LARGEST
from .exact import conic, encode_exact, extent, quantised_depth
from .project import Splats
from .quality import DEFAULT_QUALITY, QUALITIES
from .shapes import level_slopes, shape_table
from .symmetric import encode_symmetric
from .view import View

__all__ = ["Encoded", "depth_shares", "encode"]


@dataclass(frozen=True)
class Encoded:
    """Code words in the order of their splats, before sorting.

    Parameters
    ----------
    words
        Shape (n,), uint64.
    lines
        The engine's line that each is meant for: shape (n,), int16.
    elements
        Splats that gave at least one word.
    """

    words: npt.NDArray[np.uint64]
    lines: npt.NDArray[np.int16]
    elements: int


def depth_shares(
    splats: Splats, focal: float
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], tuple[float, float]]:
    """Return depths as shares of the range that a frame's splats span.

    Linear, fitted to the splats at hand: their nearest centre is 0 and their furthest 1.

    Returns
    -------
    depth
        Of the centres, in 0..1: shape (m,).
    gradient
        Change of that share along the disc's plane from a pixel to the next, on the right and
        below: -n' z / focal, shape (m, 2).
    limits
        Distances along the view that 0 and 1 stand for.
    """
    if not len(splats):
        return np.zeros(0), np.zeros((0, 2)), (0.0, 0.0)
    low, high = float(splats.depth.min()), float(splats.depth.max())
    span = high - low
    if span == 0.0:
        return np.zeros(len(splats)), np.zeros((len(splats), 2)), (low, high)
    # Dividing first keeps the products finite whatever the cloud's unit.
    relative = splats.depth / span
    gradient = -splats.slope * (relative / focal)[:, np.newaxis]
    return (splats.depth - low) / span, gradient, (low, high)


def encode(
    splats: Splats,
    depth: npt.NDArray[np.float64],
    gradient: npt.NDArray[np.float64],
    look: tuple[npt.NDArray[np.uint16], npt.NDArray[np.uint16], npt.NDArray[np.uint8]],
    view: View,
    config: EngineConfig,
    quality: str = DEFAULT_QUALITY,
) -> Encoded:
    """Return the code words that draw splats.

    Words that no pixel of the image needs are left out; those that cross the right or lower border
    are left to the engine.

    Parameters
    ----------
    splats
        What to draw.
    depth
        Of their centres, as shares of the frame's range: shape (m,); see :func:`depth_shares`.
    gradient
        Change of that share from a pixel to the next on the right and below: shape (m, 2).
    look
        D, S and material of each: shape (m,).
    view
        Size of the image, and its focal length.
    config
        Where the fields are.
    quality
        One of ``QUALITIES``.
    """
    diffuse, specular, material = (part.astype(np.uint64) for part in look)
    common = diffuse << np.uint64(config.diffuse.lsb)
    common |= specular << np.uint64(config.specular.lsb)
    common |= material << np.uint64(config.material.lsb)
    arrays = (
        splats.column,
        splats.line,
        splats.diameter,
        splats.shape,
        splats.slope,
        depth,
        gradient,
        common,
    )
    fixed = (
        shape_table(),
        level_slopes(),
        list(QUALITIES).index(quality),
        view.width,
        view.height,
        view.focal,
        config.x.lsb,
        config.z.lsb,
        config.background_depth - 1,
    )

    # Every chunk of splats counts its words, then writes them to its own part: the same words in
    # the same order, however many cores there are.
    bounds = np.linspace(0, len(splats), 65).astype(np.int64)
    starts = np.zeros(len(bounds), np.int64)
    elements = np.zeros(len(bounds), np.int64)
    nothing = np.zeros(0, np.uint64), np.zeros(0, np.int16)
    _encode_chunks(arrays, fixed, bounds, starts, elements, *nothing, False)
    starts = np.concatenate([[0], np.cumsum(starts[:-1])])
    words = np.empty(starts[-1], np.uint64)
    lines = np.empty(starts[-1], np.int16)
    _encode_chunks(arrays, fixed, bounds, starts, elements, words, lines, True)
    return Encoded(words, lines, int(elements.sum()))


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _encode_chunks(
    arrays: Any,
    fixed: Any,
    bounds: Any,
    starts: Any,
    elements: Any,
    words: Any,
    lines: Any,
    write: bool,
) -> None:
    """Encode each chunk: count its words into ``starts`` or, with ``write``, write from there."""
    for chunk in nb.prange(len(bounds) - 1):
        at = starts[chunk] if write else 0
        drawn = 0
        for i in range(bounds[chunk], bounds[chunk + 1]):
            before = at
            at = _encode_one(i, arrays, fixed, at, words, lines, write)
            drawn += at > before
        elements[chunk] = drawn
        if not write:
            starts[chunk] = at


@nb.njit(error_model="numpy")
def _encode_one(
    i: int, arrays: Any, fixed: Any, at: int, words: Any, lines: Any, write: bool
) -> int:
    """Write a splat's words from ``at`` on, and return where the next splat's begin."""
    columns, centre_lines, diameters, shapes, slopes, depths, gradients, commons = arrays
    table, levels, quality, width, height, focal, x_lsb, z_lsb, largest = fixed
    column, line = float(columns[i]), float(centre_lines[i])
    diameter, common = float(diameters[i]), commons[i]
    to = (words, lines, width, height, x_lsb, write)

    # Far smaller than a pixel or larger than any image makes no difference; the conic stays finite.
    radius = min(max(0.5 * diameter, 1e-3), LARGEST)
    form = conic(
        (column - 0.5 * width) / focal,
        (line - 0.5 * height) / focal,
        float(slopes[i, 0]),
        float(slopes[i, 1]),
        radius,
    )
    symmetric = quality == 0
    if quality == 1:
        top, bottom = extent(line, form[0], form[3])
        left, right = extent(column, form[2], form[3])
        fraction = bottom - top < ROWS and right - left < BLOCK
        symmetric = not fraction and diameter <= BLOCK
    if symmetric:
        common = common | np.uint64(quantised_depth(depths[i], largest)) << np.uint64(z_lsb)
        return encode_symmetric(column, line, diameter, shapes[i], table, levels, common, at, to)
    return encode_exact(column, line, form, depths[i], gradients[i], common, z_lsb, largest, at, to)
