"""The engines that have a name and a budget; see :mod:`splatline.rtl.variants` for others."""

from __future__ import annotations

from .format import EngineConfig

__all__ = ["BANKED", "PAPER", "PRESETS", "SWIFT", "WIDE", "get_preset"]

PAPER = EngineConfig(name="paper", lanes=True)
"""The paper's machine: 512 columns, 9-bit depth, 3 + 3 + 3 bits of colour, on an XC2V250."""

BANKED = PAPER.replace(lanes=False)
"""The same with a window of banks; the other presets come from it."""

WIDE = BANKED.replace(name="wide", raster_words=2)
"""More silicon, and fewer cycles for elements over 4 pixels and for sparse scenes."""

SWIFT = WIDE.replace(name="swift", lanes=True, banks=16, pixels_per_word=8)
"""A code word a cycle, whatever its size and whatever came before it: the fewest cycles, of sparse
scenes too, in fewer LUTs than ``wide`` and eight times the block RAMs."""

PRESETS = {
    config.name: config
    for config in (
        PAPER,
        WIDE,
        SWIFT,
        BANKED.replace(name="dither", dither=True, mark_words=2),
        BANKED.replace(
            name="rgb18",
            channel_bits=6,
            coefficient_bits=8,
            colour_shift=9,
            colour_planes=2,
            mark_words=4,
        ),
        BANKED.replace(
            name="rgb24",
            channel_bits=8,
            coefficient_bits=10,
            colour_shift=8,
            colour_planes=3,
            mark_words=8,
        ),
        BANKED.replace(
            name="deep", depth_bits=12, intensity_bits=6, material_bits=6, colour_shift=9
        ),
    )
}
"""Named configurations: ``paper``; ``wide``; ``swift``; and with eight banks and one word a beat:
with ordered dithering, with 6 and 8 bits a colour channel, and with 12 bits of depth, which the
intensities and the materials give up."""


def get_preset(name: str) -> EngineConfig:
    """Return a named configuration, or raise ``ValueError`` with the names there are."""
    try:
        return PRESETS[name]
    except KeyError:
        names = ", ".join(sorted(PRESETS))
        raise ValueError(f"no preset named {name!r}; there are: {names}") from None
