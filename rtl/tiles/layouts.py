"""What travels between the tiler and the window of tiles."""

from amaranth.hdl import signed
from amaranth.lib import data

from splatline.contract.config import EngineConfig

__all__ = ["TileLayout"]


class TileLayout(data.StructLayout):
    """Pixels of an element, four lines by a word's columns, as the window's lanes need them.

    ``mask[q][p]``: the pixel on the line with residue q modulo 4 and in the column with residue p
    modulo a word's pixels is drawn. ``group[q]``: the line's place in the window but for its two
    lowest bits. ``words``: the words that the tile's columns lie in, the second one more than the
    first; ``next[p]``: column p lies in the
    second. ``meets``: it has a pixel in common with the tile before it, which was taken in the
    cycle before this one came.

    ``end``: no tile, but the end of the frame. No later tile touches a line above ``top``; that
    holds even while none is offered. The colour comes beside the tile (:class:`ColourUnit`).
    """

    def __init__(self, config: EngineConfig):
        super().__init__(
            {
                "mask": data.ArrayLayout(config.pixels_per_word, 4),
                "group": data.ArrayLayout(config.group_bits, 4),
                "words": data.ArrayLayout(config.word_bits, 2),
                "next": config.pixels_per_word,
                "meets": 1,
                "z": config.z.width,
                "top": signed(config.line_bits + 2),
                "end": 1,
            }
        )
