"""What travels between the tiler and the window of blocks."""

from amaranth.hdl import signed
from amaranth.lib import data

from splatline.contract.config import BLOCK, EngineConfig

__all__ = ["BlockLayout", "ClearedLayout"]


class BlockLayout(data.StructLayout):
    """Pixels of an element, its whole block, as a window of rows of lanes needs them.

    ``mask[q][p]``: the pixel on the line with residue q modulo 8 and in the column with residue p
    is drawn. ``odd[q][p]``: it lies in an odd word of its line. ``group[q]``: the line's place in
    the window but for its three lowest bits. ``words``: the two words that the block's columns lie
    in. ``touch[q]``: whether pixels of an odd word are drawn on the line, and of an even one;
    ``rows[q]``: of any. ``mode``: of the first four lines alone. ``end`` and ``top`` as in
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
    """A line of a window of rows of lanes, by its place there, of which a beat is cleared."""

    def __init__(self, config: EngineConfig):
        super().__init__({"valid": 1, "place": config.slot_bits})
