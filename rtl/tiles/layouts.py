"""The stream from the tiler to the window of tiles."""

from amaranth.hdl import signed
from amaranth.lib import data

from splatline.contract.config import BLOCK, EngineConfig
from splatline.rtl.layouts import PlaneLayout, sum_bits

__all__ = ["PlaneTileLayout", "TileLayout"]


def _pixels(config: EngineConfig) -> dict:
    """Return the fields of a tile that tell where its pixels lie."""
    return {
        "mask": data.ArrayLayout(config.pixels_per_word, 4),
        "group": data.ArrayLayout(config.group_bits, 4),
        "words": data.ArrayLayout(config.word_bits, 2),
        "next": config.pixels_per_word,
    }


def _order(config: EngineConfig) -> dict:
    """Return the fields of a tile that tell what follows."""
    return {"top": signed(config.line_bits + 2), "end": 1}


class TileLayout(data.StructLayout):
    """A tile: four lines by the columns of a window word, by residue of line and column.

    - ``mask[q][p]``: draw the pixel on the line with residue q modulo 4, in the column with residue
      p modulo the pixels of a word.
    - ``group[q]``: slot of that line, without its two lowest bits.
    - ``words``: the two words that the columns lie in. The second is one more than the first.
    - ``next[p]``: column p lies in the second word.
    - ``meets``: the tile shares a pixel with the tile before it, which was taken in the cycle
      before this one came.
    - ``z``: depth of all pixels. With planes there is ``depth[q][p]``, of each.
    - The colour comes beside the tile (:class:`ColourUnit`).
    - ``top``: no later tile touches a line above this one. It holds even while no tile is offered.
    - ``end``: the end of the frame, and no tile.
    """

    def __init__(self, config: EngineConfig):
        lanes = data.ArrayLayout(data.ArrayLayout(config.depth_bits, config.pixels_per_word), 4)
        depth = {"depth": lanes} if config.plane else {"z": config.z.width}
        super().__init__({**_pixels(config), "meets": 1, **_order(config), **depth})


class PlaneTileLayout(data.StructLayout):
    """A tile with a plane, in quarters of a level. Its other fields are those of a tile.

    - ``corner``: depth at the first column of the block's first word, on the last line that is a
      multiple of four and not below the block's first.
    - ``across``, ``down``: what the lane in each column and on each line adds.
    """

    def __init__(self, config: EngineConfig):
        slope = PlaneLayout(config)["across"].shape.width
        across = signed(slope + range(2 * BLOCK).stop.bit_length() - 1)
        super().__init__(
            {
                **_pixels(config),
                **_order(config),
                "corner": sum_bits(config),
                "across": data.ArrayLayout(across, config.pixels_per_word),
                "down": data.ArrayLayout(signed(slope + 4), 4),
            }
        )
