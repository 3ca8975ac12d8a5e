"""What travels on each stream of the engine: one layout for both ends of a link.

The layouts of the outer ports follow the bit positions of :mod:`splatline.contract.config`; the inner
ones are the engine's own.
"""

from amaranth.hdl import signed
from amaranth.lib import data

from splatline.contract.config import BLOCK, EngineConfig

__all__ = [
    "ClearedLayout",
    "CodeWordLayout",
    "ElementLayout",
    "GeometryLayout",
    "LoadLayout",
    "PixelsLayout",
    "PlaceLayout",
    "RasterLayout",
    "TableWriteLayout",
    "TileLayout",
    "WordLayout",
]


class CodeWordLayout(data.StructLayout):
    """A code word as the host sends it."""

    def __init__(self, config: EngineConfig):
        row = data.StructLayout({"first": 3, "last": 3})
        super().__init__(
            {
                "mode": config.mode.width,
                "scans": data.ArrayLayout(row, 4),
                "diffuse": config.diffuse.width,
                "specular": config.specular.width,
                "material": config.material.width,
                "x": config.x.width,
                "z": config.z.width,
            }
        )


class TableWriteLayout(data.StructLayout):
    """A write to the material table or a frame register."""

    def __init__(self, config: EngineConfig):
        super().__init__({"data": config.table_data.width, "address": config.table_address.width})


class PixelsLayout(data.StructLayout):
    """Neighbouring pixels, the leftmost first."""

    def __init__(self, config: EngineConfig, pixels: int):
        super().__init__(
            {
                "depth": data.ArrayLayout(config.depth_bits, pixels),
                "colour": data.ArrayLayout(config.colour_bits, pixels),
            }
        )


class WordLayout(PixelsLayout):
    """A word of the window's memory."""

    def __init__(self, config: EngineConfig):
        super().__init__(config, config.pixels_per_word)


class PlaceLayout(data.StructLayout):
    """A memory word's place in the image."""

    def __init__(self, config: EngineConfig):
        super().__init__({"word": config.word_bits, "line": config.line_bits})


class ClearedLayout(data.StructLayout):
    """A line of a window of rows of lanes, by its place there, of which a beat is cleared."""

    def __init__(self, config: EngineConfig):
        super().__init__({"valid": 1, "place": config.slot_bits})


class RasterLayout(data.StructLayout):
    """A beat of a raster: its pixels with their place in the image, or the end of the frame.

    ``word`` counts in beats of a line: of ``raster_pixels`` each.
    """

    def __init__(self, config: EngineConfig):
        super().__init__(
            {
                "pixels": PixelsLayout(config, config.raster_pixels),
                "word": config.raster_word.width,
                "line": config.line_bits,
                "end": 1,
            }
        )


class LoadLayout(data.StructLayout):
    """A memory word of the initial raster with its place in the image, or the raster's end.

    ``pixels`` are those of its beat. Of a beat of two words ``word`` is the left one.
    """

    def __init__(self, config: EngineConfig):
        place = PlaceLayout(config).members
        pixels = PixelsLayout(config, config.raster_pixels)
        super().__init__({"pixels": pixels, **place, "end": 1})


def _geometry(config: EngineConfig) -> dict:
    """Fields that the decoder needs: what the code word says of shape and place, and the line.

    ``top`` is the line of the block's first row, y - 4: from -4 up.
    """
    codeword = CodeWordLayout(config).members
    return {
        **{name: codeword[name] for name in ("mode", "scans", "x", "z")},
        "top": signed(config.line_bits + 2),
        "end": 1,
    }


class ElementLayout(data.StructLayout):
    """An element and its line, or the end of the frame: ``end``, and the largest ``top``."""

    def __init__(self, config: EngineConfig):
        super().__init__(
            {
                "diffuse": config.diffuse.width,
                "specular": config.specular.width,
                "material": config.material.width,
                **_geometry(config),
            }
        )


class GeometryLayout(data.StructLayout):
    """An element but for its colour, which follows later; or the end of the frame."""

    def __init__(self, config: EngineConfig):
        super().__init__(_geometry(config))


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
