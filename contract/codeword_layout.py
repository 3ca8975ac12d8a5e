"""The layout of a code word on its stream, for texts, JSON and the C header.

The positions are those of :class:`splatline.contract.config.EngineConfig`.
"""

from __future__ import annotations

from .config import COMPACT, ROWS, EngineConfig
from .plane import SHIFTS, SUM_FRACTION, Z_FRACTION
from .stream_layout import StreamField, padding_of, stream_bytes

__all__ = ["codeword_fields", "codeword_stream_bytes", "compact_fields"]


def codeword_stream_bytes(config: EngineConfig) -> int:
    """Return the bytes of a code word on its stream: 8, or 16 for a plane word."""
    return stream_bytes(config.codeword_bits)


def codeword_fields(config: EngineConfig) -> tuple[StreamField, ...]:
    """Return the fields of a code word on AXI, the lowest first, with its padding."""
    intensity, row = config.intensity_bits, config.first(1).lsb - config.first(0).lsb
    empty = "it is empty" if config.plane else "it is empty, or marks a half pixel"
    scans = f"of each row the first column (3 bits), then the last one; first > last: {empty}"
    end = "; of a control word bit 0: it ends the frame"
    lines = "; of a control word: lines to advance"
    depth = StreamField(
        "z", config.z.lsb, config.z.width, 1,
        f"depth at the block's first row and column, with {Z_FRACTION} fraction bit"
        if config.plane else "depth; smaller is nearer",
    )  # fmt: skip
    return (
        StreamField("mode", config.mode.lsb, 1, 1, "0: symmetric; 1: a fraction or a control word"),
        StreamField("scans", config.scans.lsb, row, ROWS, scans),
        StreamField("diffuse", config.diffuse.lsb, intensity, 1, f"intensity D{end}"),
        StreamField("specular", config.specular.lsb, intensity, 1, "intensity S"),
        StreamField("material", config.material.lsb, config.material_bits, 1, "material"),
        StreamField("x", config.x.lsb, config.x_bits, 1, f"column of the block's first{lines}"),
        *(_plane_fields(config) if config.plane else ()),
        depth,
        *padding_of(config.z.end, 8 * codeword_stream_bytes(config)),
    )


def compact_fields(config: EngineConfig) -> tuple[StreamField, ...]:
    """Return the fields of a compact word, the lowest first.

    Raises
    ------
    ValueError
        If the engine has no shape ROM.
    """
    if config.shapes == "none":
        raise ValueError(f"{config.name!r} has no shape ROM")
    mark = config.compact_mark
    places = (
        ("size", config.compact_size, "diameter in pixels"),
        ("level_x", config.compact_level_x, "level of n'x"),
        ("level_y", config.compact_level_y, "level of n'y"),
        ("part", config.compact_part, "of a size over 8: which four of its sixteen lines"),
        ("mark", mark, f"{COMPACT:0{mark.width}b}, the highest bit first"),
    )
    above = [field for field in codeword_fields(config) if field.lsb >= mark.end]
    return (
        StreamField("mode", config.mode.lsb, 1, 1, "0"),
        *(StreamField(name, place.lsb, place.width, 1, meaning) for name, place, meaning in places),
        # What they are of a control word does not count here.
        *(field._replace(meaning=field.meaning.partition(";")[0]) for field in above[:-1]),
        above[-1],
    )


def _plane_fields(config: EngineConfig) -> tuple[StreamField, ...]:
    """Return the fields of a plane word between X and Z."""
    sides, slope = config.side(0, 0).lsb, config.slope_bits
    places = ", ".join(map(str, SHIFTS))
    change = f"in 1/{1 << SUM_FRACTION} of a level, two's complement, before SCALE"
    return (
        *padding_of(config.x.end, sides, "unused", "ignored"),
        StreamField("sides", sides, 2, ROWS, "which ends of a rotated row are moved: first, last"),
        StreamField("raised", config.raised.lsb, 1, 1, "1: row 3 is the middle"),
        StreamField(
            "outwards", config.outwards(0).lsb, 1, 2, "1: moved outwards: first, last ends"
        ),
        StreamField(
            "slope_x", config.slope_x.lsb, slope, 1, f"depth from column to column, {change}"
        ),
        StreamField("slope_y", config.slope_y.lsb, slope, 1, f"depth from line to line, {change}"),
        StreamField(
            "scale", config.scale.lsb, config.scale.width, 1, f"slopes are shifted by {places} bits"
        ),
    )
