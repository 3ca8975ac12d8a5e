"""The golden renderer: ``docs/contract.md`` as a program, against which the hardware is tested.

It is written from the contract and shares only ``contract/`` with the hardware. This module checks
the frame and converts its tables to arrays. The loops that draw are in ``kernel.py``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numba
import numpy as np
import numpy.typing as npt

from splatline.contract.config import BLOCK, ROWS, EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.fields import Field
from splatline.contract.frame import Frame, check_codewords, check_tables
from splatline.contract.presets import PAPER
from splatline.contract.raster import Raster

from .compact_words import expand_frame
from .kernel import ABOVE, draw_bands, index_lines, layout_of
from .plane_kernel import draw_plane_bands, plane_layout_of

__all__ = ["block_rows", "decode", "render", "render_parts"]

WORD_WORK = 4
"""Work of a code word, in units of a pixel's work: a rough figure, to cut bands of equal work."""

CODEWORD = np.dtype(
    [
        ("mode", np.uint8),
        ("first", np.uint8, (ROWS,)),
        ("last", np.uint8, (ROWS,)),
        ("diffuse", np.uint16),
        ("specular", np.uint16),
        ("material", np.uint16),
        ("x", np.uint16),
        ("z", np.uint16),
        ("raised", np.bool_),
        ("shifted", np.bool_),
        ("control", np.bool_),
        ("end", np.bool_),
    ]
)
"""The fields of a decoded code word."""


def render(frame: Frame, initial: Raster | None = None, *, bands: int | None = None) -> Raster:
    """Draw a frame, exact to the bit.

    Parameters
    ----------
    frame
        Code words, tables and the size of the image. Any 64 bits are a code word, or any 96 of an
        engine with planes (bits above them do not count); those after the
        end-of-frame word are not part of the frame and are ignored. Compact words are expanded
        first (:mod:`splatline.sim.golden.compact_words`).
    initial
        Raster to start from, such as the picture of the previous engine of a chain; background
        if not given. Its colours at background depth do not count. It is not changed.
    bands
        Number of bands of lines that are drawn in parallel, at least 1; by default the number of
        numba's threads. The picture does not depend on it.

    Returns
    -------
    Raster
        Depth and colour of every pixel, in new arrays.

    Raises
    ------
    InputError
        If there is no end-of-frame word, the image does not fit the engine, the code words have
        another shape than the engine's, or the tables another shape or larger values.
    ValueError
        If ``bands`` is below 1, or the initial raster has another size or configuration than the
        frame, or a value that no pixel holds.
    """
    config = frame.config
    if bands is None:
        bands = numba.get_num_threads()
    if bands < 1:
        raise ValueError(f"the image is drawn in at least one band of lines, not {bands}")
    _check_image(frame)
    check_codewords(frame.codewords, config)
    check_tables(frame.tables, config)
    if initial is not None:
        _check_initial(initial, frame)

    layout = layout_of(config)
    words = np.ascontiguousarray(expand_frame(frame).codewords, np.uint64)
    low = np.ascontiguousarray(words[:, 0]) if config.plane else words
    starts, ended = index_lines(low, frame.height + ABOVE, layout)
    if not ended:
        raise InputError("the code words have no end-of-frame word: the stream is cut short")

    raster = _initial_raster(frame, initial)
    tables = frame.tables
    common = (
        starts,
        _cut(starts, frame.width, frame.height, bands),
        np.ascontiguousarray(tables.ambient, np.int64),
        np.stack([tables.diffuse, tables.specular], axis=1).astype(np.int64, copy=False),
    )
    if config.plane:
        planes = plane_layout_of(config)
        draw_plane_bands(words.view(np.int64), *common, planes, raster.depth, raster.colour)
    else:
        draw_bands(words, *common, layout, raster.depth, raster.colour)
    return raster


def render_parts(parts: Sequence[Frame], initial: Raster | None = None) -> Raster:
    """Draw the parts of a picture one over the other, in order, as a chain does.

    Raises
    ------
    InputError, ValueError
        As :func:`render`; or if there are no parts.
    """
    if not parts:
        raise ValueError("a picture has at least one part")
    raster = render(parts[0], initial)
    for part in parts[1:]:
        raster = render(part, raster)
    return raster


def decode(codewords: npt.NDArray[np.uint64], config: EngineConfig = PAPER) -> npt.NDArray[Any]:
    """Decode code words into their fields.

    Parameters
    ----------
    codewords
        Shape (n,), uint64.
    config
        Configuration of the engine that they are made for.

    Returns
    -------
    numpy.ndarray
        Structured array of shape (n,). Its fields are those of ``docs/contract.md`` as unsigned
        integers: ``mode``, ``first`` and ``last`` (of four rows; the first and last column of a
        raised shape's middle row are in ascending order), ``diffuse``, ``specular``, ``material``,
        ``x`` and ``z``. Four more are bool: ``raised`` and ``shifted`` (the centre of a symmetric
        word lies half a line up, half a pixel to the right), ``control`` (a control word) and
        ``end`` (the end-of-frame word).

    Raises
    ------
    ValueError
        If the engine has planes.
    """
    if config.plane:
        raise ValueError("plane words are not decoded here")
    words = np.asarray(codewords, np.uint64)
    fields = np.empty(words.shape, CODEWORD)

    def take(field: Field) -> npt.NDArray[np.uint64]:
        return (words >> np.uint64(field.lsb)) & np.uint64(field.mask)

    for name in ("mode", "diffuse", "specular", "material", "x", "z"):
        fields[name] = take(getattr(config, name))
    for row in range(ROWS):
        fields["first"][:, row] = take(config.first(row))
        fields["last"][:, row] = take(config.last(row))
    first, last, symmetric = fields["first"], fields["last"], fields["mode"] == 0
    empty = first > last
    fields["control"] = empty.all(axis=1) & ~symmetric
    half, middle = BLOCK // 2, ROWS - 1
    raised = symmetric & (first[:, middle] >= half) & (last[:, middle] < half)
    even = (first[:, middle] + last[:, middle]) % 2 == 0
    fields["raised"] = raised
    fields["shifted"] = np.where(raised, even, symmetric & empty[:, 0] & (first[:, 0] & 2 != 0))
    first[raised, middle], last[raised, middle] = last[raised, middle], first[raised, middle]
    fields["end"] = fields["control"] & (take(config.control_end) == 1)
    return fields


def block_rows(
    fields: npt.NDArray[Any],
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return the columns that elements cover on each row of their blocks.

    Parameters
    ----------
    fields
        Elements, from :func:`decode`: shape (n,).

    Returns
    -------
    first, last
        First and last column, inclusive: shape (n, 8). An empty row has first > last.
    """
    first, last = fields["first"].astype(np.int64), fields["last"].astype(np.int64)
    raised = fields["raised"][:, np.newaxis]
    right = BLOCK - 1 + fields["shifted"].astype(np.int64)[:, np.newaxis]
    rotated = (first <= last) & (fields["mode"] == 0)[:, np.newaxis]
    rotated[:, -1:] &= ~raised  # the middle row is its own half rotation
    lower_first = np.where(rotated, right - last, 1)
    lower_last = np.where(rotated, right - first, 0)

    def block(upper: npt.NDArray[np.int64], lower: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        below = lower[:, ::-1]
        below = np.where(raised, np.roll(below, -1, axis=1), below)
        return np.concatenate([upper, below], axis=1)

    return block(first, lower_first), block(last, lower_last)


def _initial_raster(frame: Frame, initial: Raster | None) -> Raster:
    """Return the raster that a frame starts from, in new arrays."""
    if initial is None:
        return Raster.background(frame.width, frame.height, frame.config)
    colour = np.where(initial.drawn[..., np.newaxis], initial.colour, 0)
    return Raster(initial.depth.astype(np.uint16), colour.astype(np.uint8), frame.config)


def _cut(
    starts: npt.NDArray[np.int64], width: int, height: int, bands: int
) -> npt.NDArray[np.int64]:
    """Return the first line of each band, and the height; bands have about the same work.

    The work of a band is the number of its code words, weighted, plus the number of its pixels.
    """
    lines = np.arange(height + 1)
    work = WORD_WORK * starts[: height + 1] + width * lines
    cuts = np.searchsorted(work, np.linspace(0, work[-1], bands + 1))
    return np.unique(np.concatenate([[0], cuts, [height]]))


def _check_image(frame: Frame) -> None:
    """Raise ``InputError`` if the image does not fit the engine."""
    config = frame.config
    fits = 1 <= frame.width <= config.max_width and 1 <= frame.height <= config.max_height
    if not fits:
        raise InputError(
            f"an image of {frame.width}x{frame.height} pixels does not fit the engine"
            f" {config.name!r}, which draws 1x1 to {config.max_width}x{config.max_height}"
        )


def _check_initial(initial: Raster, frame: Frame) -> None:
    """Raise ``ValueError`` unless the initial raster is one that the frame can start from."""
    config = frame.config
    if initial.config != config:
        raise ValueError("the initial raster has another configuration than the frame")
    if initial.depth.shape != (frame.height, frame.width):
        height, width = initial.depth.shape
        raise ValueError(
            f"the initial raster has {width}x{height} pixels,"
            f" the frame {frame.width}x{frame.height}"
        )
    if initial.depth.max() > config.background_depth or initial.colour.max() > config.channel_max:
        raise ValueError("the initial raster has a depth or a colour that no pixel holds")
