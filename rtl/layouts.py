"""What travels on each stream of the engine: one layout for both ends of a link.

The layouts of the outer ports follow the bit positions of :mod:`splatline.rtl.format`; the inner
ones are the engine's own.
"""

from amaranth.hdl import signed
from amaranth.lib import data

from .bank_layout import bank_address_bits, stretch_bits
from .format import BLOCK, EngineConfig

__all__ = [
    "ClearedLayout",
    "CodeWordLayout",
    "DealLayout",
    "ElementLayout",
    "FlushLayout",
    "FootprintLayout",
    "GeometryLayout",
    "LoadLayout",
    "PixelsLayout",
    "PlaceLayout",
    "PlaneLayout",
    "RasterLayout",
    "SpanLayout",
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


class PlaneLayout(data.StructLayout):
    """What one access of a bank's two memories moves, where colours are cut into planes.

    At a word's own address its depths and the lowest bits of its colours (plane 0); at the address
    in the memories' upper halves, plane 1 in the colours' and plane 2, if there is one, in the
    depths'.
    """

    def __init__(self, config: EngineConfig):
        depth = config.depth_bits
        if config.colour_planes == 3:
            depth = max(depth, config.plane_bits)
        super().__init__(
            {
                "depth": data.ArrayLayout(depth, config.pixels_per_word),
                "colour": data.ArrayLayout(config.plane_bits, config.pixels_per_word),
            }
        )


class PlaceLayout(data.StructLayout):
    """A memory word's place in the image."""

    def __init__(self, config: EngineConfig):
        super().__init__({"word": config.word_bits, "line": config.line_bits})


class ClearedLayout(data.StructLayout):
    """A line of a window of rows of lanes, by its place there, of which a beat is cleared."""

    def __init__(self, config: EngineConfig):
        super().__init__({"valid": 1, "place": config.slot_bits})


class FlushLayout(data.StructLayout):
    """Words of a window of banks that are to leave: of two neighbours one or both.

    ``pair`` counts in twos from the left. ``halves[h]``: the one that lies in the lower half of the
    banks (h = 0) or in the upper: for which of the two that is see ``bank_layout``.
    """

    def __init__(self, config: EngineConfig):
        super().__init__({"pair": config.word_bits - 1, "halves": 2, "line": config.line_bits})


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

    ``pixels`` are those of its beat: of a beat of two words the left one is meant if ``word`` is
    even, else the right one; before a :class:`Halver` ``word`` is even, and both are.
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


class SpanLayout(data.StructLayout):
    """Which pixels of one line an element covers, counted from the word that X lies in.

    ``first`` and ``last`` (inclusive) count pixels from the left edge of that word; ``words`` has a
    bit for it and each of its neighbours on the right, two of four pixels or one of eight: set if
    the span touches the word, and the word lies in the image. In an image's last word a span may
    reach past the right border.
    """

    def __init__(self, config: EngineConfig):
        super().__init__({"first": 4, "last": 4, "words": config.block_words})


class FootprintLayout(data.StructLayout):
    """An element clipped to the image and laid out as the window's banks need it.

    The eight lines that an element may touch are two of each residue modulo 4: for residue q,
    ``upper[q]`` is the span on that one of the lines y - 4 .. y - 1 and ``lower[q]`` the span four
    lines below. ``upper_group[q]`` is bits 3:2 of the upper line's number; the lower line's is
    one more.

    ``top`` is y - 4: no later element touches a line above it; that holds even while none is
    offered. The colour comes beside it (:class:`ColourUnit`).
    """

    def __init__(self, config: EngineConfig):
        super().__init__(
            {
                "upper": data.ArrayLayout(SpanLayout(config), 4),
                "lower": data.ArrayLayout(SpanLayout(config), 4),
                "upper_group": data.ArrayLayout(2, 4),
                "word": config.word_bits,
                "z": config.z.width,
                "top": signed(config.line_bits + 2),
                "end": 1,
            }
        )


class DealLayout(data.StructLayout):
    """The words of an element that the banks are to draw at the same time, one each at most.

    ``want``: the banks that have one, ``shares``: its address and the pixels to draw. ``reach``:
    the stretches of marks that the element may lie in.
    """

    def __init__(self, config: EngineConfig):
        share = data.StructLayout(
            {"mask": config.pixels_per_word, "address": bank_address_bits(config)}
        )
        super().__init__(
            {
                "want": config.banks,
                "shares": data.ArrayLayout(share, config.banks),
                "z": config.z.width,
                "reach": 1 << stretch_bits(config),
            }
        )


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
