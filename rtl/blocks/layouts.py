"""Layouts between the tiler and the window of the blocks engine."""

from amaranth.hdl import signed
from amaranth.lib import data

from splatline.contract.config import BLOCK, EngineConfig

__all__ = ["BlockLayout", "ClearedLayout"]


class BlockLayout(data.StructLayout):
    """A block: the pixels of an element, by residue of line and column.

    ``mask[q][p]``: the pixel on the line with residue q modulo 8, in the column with residue p, is
    drawn. ``odd[q][p]``: it lies in an odd word of its line. ``group[q]``: slot of the line,
    without the three lowest bits. ``words``: the two words that the block's columns lie in.
    ``touch[q]``: pixels of an odd word are drawn on the line, and of an even one. ``rows[q]``: any
    pixel is. ``mode``: only the first four lines have pixels. ``end`` and ``top`` as in
    :class:`TileLayout`.
    """

    def __init__(self, config: EngineConfig):
        row = config.pixels_per_word
        super().__init__(
            {
                "mask": data.ArrayLayout(row, BLOCK),
                "odd": data.ArrayLayout(row, BLOCK),
                "touch": data.ArrayLayout(2, BLOCK),
                "rows": BLOCK,
                "group": data.ArrayLayout(config.group_bits, BLOCK),
                "words": data.ArrayLayout(config.word_bits, 2),
                "z": config.z.width,
                "mode": config.mode.width,
                "top": signed(config.line_bits + 2),
                "end": 1,
            }
        )


class ClearedLayout(data.StructLayout):
    """The slot of a line of which a beat is being cleared."""

    def __init__(self, config: EngineConfig):
        super().__init__({"valid": 1, "place": config.slot_bits})
