"""The layout of a raster beat, for texts, JSON and the C header.

The positions are those of :class:`splatline.contract.config.EngineConfig`.
"""

from __future__ import annotations

from .config import EngineConfig
from .stream_layout import StreamField, padding_of, stream_bytes

__all__ = ["beat_fields", "raster_stream_bytes"]


def raster_stream_bytes(config: EngineConfig) -> int:
    """Return the bytes of a raster beat on its stream, as ``contract.raster_beats`` has it."""
    return stream_bytes(config.raster_end.end)


def beat_fields(config: EngineConfig) -> tuple[StreamField, ...]:
    """Return the fields of a raster beat on AXI, the lowest first, with its padding."""
    pixels, bits = config.raster_pixels, config.channel_bits
    colours = f"red in bits 0..{bits - 1}, then green, then blue"
    end = config.raster_end.end
    return (
        StreamField(
            "depth",
            config.raster_depth(0).lsb,
            config.depth_bits,
            pixels,
            f"depths of the pixels, the leftmost lowest; {config.background_depth}: background",
        ),
        StreamField(
            "colour",
            config.raster_colour(0).lsb,
            config.colour_bits,
            pixels,
            f"colours of the pixels, the leftmost lowest: {colours}",
        ),
        StreamField(
            "word",
            config.raster_word.lsb,
            config.raster_word.width,
            1,
            f"place in the line: the leftmost pixel is in column {pixels} * word",
        ),
        StreamField("line", config.raster_line.lsb, config.line_bits, 1, "line of the image"),
        StreamField(
            "end", config.raster_end.lsb, 1, 1, "1: end of the frame; no other field counts"
        ),
        *padding_of(end, 8 * raster_stream_bytes(config)),
    )
