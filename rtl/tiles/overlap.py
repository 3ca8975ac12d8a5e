"""Overlap of two tiles: the hazard of the lanes."""

from amaranth.hdl import Mux, Signal

__all__ = ["overlap"]


def overlap(m, tile, before):
    """Return whether two tiles overlap: whether they share a pixel of the image.

    Their masks are not compared: they come too late, and would avoid few stalls.

    Parameters
    ----------
    m
        The module that gets the logic.
    tile, before
        The tiles, views of :class:`TileLayout` or :class:`PlaneTileLayout`.
    """
    same = Signal()
    after = Signal()
    ahead = Signal()
    m.d.comb += [
        same.eq(tile.words[0] == before.words[0]),
        after.eq(tile.words[1] == before.words[0]),
        ahead.eq(tile.words[0] == before.words[1]),
    ]
    lines = Signal(len(tile.group))
    columns = Signal(len(tile.next))
    for i in range(len(lines)):
        m.d.comb += lines[i].eq(tile.group[i] == before.group[i])
    for j in range(len(columns)):
        new, old = tile.next[j], before.next[j]
        m.d.comb += columns[j].eq(Mux(new == old, same, Mux(new, after, ahead)))
    return lines.any() & columns.any()
