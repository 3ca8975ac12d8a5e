"""The compiled loops of the golden renderer: code words in, depths and colours out.

A pixel of the canvas holds the whole code word that drew it. The highest bits of a code word are
its depth, so the depth test is one comparison of code words. Colours are computed once a pixel, at
the end, from the code word that was nearest. A pixel that nothing was drawn into holds a control
word with the depth that it started from; no element is a control word.

The canvas has the eight lines that an element can reach. It moves down the image with the engine's
line. The image is cut into bands of lines, which are independent and are drawn in parallel.
Elements that touch both sides of a cut are drawn once for each band.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np
from numba.extending import intrinsic

from splatline.contract.config import BLOCK, ROWS, EngineConfig
from splatline.contract.presets import PAPER
from splatline.host.compiled_cache import cached_njit

__all__ = [
    "ABOVE", "BELOW", "CARRY_LSB", "LANES", "ROW_BITS", "Layout", "draw_bands", "filled_rows",
    "index_lines", "layout_of", "lowest_bit",
]  # fmt: skip

ABOVE = BLOCK // 2
"""Lines of an element's block that lie above the engine's current line."""

BELOW = BLOCK - 1 - ABOVE
"""Lines of the block below the current one."""

LANES = 4
"""Pixels that are tested together, in one vector register of the processor."""

# The rows have the same bit positions in every configuration, so these are compile-time constants.
# A row takes six bits: first and last column, three bits each. With one of the two masked out, each
# group of six bits holds a number of three bits and room for a carry.
ROW_BITS = PAPER.first(1).lsb - PAPER.first(0).lsb
FIRSTS_LSB = np.uint64(PAPER.first(0).lsb)
LASTS_LSB = np.uint64(PAPER.last(0).lsb)
COLUMN = np.uint64(PAPER.first(0).mask)
COLUMNS = np.uint64(sum(PAPER.first(0).mask << ROW_BITS * row for row in range(ROWS)))
CARRIES = np.uint64(sum((PAPER.first(0).mask + 1) << ROW_BITS * row for row in range(ROWS)))
CARRY_LSB = PAPER.first(0).width
MIDDLE_FIRST = np.uint64(PAPER.first(ROWS - 1).lsb)
MIDDLE_LAST = np.uint64(PAPER.last(ROWS - 1).lsb)
HALF = np.uint64(BLOCK // 2 - 1)

ONE = np.uint64(1)
MODE = np.uint64(1 << PAPER.mode.lsb)
UNTOUCHED = MODE | COLUMNS << FIRSTS_LSB
"""The lowest bits of an untouched pixel: a control word, with four rows from column 7 to 0."""


class Layout(NamedTuple):
    """The bit positions of a configuration's fields, for the compiled loops.

    Each field has its lowest bit and its mask, as unsigned integers of 64 bits. The tuple is flat,
    as numba's parallel loops require.
    """

    diffuse_lsb: np.uint64
    diffuse_mask: np.uint64
    specular_lsb: np.uint64
    specular_mask: np.uint64
    material_lsb: np.uint64
    material_mask: np.uint64
    x_lsb: np.uint64
    x_mask: np.uint64
    z_lsb: np.uint64
    z_mask: np.uint64
    end_lsb: np.uint64
    colour_shift: int
    channel_max: int


def layout_of(config: EngineConfig) -> Layout:
    """Return the layout of a configuration's code words."""
    positions: dict[str, Any] = {}
    for name in ("diffuse", "specular", "material", "x", "z"):
        field = getattr(config, name)
        positions[f"{name}_lsb"] = np.uint64(field.lsb)
        positions[f"{name}_mask"] = np.uint64(field.mask)
    return Layout(
        **positions,
        end_lsb=np.uint64(config.control_end.lsb),
        colour_shift=config.colour_shift,
        channel_max=config.channel_max,
    )


@cached_njit()
def index_lines(words: Any, lines: int, layout: Layout) -> Any:
    """Find the code words of each line of the image.

    Parameters
    ----------
    words
        Code words: shape (n,), uint64.
    lines
        Number of lines: 0 .. ``lines - 1``.
    layout
        Bit positions of the fields.

    Returns
    -------
    starts
        Shape (lines + 1,), int64. The elements whose line is y are among
        ``words[starts[y] : starts[y + 1]]``, with control words between them.
    ended
        Whether there is an end-of-frame word.
    """
    starts = np.zeros(lines + 1, np.int64)
    y: Any = 0
    for index, word in enumerate(words):
        if not _is_control(word):
            continue
        if word >> layout.end_lsb & ONE:
            starts[y + 1 :] = index
            return starts, True
        # Limited to ``lines``, so that y cannot overflow whatever the stream adds to it.
        below = min(y + np.int64(_field(word, layout.x_lsb, layout.x_mask)), lines)
        starts[y + 1 : below + 1] = index
        y = below
    return starts, False


@cached_njit(parallel=True)
def draw_bands(
    words: Any,
    starts: Any,
    cuts: Any,
    ambient: Any,
    coefficients: Any,
    layout: Layout,
    depth: Any,
    colour: Any,
) -> None:
    """Draw a frame, its bands in parallel.

    Parameters
    ----------
    words
        Code words: shape (n,), uint64.
    starts
        From ``index_lines``, for ``height + 4`` lines.
    cuts
        First line of each band, and the image's height: shape (bands + 1,), int64, rising from 0.
    ambient
        I0 of each channel: shape (3,), int64.
    coefficients
        kd and ks of each material and channel: shape (materials, 2, 3), int64.
    layout
        Bit positions of the fields.
    depth
        Shape (height, width), uint16: the initial depth, which the picture's depth replaces.
    colour
        Shape (height, width, 3), uint8: likewise.
    """
    width = depth.shape[1]
    for band in nb.prange(len(cuts) - 1):
        begin, end = cuts[band], cuts[band + 1]
        # A block may reach beyond the right border, and the vector of pixels tested beyond it.
        canvas = np.zeros((BLOCK, width + 2 * BLOCK), np.uint64)
        for y in range(begin - BELOW, end + ABOVE):
            if y + BELOW < end:
                _open_line(canvas, y + BELOW, layout, depth)
            if y >= 0:
                _draw_line(words, starts, canvas, y, width, layout)
            if y - ABOVE >= begin:
                _close_line(canvas, y - ABOVE, ambient, coefficients, layout, depth, colour)


@cached_njit()
def _open_line(canvas: Any, line: int, layout: Layout, depth: Any) -> None:
    """Fill a line of the canvas with untouched pixels."""
    pixels = canvas[line % BLOCK]
    for column in range(depth.shape[1]):
        stored = np.uint64(depth[line, column])
        pixels[column] = UNTOUCHED | stored << layout.z_lsb


@cached_njit()
def _draw_line(words: Any, starts: Any, canvas: Any, y: int, width: int, layout: Layout) -> None:
    """Draw the elements of one line into the canvas."""
    pixels = canvas.reshape(-1)
    stride = canvas.shape[1]
    below_z = (ONE << layout.z_lsb) - ONE
    for index in range(starts[y], starts[y + 1]):
        word = words[index]
        x = np.int64(_field(word, layout.x_lsb, layout.x_mask))
        if x >= width:
            continue
        # All bits below the depth are ones: the key is less than a code word only if its depth is.
        key = word | below_z
        symmetric = word & MODE == 0
        shape, raised, shifted = _middle(word) if symmetric else (word, 0, 0)
        rows = filled_rows(shape)  # none in a control word
        while rows:
            carry = lowest_bit(rows)
            rows &= rows - ONE
            row = carry // ROW_BITS
            lsb = np.uint64(carry - CARRY_LSB)
            first = np.int64(shape >> (lsb + FIRSTS_LSB) & COLUMN)
            last = np.int64(shape >> (lsb + LASTS_LSB) & COLUMN)
            count = last - first + 1
            start = (y - ABOVE + row) % BLOCK * stride + x + first
            _draw_row(pixels, start, count, key, word)
            # The row's half rotation. The middle row of a raised shape is its own half rotation.
            if symmetric and not (raised and row == ROWS - 1):
                below = (y + BELOW - raised - row) % BLOCK * stride
                _draw_row(pixels, below + x + BLOCK - 1 + shifted - last, count, key, word)


@cached_njit(inline="always")
def _middle(word: int) -> Any:
    """Return a symmetric word, and the lines and columns by which its middle lies off.

    That is, what is turned lies so many lines higher and columns further right, 0 or 1. The word
    has its row 3 from left to right.
    """
    first, last = word >> MIDDLE_FIRST & COLUMN, word >> MIDDLE_LAST & COLUMN
    if first > HALF and last <= HALF:
        ends = (COLUMN << MIDDLE_FIRST) | (COLUMN << MIDDLE_LAST)
        ordered = (word & ~ends) | last << MIDDLE_FIRST | first << MIDDLE_LAST
        return ordered, 1, 1 - np.int64((first ^ last) & ONE)
    first, last = word >> FIRSTS_LSB & COLUMN, word >> LASTS_LSB & COLUMN
    return word, 0, np.int64(first > last) & np.int64(first >> ONE & ONE)


@cached_njit(inline="always")
def _draw_row(pixels: Any, start: int, count: int, key: int, word: int) -> None:
    """Draw ``count`` pixels of a line: the nearest stays, and of equal depths the first drawn."""
    for offset in range(0, count, LANES):
        # Pixels past the row are written back unchanged, which avoids branches.
        for lane in range(LANES):
            old = pixels[start + offset + lane]
            passes = (key < old) & (offset + lane < count)
            pixels[start + offset + lane] = word if passes else old


@cached_njit()
def _close_line(
    canvas: Any,
    line: int,
    ambient: Any,
    coefficients: Any,
    layout: Layout,
    depth: Any,
    colour: Any,
) -> None:
    """Compute depth and colour of a line's pixels from the code words that they hold.

    Int64 holds every sum: I0 < 2^(c + i + 1) and each product < 2^(c + i), with c <= 12 bits of a
    coefficient and i <= 9 bits of an intensity. A sum is therefore less than
    4 * 2^(c + i) <= 2^23.
    """
    pixels = canvas[line % BLOCK]
    for column in range(depth.shape[1]):
        word = pixels[column]
        if _is_control(word):
            continue
        depth[line, column] = _field(word, layout.z_lsb, layout.z_mask)
        material = _field(word, layout.material_lsb, layout.material_mask)
        d = np.int64(_field(word, layout.diffuse_lsb, layout.diffuse_mask))
        s = np.int64(_field(word, layout.specular_lsb, layout.specular_mask))
        for channel in range(3):
            kd, ks = coefficients[material, 0, channel], coefficients[material, 1, channel]
            total = ambient[channel] + kd * d + ks * s
            level = total >> layout.colour_shift
            colour[line, column, channel] = min(level, layout.channel_max)


@cached_njit(inline="always")
def _field(word: int, lsb: int, mask: int) -> Any:
    """Return the value of a field."""
    return word >> lsb & mask


@cached_njit(inline="always")
def _is_control(word: int) -> Any:
    """Return whether a code word is a control word."""
    return (word & MODE != 0) & (filled_rows(word) == 0)


@cached_njit(inline="always")
def filled_rows(word: int) -> Any:
    """Return a bit for each row, at ``CARRY_LSB + ROW_BITS * row``, set if the row is not empty.

    One subtraction handles all four rows. A row's carry bit stays set where first <= last.
    """
    firsts = word >> FIRSTS_LSB & COLUMNS
    lasts = word >> LASTS_LSB & COLUMNS
    return ((lasts | CARRIES) - firsts) & CARRIES


@intrinsic
def lowest_bit(typing: Any, number: Any) -> Any:
    """Return the position of the lowest set bit of a number, by the processor's instruction."""

    def build(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.cttz(arguments[0], context.get_constant(nb.types.boolean, True))

    return nb.types.int64(number), build
