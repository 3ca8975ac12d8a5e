"""Facts from the header of a LAS file, besides the layout of its points."""

from __future__ import annotations

import re
import struct

import numpy as np

from .las_header import PROJECTION, LasHeader

__all__ = ["las_extent", "las_facts", "named_system"]

WKT, GEO_KEYS = 2112, 34735
"""Records of the coordinate system: OGC well-known text, and the keys of GeoTIFF."""

KEYS = {3072: "", 2048: "", 4096: "height "}
"""GeoTIFF's keys of EPSG codes: projected, geographic and vertical systems."""

UNKNOWN = (0, 32767)
"""Codes that mean none, and one that the user defines."""

_NAME = re.compile(r'^\s*(\w+)\s*\[\s*"([^"]*)"')
_LAST_CODE = re.compile(r'(?:AUTHORITY|ID)\s*\[\s*"EPSG"\s*,\s*"?(\d+)"?[^\]]*\]\s*\]\s*$')


def las_extent(
    header: LasHeader,
) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
    """Return the lowest and the highest coordinates by the header, or None if they are none."""
    low, high = header.low, header.high
    if not np.isfinite([low, high]).all() or not (low <= high).all():
        return None
    return (
        (float(low[0]), float(low[1]), float(low[2])),
        (float(high[0]), float(high[1]), float(high[2])),
    )


def las_facts(header: LasHeader) -> dict[str, str]:
    """Return the coordinate system, the program that wrote the file, and the day, as far as said.

    The coordinate system is that of the record 2112 (well-known text), else of 34735 (GeoTIFF);
    both may be extended records.
    """
    facts = {}
    if system := _coordinate_system(header):
        facts["coordinate system"] = system
    for name, start in (("system", 26), ("software", 58)):
        if text := _text(header.head[start : start + 32]):
            facts[name] = text
    day, year = struct.unpack_from("<HH", header.head, 90)
    if year:
        facts["created"] = f"{year}, day {day}" if day else f"{year}"
    facts["scale"] = ", ".join(f"{scale:g}" for scale in header.scales)
    return facts


def _coordinate_system(header: LasHeader) -> str:
    """Return the name of the coordinate system and its EPSG code, or an empty text."""
    if name := named_system(_text(header.records.get((PROJECTION, WKT), b""))):
        return name
    data = header.records.get((PROJECTION, GEO_KEYS), b"")
    values = np.frombuffer(data[: len(data) // 8 * 8], "<u2").reshape(-1, 4)
    codes = {int(key): int(value) for key, place, _, value in values[1:] if not place}
    found = [
        f"{what}EPSG:{codes[key]}" for key, what in KEYS.items() if codes.get(key, 0) not in UNKNOWN
    ]
    if len(found) > 1 and 3072 in codes and codes.get(2048, 0) not in UNKNOWN:
        found.remove(f"EPSG:{codes[2048]}")  # the projected system's own base
    return ", ".join(found)


def named_system(wkt: str) -> str:
    """Return the name and the EPSG code of well-known text, or an empty text if it has no name."""
    name = _NAME.match(wkt)
    if name is None:
        return ""
    code = _LAST_CODE.search(wkt)
    return name[2] + (f" (EPSG:{code[1]})" if code else "")


def _text(data: bytes) -> str:
    """Return the text up to its first zero, on one line."""
    return " ".join(data.split(b"\0")[0].decode("utf-8", "replace").split())
