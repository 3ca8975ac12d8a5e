"""Parts of both flush scans: dirty bits, lines and the frame overlap."""

from amaranth.hdl import Cat, Const, Mux

__all__ = ["connect_dirty_bits", "connect_frame_overlap", "mark_lines"]

WRITES = ("drawing", "touch", "group", "words", "load", "load_word", "lone")
"""Members that say which words are written. Tiles have no ``drawing``: it is in ``touch``."""


def connect_dirty_bits(m, scan, dirty_bits, take, place, stretch):
    """Pass the written words to the dirty bits, and the slot and the stretch to take."""
    residue_bits = len(place) - scan.config.group_bits
    group = scan.wipe_row[len(stretch) :]
    m.d.comb += dirty_bits.take.eq(take | scan.wipe)
    if "wipe" in dirty_bits.signature.members:  # blocks look at all residues
        m.d.comb += dirty_bits.wipe.eq(scan.wipe)
    m.d.comb += [
        dirty_bits.line.eq(Mux(scan.wipe, Cat(Const(0, residue_bits), group), place)),
        dirty_bits.stretch.eq(Mux(scan.wipe, scan.wipe_row[: len(stretch)], stretch)),
    ]
    for name in WRITES:
        if name in scan.signature.members:
            m.d.comb += getattr(dirty_bits, name).eq(getattr(scan, name))


def connect_frame_overlap(m, scan, frame_overlap, line, leaves, wraps, clean):
    """Tell the frame overlap what leaves; give the window's first line of the frame drawn."""
    m.d.comb += [
        frame_overlap.oldest.eq(scan.oldest),
        frame_overlap.line.eq(line),
        frame_overlap.leaves.eq(leaves),
        frame_overlap.wraps.eq(wraps),
        frame_overlap.clean.eq(clean),
        frame_overlap.close.eq(scan.close),
        frame_overlap.restart.eq(scan.restart),
        scan.front.eq(frame_overlap.front),
        scan.closing.eq(frame_overlap.closing),
    ]


def mark_lines(m, scan, written, left, place, is_written):
    """Set the bit of each line that is written, and clear that of the line that leaves.

    ``is_written`` is a function of a line's residue.
    """
    for slot in range(scan.config.window_lines):
        group, residue = divmod(slot, scan.config.tile_lines)
        touched = is_written(residue) & (scan.group[residue] == group)
        gone = left & (place == slot)
        m.d.sync += written[slot].eq(~gone & (written[slot] | touched))
