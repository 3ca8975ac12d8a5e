"""The nearest element of each pixel, and its depth there: a frame drawn in numbers of words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.codeword import decode_plane_word, decode_word, plane_at, plane_fields
from splatline.contract.config import BLOCK, ROWS, EngineConfig
from splatline.contract.frame import Frame
from splatline.contract.plane import SUM_FRACTION
from splatline.host.compiled_cache import cached_njit

from .encode import Encoded
from .read_stream import read_stream
from .stand_ins import number_of

__all__ = ["as_encoded", "elements_of", "find_owners"]

BANDS = 8
"""Bands of lines that are looked at in parallel."""


def elements_of(
    frames: Sequence[Frame], config: EngineConfig
) -> tuple[npt.NDArray[np.uint64], npt.NDArray[np.int64]]:
    """Return the words of all frames' elements, shape (n,) or (n, 2), and their lines, (n,).

    Raises
    ------
    InputError
        If a frame has no end word.
    """
    words, lines = [], []
    for frame in frames:
        found, line = read_stream(frame.codewords, config)
        words.append(frame.codewords[number_of(found)] if config.plane else found)
        lines.append(line)
    return np.concatenate(words), np.concatenate(lines)


def as_encoded(words: npt.NDArray[np.uint64], lines: npt.NDArray[np.int64], height: int) -> Encoded:
    """Return words in one chunk; those below the image are left out."""
    inside = lines < height + ROWS
    words, lines = words[inside], lines[inside]
    counts = np.bincount(lines, minlength=height + ROWS).astype(np.int32)
    span = np.array([0]), np.array([len(words)])
    return Encoded(words, lines.astype(np.int16), *span, counts[np.newaxis], len(words))


def find_owners(
    words: npt.NDArray[np.uint64],
    lines: npt.NDArray[np.int64],
    size: tuple[int, int],
    config: EngineConfig,
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
    """Return the depth of each pixel, and the number of the word that draws it.

    Parameters
    ----------
    words
        Elements in the order in which they are drawn: shape (n,), uint64; of an engine with planes
        (n, 2). Compact words are not decoded.
    lines
        Of each, ascending: shape (n,).
    size
        Width and height of the image.
    config
        Where the fields are.

    Returns
    -------
    depth
        Shape (height, width); ``config.background_depth`` where nothing is drawn.
    owner
        Shape (height, width); -1 where nothing is drawn.
    """
    width, height = size
    low, high = (words[:, 0], words[:, 1]) if config.plane else (words, words[:0])
    edges = height * np.arange(BANDS + 1) // BANDS
    fields = (config.x.lsb, config.x.mask, config.z.lsb, config.z.mask)
    depth = np.full((height, width), config.background_depth, np.int32)
    owner = np.full((height, width), -1, np.int32)
    _draw(
        np.ascontiguousarray(low).view(np.int64),
        np.ascontiguousarray(high).view(np.int64),
        lines,
        # A block lies on its word's line, on the four lines before, and on the three behind.
        (edges, np.searchsorted(lines, edges - ROWS), np.searchsorted(lines, edges + ROWS)),
        (config.plane, fields, plane_fields(config) if config.plane else (0,) * 6),
        depth,
        owner,
    )
    return depth, owner


@cached_njit(parallel=True)
def _draw(low: Any, high: Any, lines: Any, bands: Any, layout: Any, depth: Any, owner: Any) -> None:
    """Draw the words, band by band.

    Parameters
    ----------
    low, high
        Halves of the words, int64; ``high`` is empty without planes.
    lines
        Of each word.
    bands
        First line of each band and the end, and the words before which none touches the band that
        begins there, and behind which none touches the one that ends there.
    layout
        Whether words have planes, and where their fields are.
    depth, owner
        The image. Depths begin at the background's.
    """
    edges, befores, behinds = bands
    width = depth.shape[1]
    is_plane, (x_lsb, x_mask, z_lsb, z_mask), plane = layout
    for band in nb.prange(len(edges) - 1):
        top, bottom = edges[band], edges[band + 1]
        block = np.empty((BLOCK, 2), np.int64)
        for i in range(befores[band], behinds[band + 1]):
            x = low[i] >> x_lsb & x_mask
            if is_plane:
                decode_plane_word(low[i], high[i], block)
                start, a, b = plane_at(high[i], plane)
            else:
                decode_word(low[i], block)
                start, a, b = (low[i] >> z_lsb & z_mask) << SUM_FRACTION, 0, 0
            for row in range(BLOCK):
                line = lines[i] - ROWS + row
                if top <= line < bottom:
                    for c in range(block[row, 0], min(block[row, 1], width - 1 - x) + 1):
                        # Nothing is drawn at the depth of the background, or behind it.
                        z = max(start + a * c + b * row >> SUM_FRACTION, 0)
                        if z < depth[line, x + c]:
                            depth[line, x + c] = z
                            owner[line, x + c] = i
