"""Layouts between the tiler and the window of the blocks engine."""

from amaranth.hdl import signed
from amaranth.lib import data

from splatline.contract.config import BLOCK, EngineConfig
from splatline.rtl.layouts import PlaneLayout, sum_bits

__all__ = ["BlockLayout", "ClearedLayout", "ColumnsLayout"]


class ColumnsLayout(data.ArrayLayout):
    """Depth that each column of lanes adds to an element's, in quarters of a level."""

    def __init__(self, config: EngineConfig):
        slope = PlaneLayout(config)["across"].shape.width
        super().__init__(signed(slope + config.pixel_bits), config.pixels_per_word)


class BlockLayout(data.StructLayout):
    """A block: the pixels of an element, by residue of line and column.

    ``mask[q][p]``: the pixel on the line with residue q modulo 8, in the column with residue p, is
    drawn. ``odd[q][p]``: it lies in an odd word of its line. ``group[q]``: slot of the line,
    without the three lowest bits. ``words``: the two words that the block's columns lie in.
    ``touch[q]``: pixels of an odd word are drawn on the line, and of an even one. ``rows[q]``: any
    pixel is. ``mode``: only the first four lines have pixels. ``end`` and ``top`` as in
    :class:`TileLayout`.

    ``z``: depth of all pixels. With planes, a pixel has the sum of ``lines[q]`` and ``columns[p]``,
    in quarters of a level.
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
                **_plane(config),
            }
        )


def _plane(config: EngineConfig) -> dict:
    """Return the fields of a block that give each pixel its depth."""
    if not config.plane:
        return {}
    lines = data.ArrayLayout(signed(sum_bits(config)), BLOCK)
    return {"lines": lines, "columns": ColumnsLayout(config)}


class ClearedLayout(data.StructLayout):
    """The slot of a line of which a beat is being cleared."""

    def __init__(self, config: EngineConfig):
        super().__init__({"valid": 1, "place": config.slot_bits})
