"""The golden renderer: ``docs/contract.md`` as a program, and the judge of the hardware.

It is written from the contract and ``contract/config.py`` alone and shares nothing else with the
hardware. What draws is in ``golden_draw.py``; here the frame is checked and its tables are turned
into arrays.
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
from splatline.contract.frame import Frame, check_tables
from splatline.contract.presets import PAPER
from splatline.contract.raster import Raster

from .compact_words import expand_frame
from .kernel import ABOVE, draw_bands, index_lines, layout_of

__all__ = ["block_rows", "decode", "render", "render_parts"]

WORD_WORK = 4
"""How much more work a code word is than a pixel of the image, about."""


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
"""A code word, taken apart."""


def render(frame: Frame, initial: Raster | None = None, *, bands: int | None = None) -> Raster:
    """Draw a frame, exact to the bit.

    Parameters
    ----------
    frame
        Code words, tables and the size of the image. Any 64 bits are a code word; those after the
        end-of-frame word are not part of the frame and are ignored. Compact words are expanded
        first (:mod:`splatline.sim.golden.compact_words`).
    initial
        The raster to start from, as the engine before in a chain has left it; nothing but
        background if not given. It is not changed.
    bands
        Bands of lines to draw in parallel, at least 1; as many as numba has threads if not given.
        The picture is the same with any number.

    Returns
    -------
    Raster
        Depth and colour of every pixel, in new arrays.

    Raises
    ------
    InputError
        If there is no end-of-frame word, the image does not fit the engine, or the tables have
        another shape or larger values than the engine's.
    ValueError
        If ``bands`` is below 1, or the initial raster has another size or configuration than the
        frame, a value that no pixel holds, or a colour at background depth.
    """
    config = frame.config
    if bands is None:
        bands = numba.get_num_threads()
    if bands < 1:
        raise ValueError(f"the image is drawn in at least one band of lines, not {bands}")
    _check_image(frame)
    check_tables(frame.tables, config)
    if initial is not None:
        _check_initial(initial, frame)

    layout = layout_of(config)
    words = np.ascontiguousarray(expand_frame(frame).codewords, np.uint64)
    starts, ended = index_lines(words, frame.height + ABOVE, layout)
    if not ended:
        raise InputError("the code words have no end-of-frame word: the stream is cut short")

    raster = _start(frame, initial)
    tables = frame.tables
    draw_bands(
        words,
        starts,
        _cut(starts, frame.width, frame.height, bands),
        np.ascontiguousarray(tables.ambient, np.int64),
        np.stack([tables.diffuse, tables.specular], axis=1).astype(np.int64, copy=False),
        layout,
        raster.depth,
        raster.colour,
    )
    return raster


def render_parts(parts: Sequence[Frame], initial: Raster | None = None) -> Raster:
    """Draw parts of a picture one over the other, the first one first: what a chain draws.

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
    """Take code words apart.

    Parameters
    ----------
    codewords
        Shape (n,), uint64.
    config
        The engine that they are made for.

    Returns
    -------
    numpy.ndarray
        Shape (n,), with the named fields of ``docs/contract.md`` as unsigned integers: ``mode``,
        ``first`` and ``last`` (four rows each, a raised shape's middle one in order),
        ``diffuse``, ``specular``, ``material``, ``x``, ``z``; and as bool ``raised`` and
        ``shifted`` (where the middle of a symmetric word lies), ``control`` (a control word) and
        ``end`` (that ends the frame).
    """
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
    """Return the pixels of elements' blocks, row by row.

    Parameters
    ----------
    fields
        Elements, from :func:`decode`: shape (n,).

    Returns
    -------
    first, last
        Columns, inclusive: shape (n, 8). A row that is empty has its first behind its last.
    """
    first, last = fields["first"].astype(np.int64), fields["last"].astype(np.int64)
    raised = fields["raised"][:, np.newaxis]
    right = BLOCK - 1 + fields["shifted"].astype(np.int64)[:, np.newaxis]
    turned = (first <= last) & (fields["mode"] == 0)[:, np.newaxis]
    turned[:, -1:] &= ~raised  # it is in the middle, and its own half turn
    lower_first, lower_last = np.where(turned, right - last, 1), np.where(turned, right - first, 0)

    def block(upper: npt.NDArray[np.int64], lower: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        below = lower[:, ::-1]
        below = np.where(raised, np.roll(below, -1, axis=1), below)
        return np.concatenate([upper, below], axis=1)

    return block(first, lower_first), block(last, lower_last)


def _start(frame: Frame, initial: Raster | None) -> Raster:
    """Return the raster that a frame starts from, in new arrays."""
    if initial is None:
        return Raster.background(frame.width, frame.height, frame.config)
    return Raster(initial.depth.astype(np.uint16), initial.colour.astype(np.uint8), frame.config)


def _cut(
    starts: npt.NDArray[np.int64], width: int, height: int, bands: int
) -> npt.NDArray[np.int64]:
    """Cut an image into bands of about the same work; return the lines of the cuts, 0 and the last.

    The work is that of the words and that of the pixels.
    """
    lines = np.arange(height + 1)
    work = WORD_WORK * starts[: height + 1] + width * lines
    cuts = np.searchsorted(work, np.linspace(0, work[-1], bands + 1))
    return np.unique(np.concatenate([[0], cuts, [height]]))


def _check_image(frame: Frame) -> None:
    config = frame.config
    fits = 1 <= frame.width <= config.max_width and 1 <= frame.height <= config.max_height
    if not fits:
        raise InputError(
            f"an image of {frame.width}x{frame.height} pixels does not fit the engine"
            f" {config.name!r}, which draws 1x1 to {config.max_width}x{config.max_height}"
        )


def _check_initial(initial: Raster, frame: Frame) -> None:
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
    if initial.colour[~initial.drawn].any():
        raise ValueError("the initial raster has a colour where it has background")
