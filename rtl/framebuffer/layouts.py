"""Layouts of the frame buffer: its settings, and what its parts hand on."""

from __future__ import annotations

from amaranth.lib import data

from splatline.contract.config import EngineConfig
from splatline.rtl.bus.axi_write import ADDRESS_BITS

__all__ = [
    "DATA_BITS",
    "PIXEL_BYTES",
    "STRIDE_BITS",
    "ColourBeatLayout",
    "ColourWordLayout",
    "MemoryWordLayout",
    "SettingsLayout",
    "bus_pixels",
    "word_address_bits",
]

PIXEL_BYTES = 4
"""Bytes of a pixel in memory: red, green, blue and 0."""

STRIDE_BITS = 16
"""Bits of the distance between two lines, in bytes."""

DATA_BITS = (32, 64, 128)
"""Widths of the memory's bus."""


def bus_pixels(data_bits: int) -> int:
    """Return the pixels in a word of the bus."""
    return data_bits // (8 * PIXEL_BYTES)


def word_address_bits(data_bits: int) -> int:
    """Return the bits of the number of a bus word in memory."""
    return ADDRESS_BITS - (data_bits // 8 - 1).bit_length()


class SettingsLayout(data.StructLayout):
    """A frame's address, its size, and the colour of its background: red lowest."""

    def __init__(self, config: EngineConfig):
        super().__init__(
            {
                "buffers": data.ArrayLayout(ADDRESS_BITS, 2),
                "stride": STRIDE_BITS,
                "last_column": config.x_bits,
                "last_line": config.line_bits,
                "background": 24,
            }
        )


class ColourBeatLayout(data.StructLayout):
    """A beat of a raster without depth: colours, which pixels are drawn, and the position."""

    def __init__(self, config: EngineConfig):
        pixels = config.raster_pixels
        super().__init__(
            {
                "colour": data.ArrayLayout(config.colour_bits, pixels),
                "drawn": data.ArrayLayout(1, pixels),
                "word": config.raster_word.width,
                "line": config.line_bits,
                "end": 1,
            }
        )


class ColourWordLayout(data.StructLayout):
    """Pixels of a bus word in the engine's colours, its number in memory, and the line's end."""

    def __init__(self, config: EngineConfig, data_bits: int):
        pixels = bus_pixels(data_bits)
        super().__init__(
            {
                "colour": data.ArrayLayout(config.colour_bits, pixels),
                "drawn": data.ArrayLayout(1, pixels),
                "address": word_address_bits(data_bits),
                "last": 1,
            }
        )


class MemoryWordLayout(data.StructLayout):
    """A bus word: colours of 24 bits, its number in memory, and whether it ends a line."""

    def __init__(self, data_bits: int):
        super().__init__(
            {
                "rgb": data.ArrayLayout(24, bus_pixels(data_bits)),
                "address": word_address_bits(data_bits),
                "last": 1,
            }
        )
