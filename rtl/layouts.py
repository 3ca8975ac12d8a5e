"""Layouts of the engine's streams, one for both ends of a link.

The layouts of the outer ports follow the bit positions of :mod:`splatline.contract.config`; the
inner ones are the engine's own.
"""

from amaranth.hdl import signed
from amaranth.lib import data

from splatline.contract.config import BLOCK, EngineConfig
from splatline.contract.plane import PLANE_BITS, SHIFTS, SIDES

__all__ = [
    "CodeWordLayout",
    "ElementLayout",
    "GeometryLayout",
    "LoadLayout",
    "PixelLayout",
    "PixelsLayout",
    "PlaceLayout",
    "PlaneLayout",
    "RasterLayout",
    "TableWriteLayout",
    "WordLayout",
    "sum_bits",
]


class CodeWordLayout(data.StructLayout):
    """A code word as the host sends it."""

    def __init__(self, config: EngineConfig):
        row = data.StructLayout({"first": 3, "last": 3})
        fields = {
            "mode": config.mode.width,
            "scans": data.ArrayLayout(row, 4),
            "diffuse": config.diffuse.width,
            "specular": config.specular.width,
            "material": config.material.width,
            "x": config.x.width,
        }
        if config.plane:
            fields |= {
                "unused": config.side(0, 0).lsb - config.x.end,
                "sides": SIDES,
                "raised": 1,
                "outwards": 2,
                **_slopes(config),
            }
        fields |= {"z": config.z.width}
        if config.plane:
            fields |= {"unused_above": PLANE_BITS - config.z.end}
        super().__init__(fields)


class TableWriteLayout(data.StructLayout):
    """A write to the material table or a frame register."""

    def __init__(self, config: EngineConfig):
        super().__init__({"data": config.table_data.width, "address": config.table_address.width})


class PixelLayout(data.StructLayout):
    """A pixel of the window's memory."""

    def __init__(self, config: EngineConfig):
        super().__init__({"depth": config.depth_bits, "colour": config.colour_bits})


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
    """A window word."""

    def __init__(self, config: EngineConfig):
        super().__init__(config, config.pixels_per_word)


class PlaceLayout(data.StructLayout):
    """A window word's position in the image."""

    def __init__(self, config: EngineConfig):
        super().__init__({"word": config.word_bits, "line": config.line_bits})


class RasterLayout(data.StructLayout):
    """A beat of a raster: pixels with their position in the image, or the end of the frame.

    ``word`` is the beat's number in its line, of ``raster_pixels`` pixels each.
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
    """A beat of the initial raster with its position in the image, or the raster's end.

    ``word`` is the number of a window word; of a beat of two words, that of the left one.
    """

    def __init__(self, config: EngineConfig):
        place = PlaceLayout(config).members
        pixels = PixelsLayout(config, config.raster_pixels)
        super().__init__({"pixels": pixels, **place, "end": 1})


def _slopes(config: EngineConfig) -> dict:
    """Return the fields of a plane word that tell the slopes of its plane."""
    slope = signed(config.slope_bits)
    return {"slope_x": slope, "slope_y": slope, "scale": 2}


def _geometry(config: EngineConfig) -> dict:
    """Return the fields of an element's shape and position, and of its line.

    ``top`` is the line of the block's first row, y - 4. It is at least -4.
    """
    codeword = CodeWordLayout(config).members
    sides = ("sides", "raised", "outwards") if config.plane else ()
    return {
        **{name: codeword[name] for name in ("mode", "scans", "x", "z", *sides)},
        "top": signed(config.line_bits + 2),
        "end": 1,
    }


class ElementLayout(data.StructLayout):
    """An element with its line; or the end of the frame, with ``end`` and the largest ``top``.

    With planes ``line_modulo_4`` has the low bits of an element's ``top``. Those of an end mean
    nothing.
    """

    def __init__(self, config: EngineConfig):
        super().__init__(
            {
                "diffuse": config.diffuse.width,
                "specular": config.specular.width,
                "material": config.material.width,
                **_geometry(config),
                **({**_slopes(config), "line_modulo_4": 2} if config.plane else {}),
            }
        )


def sum_bits(config: EngineConfig) -> int:
    """Return the bits of a pixel's depth in fractions of a level, signed.

    They hold the depth of every pixel of a block (``docs/contract.md``, "Plane words"). What wraps
    lies outside of it.
    """
    steps, shift = 2 * (BLOCK - 1), SHIFTS[-1]
    least = -steps * (1 << config.slope_bits - 1 + shift)
    most = (config.z.mask << 1) + steps * ((1 << config.slope_bits - 1) - 1 << shift)
    return max(most.bit_length(), (-least - 1).bit_length()) + 1


class PlaneLayout(data.StructLayout):
    """Terms of an element's plane, in quarters of a level.

    - ``across``, ``down``: change of depth from column to column, and from line to line.
    - ``before``: change from the first column of the window word that X lies in to X.
    - ``above``: change from the last line that is a multiple of four to the block's first.
    """

    def __init__(self, config: EngineConfig):
        slope = config.slope_bits + SHIFTS[-1]
        super().__init__(
            {
                "across": signed(slope),
                "down": signed(slope),
                "before": signed(slope + config.pixel_bits),
                "above": signed(slope + 2),
            }
        )


class GeometryLayout(data.StructLayout):
    """An element without its colour, which follows later; or the end of the frame."""

    def __init__(self, config: EngineConfig):
        plane = {"plane": PlaneLayout(config)} if config.plane else {}
        super().__init__({**_geometry(config), **plane})
