"""The golden renderer: ``docs/contract.md`` as a program, and the judge of the hardware.

It is written from the contract and ``rtl/format.py`` alone and shares nothing else with the
hardware. ``_draw`` is the engine; what stands around it checks the frame and turns its tables and
images into arrays.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba
import numpy as np
import numpy.typing as npt

from ..host.errors import InputError
from ..host.frame import Frame, Tables
from ..rtl.format import BLOCK, PAPER, ROWS, EngineConfig, Field
from .raster import Raster

__all__ = ["decode", "render"]

ABOVE = BLOCK // 2
"""Lines of an element's block that lie above the engine's current line."""

# The scans have the same place in every configuration, so that the compiler may know it.
FIRST = tuple(PAPER.first(row).lsb for row in range(ROWS))
LAST = tuple(PAPER.last(row).lsb for row in range(ROWS))
COLUMN_MASK = PAPER.first(0).mask


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
        ("control", np.bool_),
        ("end", np.bool_),
    ]
)
"""A code word, taken apart."""


class Positions(NamedTuple):
    """The configuration as ``_draw`` needs it: lowest bit and mask of each field, and widths."""

    mode: tuple[int, int]
    diffuse: tuple[int, int]
    specular: tuple[int, int]
    material: tuple[int, int]
    x: tuple[int, int]
    z: tuple[int, int]
    control_end: tuple[int, int]
    colour_shift: int
    channel_bits: int
    channel_max: int


def render(frame: Frame, initial: Raster | None = None) -> Raster:
    """Draw a frame, exact to the bit.

    Parameters
    ----------
    frame
        Code words, tables and the size of the image. Any 64 bits are a code word; those after the
        end-of-frame word are not part of the frame and are ignored.
    initial
        The raster to start from, as the engine before in a chain has left it; nothing but
        background if not given. It is not changed.

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
        If the initial raster has another size or configuration than the frame, a value that no
        pixel holds, or a colour at background depth.
    """
    config = frame.config
    _check_image(frame)
    _check_tables(frame.tables, config)
    if initial is not None:
        _check_initial(initial, frame)

    # A canvas with a margin into which every block fits that reaches over a border, so that nothing
    # is clipped while drawing. The image is cut out of it afterwards.
    canvas = (frame.height + ABOVE + BLOCK - 1, config.max_width + BLOCK - 1)
    image = (slice(ABOVE, ABOVE + frame.height), slice(frame.width))
    depth = np.full(canvas, config.background_depth, np.uint16)
    colour = np.zeros(canvas, np.uint32)
    if initial is not None:
        depth[image] = initial.depth
        colour[image] = initial.colour_words

    ended = _draw(
        # Signed, since numba turns a mixture of uint64 and int64 into float64. The fields come out
        # the same: each is masked after its shift.
        np.ascontiguousarray(frame.codewords, np.uint64).view(np.int64),
        np.ascontiguousarray(frame.tables.ambient, np.int64),
        np.ascontiguousarray(frame.tables.diffuse, np.int64),
        np.ascontiguousarray(frame.tables.specular, np.int64),
        _positions(config),
        depth,
        colour,
    )
    if not ended:
        raise InputError("the code words have no end-of-frame word: the stream is cut short")
    return Raster.from_words(depth[image], colour[image], config)


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
        ``first`` and ``last`` (four rows each), ``diffuse``, ``specular``, ``material``, ``x``,
        ``z``; and as bool ``control`` (a control word) and ``end`` (that ends the frame).
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
    empty = (fields["first"] > fields["last"]).all(axis=1)
    fields["control"] = empty & (fields["mode"] == 1)
    fields["end"] = fields["control"] & (take(config.control_end) == 1)
    return fields


@numba.njit(cache=True)
def _draw(
    words: Any, ambient: Any, diffuse: Any, specular: Any, at: Positions, depth: Any, colour: Any
) -> bool:
    """Draw code words into a canvas, and return whether there was an end of frame.

    Canvas line i is image line ``i - ABOVE``: row 0 of a block at line y lies on canvas line y.
    """
    lines = len(depth)
    y = 0
    for word in words:
        fraction = _field(word, at.mode) == 1
        x = _field(word, at.x)

        if fraction and _is_empty(word):
            if _field(word, at.control_end) == 1:
                return True
            y += x
            continue
        if y + BLOCK > lines:  # the whole block lies below the image
            continue

        z = _field(word, at.z)
        material = _field(word, at.material)
        d = _field(word, at.diffuse)
        s = _field(word, at.specular)
        element = 0
        for channel in range(3):
            product = diffuse[material, channel] * d + specular[material, channel] * s
            level = min((ambient[channel] + product) >> at.colour_shift, at.channel_max)
            element |= level << (at.channel_bits * channel)

        for row in range(ROWS):
            first = _column(word, FIRST[row])
            last = _column(word, LAST[row])
            _draw_row(depth, colour, y + row, x + first, x + last, z, element)
            if not fraction:  # the row turned by 180 degrees
                below = y + BLOCK - 1 - row
                left, right = x + BLOCK - 1 - last, x + BLOCK - 1 - first
                _draw_row(depth, colour, below, left, right, z, element)
    return False


@numba.njit(cache=True, inline="always")
def _draw_row(
    depth: Any, colour: Any, line: int, left: int, right: int, z: int, element: int
) -> None:
    """Draw ``left .. right`` of a line, nothing if ``left > right``; what is nearer stays."""
    for column in range(left, right + 1):
        if z < depth[line, column]:
            depth[line, column] = z
            colour[line, column] = element


@numba.njit(cache=True, inline="always")
def _field(word: int, position: tuple[int, int]) -> int:
    lsb, mask = position
    return (word >> lsb) & mask


@numba.njit(cache=True, inline="always")
def _column(word: int, lsb: int) -> int:
    return (word >> lsb) & COLUMN_MASK


@numba.njit(cache=True, inline="always")
def _is_empty(word: int) -> bool:
    """Return whether all rows are empty."""
    empty = True
    for row in range(ROWS):
        empty &= _column(word, FIRST[row]) > _column(word, LAST[row])
    return empty


def _positions(config: EngineConfig) -> Positions:
    def place(field: Field) -> tuple[int, int]:
        return field.lsb, field.mask

    return Positions(
        mode=place(config.mode),
        diffuse=place(config.diffuse),
        specular=place(config.specular),
        material=place(config.material),
        x=place(config.x),
        z=place(config.z),
        control_end=place(config.control_end),
        colour_shift=config.colour_shift,
        channel_bits=config.channel_bits,
        channel_max=config.channel_max,
    )


def _check_image(frame: Frame) -> None:
    config = frame.config
    fits = 1 <= frame.width <= config.max_width and 1 <= frame.height <= config.max_height
    if not fits:
        raise InputError(
            f"an image of {frame.width}x{frame.height} pixels does not fit the engine"
            f" {config.name!r}, which draws 1x1 to {config.max_width}x{config.max_height}"
        )


def _check_tables(tables: Tables, config: EngineConfig) -> None:
    coefficients = ((1 << config.material_bits, 3), config.coefficient_bits)
    for name, table, (shape, bits) in (
        ("ambient", tables.ambient, ((3,), config.ambient_bits)),
        ("diffuse", tables.diffuse, coefficients),
        ("specular", tables.specular, coefficients),
    ):
        if table.shape != shape:
            raise InputError(f"the table {name!r} must have the shape {shape}, not {table.shape}")
        if table.min() < 0 or table.max() >> bits:
            raise InputError(f"the table {name!r} has values that do not fit {bits} bits")


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
