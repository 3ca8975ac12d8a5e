"""Joins frames of parts of a cloud to one frame of the words that a pixel shows.

The joined frame draws the picture of all words together, bit for bit. A word that shows no pixel
among some words shows none among more, since the order of two words that share a pixel depends on
these two alone (:func:`splatline.host.encode.sort_by_line.sort_by_line`). So frames may be joined
in any order and in any groups, and a joined frame has at most one word for each pixel.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.codeword import decode_plane_word, decode_word, plane_at, plane_fields
from splatline.contract.config import BLOCK, ROWS, EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.contract.plane import SUM_FRACTION
from splatline.host.compiled_cache import cached_njit

from .encode import Encoded
from .read_stream import read_stream
from .sort_by_line import sort_by_line
from .stand_ins import number_of

__all__ = ["join_frames"]

BANDS = 8
"""Bands of lines that are looked at in parallel."""


def join_frames(frames: Sequence[Frame]) -> Frame:
    """Return the frame of all elements of some frames, without those that no pixel shows.

    Parameters
    ----------
    frames
        At least one; all have one size, configuration and tables, and no compact words.

    Returns
    -------
    Frame
        Its ``counts`` has ``elements`` and ``codewords``, those of the stream, and
        ``control_words``.

    Raises
    ------
    InputError
        If the frames do not belong together, or one has no end word.
    """
    first = frames[0]
    for frame in frames:
        _check_alike(frame, first)
    config = first.config
    words, lines = _elements(frames, config)
    stream, _ = sort_by_line(_as_encoded(words, lines, first.height), config)
    # Again, in the order in which they are drawn.
    sorted_words, sorted_lines = _elements([dataclasses.replace(first, codewords=stream)], config)
    shown = _shown(sorted_words, sorted_lines, first.width, first.height, config)
    seen = _as_encoded(sorted_words[shown], sorted_lines[shown], first.height)
    stream, control_words = sort_by_line(seen, config)
    counts = {
        "elements": int(np.count_nonzero(shown)),
        "codewords": len(stream),
        "control_words": control_words,
    }
    return dataclasses.replace(first, codewords=stream, counts=counts)


def _check_alike(frame: Frame, first: Frame) -> None:
    """Raise ``InputError`` unless two frames are parts of one picture."""
    if (frame.width, frame.height, frame.config) != (first.width, first.height, first.config):
        raise InputError("frames of two sizes or engines cannot be joined")
    for name in ("ambient", "diffuse", "specular"):
        if not np.array_equal(getattr(frame.tables, name), getattr(first.tables, name)):
            raise InputError(f"frames with two tables {name!r} cannot be joined")


def _elements(
    frames: Sequence[Frame], config: EngineConfig
) -> tuple[npt.NDArray[np.uint64], npt.NDArray[np.int64]]:
    """Return the words of all frames' elements, and their lines."""
    words, lines = [], []
    for frame in frames:
        found, line = read_stream(frame.codewords, config)
        words.append(frame.codewords[number_of(found)] if config.plane else found)
        lines.append(line)
    return np.concatenate(words), np.concatenate(lines)


def _as_encoded(
    words: npt.NDArray[np.uint64], lines: npt.NDArray[np.int64], height: int
) -> Encoded:
    """Return words in one chunk; those below the image are left out."""
    inside = lines < height + ROWS
    words, lines = words[inside], lines[inside]
    counts = np.bincount(lines, minlength=height + ROWS).astype(np.int32)
    span = np.array([0]), np.array([len(words)])
    return Encoded(words, lines.astype(np.int16), *span, counts[np.newaxis], len(words))


def _shown(
    words: npt.NDArray[np.uint64],
    lines: npt.NDArray[np.int64],
    width: int,
    height: int,
    config: EngineConfig,
) -> npt.NDArray[np.bool_]:
    """Return which words are the nearest on any pixel.

    Parameters
    ----------
    words
        Elements in the order in which they are drawn.
    lines
        Of each, ascending.
    width, height
        Of the image.
    """
    low, high = (words[:, 0], words[:, 1]) if config.plane else (words, words[:0])
    edges = height * np.arange(BANDS + 1) // BANDS
    fields = (config.x.lsb, config.x.mask, config.z.lsb, config.z.mask)
    shown = np.zeros(len(words), np.bool_)
    _mark_shown(
        np.ascontiguousarray(low).view(np.int64),
        np.ascontiguousarray(high).view(np.int64),
        lines,
        # A block lies on its word's line, on the four lines before, and on the three behind.
        (edges, np.searchsorted(lines, edges - ROWS), np.searchsorted(lines, edges + ROWS)),
        (width, config.background_depth),
        (config.plane, fields, plane_fields(config) if config.plane else (0,) * 6),
        shown,
    )
    return shown


@cached_njit(parallel=True)
def _mark_shown(
    low: Any, high: Any, lines: Any, bands: Any, image: Any, layout: Any, shown: Any
) -> None:
    """Draw the words, band by band, and set those that are the nearest on any pixel.

    Parameters
    ----------
    low, high
        Halves of the words, int64; ``high`` is empty without planes.
    lines
        Of each word.
    bands
        First line of each band and the end, and the words before which none touches the band that
        begins there, and behind which none touches the one that ends there.
    image
        Width, and the background's depth.
    layout
        Whether words have planes, and where their fields are.
    shown
        Set.
    """
    edges, befores, behinds = bands
    width, background = image
    is_plane, (x_lsb, x_mask, z_lsb, z_mask), plane = layout
    for band in nb.prange(len(edges) - 1):
        top, bottom = edges[band], edges[band + 1]
        depth = np.full((bottom - top, width), background, np.int32)
        owner = np.full((bottom - top, width), -1, np.int64)
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
                line = lines[i] - ROWS + row - top
                if 0 <= line < bottom - top:
                    for c in range(block[row, 0], min(block[row, 1], width - 1 - x) + 1):
                        z = min(max(start + a * c + b * row >> SUM_FRACTION, 0), background)
                        if z < depth[line, x + c]:
                            depth[line, x + c] = z
                            owner[line, x + c] = i
        for line in range(bottom - top):
            for column in range(width):
                if owner[line, column] >= 0:
                    shown[owner[line, column]] = True
