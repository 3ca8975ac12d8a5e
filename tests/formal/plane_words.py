"""Plane words by the contract's text: the pixels of an element, and the depth of each."""

from amaranth.hdl import Mux, Signal, signed

from splatline.contract.config import BLOCK, ROWS
from splatline.contract.plane import SUM_FRACTION, Z_FRACTION
from splatline.rtl.layouts import sum_bits

__all__ = ["give_plane", "plane_covers", "plane_sum", "saturated"]


def plane_covers(element, row, column):
    """Return whether an element has a pixel in a row of its block and a column of the image.

    Rows 0..3 as given; row 7 - k is row k rotated, or row 6 - k if raised, for k = 0..2. Each end
    of a rotated row may be moved by a column, and stays in the block.
    """
    symmetric = element.mode == 0
    found = 0
    for k, scan in enumerate(element.scans):
        first_moves, last_moves = element.sides[2 * k], element.sides[2 * k + 1]
        first = BLOCK - 1 - scan.last + Mux(first_moves, Mux(element.outwards[0], -1, 1), 0)
        last = BLOCK - 1 - scan.first + Mux(last_moves, Mux(element.outwards[1], 1, -1), 0)
        rotated = _inside(first, last, column - element.x)
        line = Mux(element.raised, BLOCK - 2 - k, BLOCK - 1 - k)
        own = symmetric & (row == line) & (scan.first <= scan.last)
        if k == ROWS - 1:
            own &= ~element.raised
        given = (scan.first <= column - element.x) & (column - element.x <= scan.last)
        found = found | ((row == k) & given) | (own & rotated)
    return found & ~element.end


def _inside(first, last, column):
    """Return whether a column is one of a row whose ends are first moved into the block."""
    most = BLOCK - 1
    return (Mux(first < 0, 0, Mux(first > most, most, first)) <= column) & (
        column <= Mux(last < 0, 0, Mux(last > most, most, last))
    )


def plane_sum(m, config, element, row, column):
    """Return 2 Z + c a + r b, in quarters of a level, of the pixel in a row and a column."""
    total = Signal(signed(sum_bits(config) + 3), name="contract_sum")
    across = (column - element.x)[: BLOCK.bit_length() - 1]
    down = row[: BLOCK.bit_length() - 1]
    m.d.comb += total.eq(
        (element.z << SUM_FRACTION - Z_FRACTION)
        + element.plane.across * across
        + element.plane.down * down
    )
    return total


def saturated(config, total):
    """Return the depth of a sum: its level, at least 0 and at most the background's depth."""
    level, furthest = total >> SUM_FRACTION, config.background_depth
    return Mux(level < 0, 0, Mux(level > furthest, furthest, level))


def give_plane(m, config, element):
    """Give an element a plane of which each pixel of the block has a part of its own, c - 8 r.

    With any slopes ABC comes to no end, as the products are made in two ways. The changes from the
    word and the line before are what ``colour_plane_proof`` shows.
    """
    plane = element.plane
    m.d.comb += [
        plane.across.eq(1),
        plane.down.eq(-BLOCK),
        plane.before.eq(plane.across * element.x[: config.pixel_bits]),
        plane.above.eq(plane.down * element.top[:2]),
    ]
