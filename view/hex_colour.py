"""Colours as ``#rrggbb``."""

from __future__ import annotations

import re

__all__ = ["hex_colour", "read_hex"]


def hex_colour(colour: tuple[float, float, float]) -> str:
    """Return red, green and blue in 0..1, which are whole bytes, as ``#rrggbb``."""
    return "#" + bytes(round(255.0 * level) for level in colour).hex()


def read_hex(text: str) -> tuple[float, float, float] | None:
    """Return red, green and blue in 0..1 of ``#rrggbb``; None if the text is something else."""
    if re.fullmatch("#[0-9a-fA-F]{6}", text) is None:
        return None
    red, green, blue = (byte / 255.0 for byte in bytes.fromhex(text[1:]))
    return red, green, blue
