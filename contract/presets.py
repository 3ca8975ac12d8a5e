"""Engines with a name and a budget; see :mod:`splatline.contract.variants` for others."""

from __future__ import annotations

from .config import EngineConfig

__all__ = [
    "DEFAULT",
    "LANES8",
    "PAPER",
    "PLANE",
    "PRESETS",
    "REMOVED",
    "RGB24",
    "SWIFT",
    "SWIFT_PLANE",
    "get_preset",
]

PAPER = EngineConfig(name="paper")
"""The paper's machine: 512 columns, 9-bit depth, 3 + 3 + 3 bits of colour, on an XC2V250."""

RGB24 = PAPER.replace(name="rgb24", channel_bits=8, coefficient_bits=10, colour_shift=8)
"""``PAPER`` with 8 + 8 + 8 bits of colour, in the same block RAMs and the same device."""

SWIFT = RGB24.replace(name="swift", window="blocks", pixels_per_word=8, raster_words=2)
"""One code word a cycle, whatever its size: the fewest cycles, with eight times the block RAMs."""

LANES8 = RGB24.replace(name="lanes8", pixels_per_word=8)
"""Half the cycles of ``rgb24`` for larger elements and sparse scans, and twice its block RAMs."""

PLANE = RGB24.replace(name="plane", plane=True, depth_bits=12, material_bits=8)
"""``rgb24`` with a depth for every pixel: code words of 96 bits carry the plane of their element,
with 12 bits of depth and 256 materials. The most accurate picture, and one code word for each
element of up to 8 x 8 pixels."""

SWIFT_PLANE = SWIFT.replace(name="swift-plane", plane=True, depth_bits=12, material_bits=8)
"""``swift`` with a depth for every pixel: the code words of ``plane``, one a cycle. The fewest
cycles for the most accurate picture, with twice the LUTs of ``swift`` and as many block RAMs."""

DEFAULT = RGB24
"""The default of commands and functions."""

PRESETS = {config.name: config for config in (PAPER, RGB24, LANES8, SWIFT, PLANE, SWIFT_PLANE)}
"""Named configurations."""

REMOVED = {
    "wide": "swift or lanes8",
    "dither": "rgb24",
    "rgb18": "rgb24",
    "deep": "depth12",
    "banks16": "swift",
    "banks16-word4": "lanes8",
    "word8": "lanes8",
}
"""Removed names, and their replacements."""


def get_preset(name: str) -> EngineConfig:
    """Return a named configuration, or raise ``ValueError`` with the names there are."""
    try:
        return PRESETS[name]
    except KeyError:
        if name in REMOVED:
            raise ValueError(f"preset {name!r} was removed; take {REMOVED[name]}") from None
        names = ", ".join(sorted(PRESETS))
        raise ValueError(f"no preset named {name!r}; there are: {names}") from None
