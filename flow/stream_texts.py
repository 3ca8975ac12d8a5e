"""The layouts of code words and raster beats as C macros, as JSON and as rows of a table."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from splatline.contract.beat_layout import beat_fields, raster_stream_bytes
from splatline.contract.codeword_layout import (
    codeword_fields,
    codeword_stream_bytes,
    compact_fields,
)
from splatline.contract.config import EngineConfig
from splatline.contract.stream_layout import StreamField

__all__ = ["field_rows", "json_beat", "json_codeword", "stream_macros"]


MACROS = """
/* A code word is SPLATLINE_CODEWORD_LIMBS numbers of 64 bits, and a raster beat
 * SPLATLINE_BEAT_LIMBS, the lowest first, as on the stream of a little-endian machine. These take
 * a field out of them, and set one that was zero; n is its number: of a row, of an end (0: first,
 * 1: last) or of a pixel (0: the leftmost), and 0 where there is one field. */
static inline uint64_t splatline_bits_get(const uint64_t *limbs, unsigned lsb, unsigned width)
{
    uint64_t low = limbs[lsb / 64] >> (lsb % 64);
    if (lsb % 64 + width > 64)
        low |= limbs[lsb / 64 + 1] << (64 - lsb % 64);
    return width < 64 ? low & ((UINT64_C(1) << width) - 1) : low;
}

static inline void splatline_bits_put(uint64_t *limbs, unsigned lsb, unsigned width, uint64_t value)
{
    if (width < 64)
        value &= (UINT64_C(1) << width) - 1;
    limbs[lsb / 64] |= value << (lsb % 64);
    if (lsb % 64 + width > 64)
        limbs[lsb / 64 + 1] |= value >> (64 - lsb % 64);
}

#define SPLATLINE_FIELD(name, n) \\
    SPLATLINE_##name##_LSB + (n) * SPLATLINE_##name##_WIDTH, SPLATLINE_##name##_WIDTH
#define SPLATLINE_CODEWORD_GET(field, limbs, n) \\
    splatline_bits_get(limbs, SPLATLINE_FIELD(CODEWORD_##field, n))
#define SPLATLINE_CODEWORD_PUT(field, limbs, n, value) \\
    splatline_bits_put(limbs, SPLATLINE_FIELD(CODEWORD_##field, n), value)
#define SPLATLINE_COMPACT_GET(field, limbs, n) \\
    splatline_bits_get(limbs, SPLATLINE_FIELD(COMPACT_##field, n))
#define SPLATLINE_COMPACT_PUT(field, limbs, n, value) \\
    splatline_bits_put(limbs, SPLATLINE_FIELD(COMPACT_##field, n), value)
#define SPLATLINE_BEAT_GET(field, limbs, n) \\
    splatline_bits_get(limbs, SPLATLINE_FIELD(BEAT_##field, n))
#define SPLATLINE_BEAT_PUT(field, limbs, n, value) \\
    splatline_bits_put(limbs, SPLATLINE_FIELD(BEAT_##field, n), value)
"""
"""Of the C header: what packs and unpacks code words and beats."""


def stream_macros(config: EngineConfig) -> Iterator[str]:
    """Yield the header's lines of code words and raster beats."""
    size = codeword_stream_bytes(config)
    yield from _layout_macros("CODEWORD", "A code word", size, codeword_fields(config))
    if config.shapes != "none":
        yield from _layout_macros("COMPACT", "A compact word", size, compact_fields(config))
    size = raster_stream_bytes(config)
    yield from _layout_macros("BEAT", "A raster beat", size, beat_fields(config))
    yield f"#define SPLATLINE_BEAT_PIXELS {config.raster_pixels}u"
    yield f"#define SPLATLINE_BACKGROUND_DEPTH {config.background_depth}u"
    for number, channel in enumerate(("RED", "GREEN", "BLUE")):
        yield f"/* {channel.lower()} of a colour */"
        yield f"#define SPLATLINE_COLOUR_{channel}(colour) \\"
        yield (f"    (((colour) >> {number * config.channel_bits}u) & {config.channel_max:#x}u)")
    yield MACROS


def _layout_macros(kind: str, what: str, size: int, fields: Iterable[StreamField]) -> Iterator[str]:
    """Yield the header's lines of what lies on a stream: its size and its fields."""
    yield from ("", f"/* {what} of {size} bytes. */")
    yield f"#define SPLATLINE_{kind}_BYTES {size}u"
    yield f"#define SPLATLINE_{kind}_LIMBS {size // 8}u"
    for field in fields:
        if field.name in ("padding", "unused"):
            continue
        name = f"SPLATLINE_{kind}_{field.name.upper()}"
        yield f"/* {field.meaning} */"
        yield f"#define {name}_LSB {field.lsb}u"
        yield f"#define {name}_WIDTH {field.width}u"


def json_beat(config: EngineConfig) -> dict:
    """Return the layout of a raster beat as plain lists and dictionaries."""
    return {
        "bits": config.raster_end.end,
        "stream_bytes": raster_stream_bytes(config),
        "pixels": config.raster_pixels,
        "fields": [field._asdict() for field in beat_fields(config)],
    }


def json_codeword(config: EngineConfig) -> dict:
    """Return the layout of a code word as plain lists and dictionaries.

    ``compact_fields`` are those of a compact word, of an engine with a shape ROM.
    """
    layout = {
        "bits": config.codeword_bits,
        "stream_bytes": codeword_stream_bytes(config),
        "fields": [field._asdict() for field in codeword_fields(config)],
    }
    if config.shapes != "none":
        layout["compact_fields"] = [field._asdict() for field in compact_fields(config)]
    return layout


def field_rows(fields: Iterable[StreamField]) -> Iterator[str]:
    """Yield a row of the page's table for each field of a code word or raster beat."""
    for field in fields:
        bits = f"{field.lsb}..{field.end - 1}" if field.end - field.lsb > 1 else f"{field.lsb}"
        each = f", {field.number} of {field.width} bits" if field.number > 1 else ""
        yield f"| {bits}{each} | {field.name} | {field.meaning} |"
