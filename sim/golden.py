"""The golden renderer: what an engine draws, to the bit.

This file is the contract (``docs/contract.md``) made code, and the specification that the hardware is
held to. It shares nothing with the hardware but the bit positions of :mod:`splatline.rtl.format`.
"""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from ..host.errors import InputError
from ..host.frame import Frame, Tables
from ..rtl.format import BLOCK, ROWS, EngineConfig
from .raster import Raster

__all__ = ["decode", "render"]

ABOVE = ROWS
"""Lines of the block above the engine's current line."""


def render(frame: Frame, initial: Raster | None = None) -> Raster:
    """Draw a frame.

    Parameters
    ----------
    frame
        Code words, tables and size of the image. Words after the first end word are not drawn.
    initial
        The picture that the frame starts from, of the frame's size; background if not given.

    Returns
    -------
    Raster
        Depth and colour of every pixel.

    Raises
    ------
    InputError
        If the code words have no end word.
    ValueError
        If the initial picture has another size or configuration.
    """
    config = frame.config
    if initial is None:
        initial = Raster.background(frame.width, frame.height, config)
    elif initial.depth.shape != (frame.height, frame.width) or initial.config != config:
        raise ValueError("the initial raster differs from the frame in size or configuration")

    # Around the image stands a margin as wide as a block, so that clipping needs no test: what
    # falls outside is drawn into the margin and cut away at the end. A pixel is one integer,
    # depth above colour.
    depth_lsb = config.colour_bits
    kind = np.uint32 if config.depth_bits + config.colour_bits <= 32 else np.uint64
    canvas = np.zeros((frame.height + 2 * BLOCK, frame.width + BLOCK), kind)
    image = canvas[BLOCK : BLOCK + frame.height, : frame.width]
    image[:] = initial.depth.astype(kind) << kind(depth_lsb)
    image |= pack_colour(initial.colour, config).astype(kind)
    ended = _draw(
        canvas,
        frame.width,
        frame.height,
        frame.codewords,
        _positions(config),
        _rate_tables(frame.tables),
        config.colour_shift,
        config.channel_bits,
    )
    if not ended:
        raise InputError("the code words have no end-of-frame word; the stream is cut short")

    depth = (image >> kind(depth_lsb)).astype(np.uint16)
    return Raster(depth, unpack_colour(image.astype(np.uint32), config), config)


def decode(codewords: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[np.void]:
    """Return the fields of code words by name.

    Parameters
    ----------
    codewords
        Shape (n,), uint64.
    config
        Where the fields are.

    Returns
    -------
    numpy.ndarray
        Structured, shape (n,): ``mode``, ``first`` and ``last`` (four rows each), ``diffuse``,
        ``specular``, ``material``, ``x``, ``z`` (all int64), and ``control``, ``end`` (bool).
    """
    scalars = ("mode", "diffuse", "specular", "material", "x", "z")
    rows: list[tuple[Any, ...]] = [(name, np.int64, ROWS) for name in ("first", "last")]
    kinds = [*((name, np.int64) for name in scalars), *rows, ("control", bool), ("end", bool)]
    words = np.asarray(codewords, np.uint64)
    fields = np.zeros(len(words), kinds)

    def get(field: Any) -> npt.NDArray[np.int64]:
        return (words >> np.uint64(field.lsb) & np.uint64(field.mask)).astype(np.int64)

    for name in scalars:
        fields[name] = get(getattr(config, name))
    for row in range(ROWS):
        fields["first"][:, row] = get(config.first(row))
        fields["last"][:, row] = get(config.last(row))
    empty = (fields["first"] > fields["last"]).all(axis=1)
    fields["control"] = (fields["mode"] == 1) & empty
    fields["end"] = fields["control"] & (get(config.control_end) == 1)
    return fields


def pack_colour(
    colour: npt.NDArray[np.uint8], config: EngineConfig
) -> npt.NDArray[np.uint32]:
    """Return stored colours, red lowest, of levels of shape (..., 3)."""
    wide = colour.astype(np.uint32)
    bits = np.uint32(config.channel_bits)
    packed: npt.NDArray[np.uint32] = (
        wide[..., 0] | wide[..., 1] << bits | wide[..., 2] << (bits + bits)
    )
    return packed


def unpack_colour(
    packed: npt.NDArray[np.uint32], config: EngineConfig
) -> npt.NDArray[np.uint8]:
    """Return levels of shape (..., 3) of stored colours; bits above them are ignored."""
    shifts = np.arange(3, dtype=np.uint32) * np.uint32(config.channel_bits)
    levels = packed[..., np.newaxis] >> shifts & np.uint32(config.channel_max)
    return levels.astype(np.uint8)


def _positions(config: EngineConfig) -> npt.NDArray[np.int64]:
    """Return (lsb, mask) of the fields, in the order that :func:`_draw` unpacks them."""
    fields = (
        config.mode,
        config.diffuse,
        config.specular,
        config.material,
        config.x,
        config.z,
        config.control_end,
    )
    return np.array([(field.lsb, field.mask) for field in fields], np.int64)


def _rate_tables(tables: Tables) -> npt.NDArray[np.int64]:
    """Return I0, kd and ks as one table: shape (materials, 3, 3), by material, channel, term."""
    ambient = np.broadcast_to(tables.ambient, tables.diffuse.shape)
    return np.ascontiguousarray(
        np.stack([ambient, tables.diffuse, tables.specular], axis=-1), np.int64
    )


@nb.njit(cache=True, nogil=True)
def _draw(
    canvas: Any,
    width: int,
    height: int,
    codewords: Any,
    positions: Any,
    rates: Any,
    colour_shift: int,
    channel_bits: int,
) -> bool:
    """Draw code words into a canvas with margins; return whether the end word came."""
    mode_lsb, mode_mask = positions[0]
    diffuse_lsb, diffuse_mask = positions[1]
    specular_lsb, specular_mask = positions[2]
    material_lsb, material_mask = positions[3]
    x_lsb, x_mask = positions[4]
    z_lsb, z_mask = positions[5]
    end_lsb, _ = positions[6]
    largest = (1 << channel_bits) - 1
    line = 0
    for codeword in codewords:
        word = np.int64(codeword)
        mode = word >> mode_lsb & mode_mask
        scans = word >> 1
        x = word >> x_lsb & x_mask
        if mode == 1 and _all_empty(scans):
            if word >> end_lsb & 1:
                return True
            line += x
            continue
        if x >= width or line >= height + ABOVE:
            continue

        diffuse = word >> diffuse_lsb & diffuse_mask
        specular = word >> specular_lsb & specular_mask
        material = word >> material_lsb & material_mask
        colour = 0
        for channel in range(3):
            ambient, kd, ks = rates[material, channel]
            level = ambient + kd * diffuse + ks * specular >> colour_shift
            colour |= min(level, largest) << channel * channel_bits

        z = word >> z_lsb & z_mask
        pixel = canvas.dtype.type(z << 3 * channel_bits | colour)
        behind = canvas.dtype.type(z + 1 << 3 * channel_bits)  # the least value that is further
        top = line - ABOVE + BLOCK  # of the block, on the canvas
        for row in range(ROWS):
            first = scans >> 6 * row & 7
            last = scans >> 6 * row + 3 & 7
            if first <= last:
                _draw_row(canvas[top + row], x, first, last, pixel, behind)
                if mode == 0:
                    turned = canvas[top + BLOCK - 1 - row]
                    _draw_row(turned, x, 7 - last, 7 - first, pixel, behind)
    return False


@nb.njit(inline="always")
def _all_empty(scans: int) -> bool:
    """Return whether all four rows are empty."""
    for row in range(ROWS):
        if scans >> 6 * row & 7 <= scans >> 6 * row + 3 & 7:
            return False
    return True


@nb.njit(inline="always")
def _draw_row(line: Any, x: int, first: int, last: int, pixel: Any, behind: Any) -> None:
    """Depth-test and write columns ``x + first .. x + last`` of a line.

    All eight columns are visited, without a branch, which compiles to a few vector instructions.
    """
    for column in range(BLOCK):
        stored = line[x + column]
        drawn = (column >= first) & (column <= last) & (stored >= behind)
        line[x + column] = pixel if drawn else stored
