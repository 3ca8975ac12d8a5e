"""The stream from the tiler to the window of tiles."""

from amaranth.hdl import signed
from amaranth.lib import data

from splatline.contract.config import BLOCK, EngineConfig
from splatline.contract.plane import SHIFTS
from splatline.rtl.layouts import PlaneLayout

__all__ = ["TileLayout", "sum_bits"]


def sum_bits(config: EngineConfig) -> int:
    """Return the bits of a pixel's depth in fractions of a level, signed.

    They hold the depth of every pixel of a block (``docs/contract.md``, "Plane words"). What wraps
    lies outside of it.
    """
    steps, shift = 2 * (BLOCK - 1), SHIFTS[-1]
    least = -steps * (1 << config.slope_bits - 1 + shift)
    most = (config.z.mask << 1) + steps * ((1 << config.slope_bits - 1) - 1 << shift)
    return max(most.bit_length(), (-least - 1).bit_length()) + 1


def _plane(config: EngineConfig) -> dict:
    """Return the fields of a tile that give each pixel its depth."""
    slope = PlaneLayout(config)["across"].shape.width
    return {
        "corner": sum_bits(config),
        "across": data.ArrayLayout(signed(slope + config.pixel_bits + 1), config.pixels_per_word),
        "down": data.ArrayLayout(signed(slope + 3), 4),
    }


class TileLayout(data.StructLayout):
    """A tile: four lines by the columns of a window word, by residue of line and column.

    - ``mask[q][p]``: draw the pixel on the line with residue q modulo 4, in the column with residue
      p modulo the pixels of a word.
    - ``group[q]``: slot of that line, without its two lowest bits.
    - ``words``: the two words that the columns lie in. The second is one more than the first.
    - ``next[p]``: column p lies in the second word.
    - ``meets``: the tile shares a pixel with the tile before it, which was taken in the cycle
      before this one came.
    - ``z``: depth of all pixels. With planes there are ``corner``, the depth at the first pixel of
      the tile's first word and group of lines, in quarters of a level, and what the lane in each
      column and line adds: ``across`` and ``down``.
    - The colour comes beside the tile (:class:`ColourUnit`).
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
                **(_plane(config) if config.plane else {"z": config.z.width}),
                "top": signed(config.line_bits + 2),
                "end": 1,
            }
        )
