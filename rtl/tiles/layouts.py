"""The stream from the tiler to the window of tiles."""

from amaranth.hdl import signed
from amaranth.lib import data

from splatline.contract.config import EngineConfig

__all__ = ["TileLayout"]


class TileLayout(data.StructLayout):
    """A tile: four lines by the columns of a window word, by residue of line and column.

    - ``mask[q][p]``: draw the pixel on the line with residue q modulo 4, in the column with residue
      p modulo the pixels of a word.
    - ``group[q]``: slot of that line, without its two lowest bits.
    - ``words``: the two words that the columns lie in. The second is one more than the first.
    - ``next[p]``: column p lies in the second word.
    - ``meets``: the tile shares a pixel with the tile before it, which was taken in the cycle
      before this one came.
    - ``z``: depth of all pixels. The colour comes beside the tile (:class:`ColourUnit`).
    - ``top``: no later tile touches a line above this one. It holds even while no tile is offered.
    - ``end``: the end of the frame, and no tile.
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
