"""The layout of a raster beat, for texts, JSON and the C header.

The positions are those of :class:`splatline.contract.config.EngineConfig`.
"""

from __future__ import annotations

from typing import NamedTuple

from .config import EngineConfig

__all__ = ["BeatField", "beat_fields", "raster_stream_bytes"]


class BeatField(NamedTuple):
    """A field of a raster beat, or one field for each pixel.

    Parameters
    ----------
    name
        In small letters.
    lsb
        Lowest bit of the first one in the beat.
    width
        Bits of each.
    number
        How many there are, side by side: 1, or the pixels of a beat.
    meaning
        One phrase.
    """

    name: str
    lsb: int
    width: int
    number: int
    meaning: str

    @property
    def end(self) -> int:
        """The bit above the last one."""
        return self.lsb + self.number * self.width


def raster_stream_bytes(config: EngineConfig) -> int:
    """Return the bytes of a raster beat on its stream: the next power of two, at least 8.

    A beat is then whole 64-bit limbs, as in ``contract.raster_beats``, and vendors' DMA cores
    accept its width.
    """
    return max(8, 1 << (-(-config.raster_end.end // 8) - 1).bit_length())


def beat_fields(config: EngineConfig) -> tuple[BeatField, ...]:
    """Return the fields of a raster beat on AXI, the lowest first, with its padding."""
    pixels, bits = config.raster_pixels, config.channel_bits
    colours = f"red in bits 0..{bits - 1}, then green, then blue"
    end = config.raster_end.end
    padding = 8 * raster_stream_bytes(config) - end
    return (
        BeatField(
            "depth",
            config.raster_depth(0).lsb,
            config.depth_bits,
            pixels,
            f"depths of the pixels, the leftmost lowest; {config.background_depth}: background",
        ),
        BeatField(
            "colour",
            config.raster_colour(0).lsb,
            config.colour_bits,
            pixels,
            f"colours of the pixels, the leftmost lowest: {colours}",
        ),
        BeatField(
            "word",
            config.raster_word.lsb,
            config.raster_word.width,
            1,
            f"place in the line: the leftmost pixel is in column {pixels} * word",
        ),
        BeatField("line", config.raster_line.lsb, config.line_bits, 1, "line of the image"),
        BeatField("end", config.raster_end.lsb, 1, 1, "1: end of the frame; no other field counts"),
        *([BeatField("padding", end, padding, 1, "0")] if padding else []),
    )
