"""Engines beside the presets: one for each choice of a window, and some of them together.

They are what the tests simulate and, but for ``ALL_OF_EIGHT``, what ``splatline bench
configurations`` compares.
"""

from __future__ import annotations

from .format import EngineConfig
from .presets import PAPER, PRESETS, SWIFT, WIDE

__all__ = ["ALL_OF_EIGHT", "BANKS16", "BANKS16_WORD4", "SHAPED", "VARIANTS"]


def _large(name: str, **changes: object) -> EngineConfig:
    """Return an engine for images of up to 2048 x 2048 pixels.

    The two bits that X has more, the intensities give up.
    """
    taken: dict[str, object] = {
        "x_bits": 11,
        "line_bits": 11,
        "intensity_bits": 6,
        "colour_shift": 9,
    }
    return PAPER.replace(name=name, **{**taken, **changes})


_DEEP: dict[str, object] = {
    "depth_bits": 16,
    "intensity_bits": 5,
    "material_bits": 4,
    "colour_shift": 8,
}
"""16 bits of depth, given up by intensities and materials."""

BANKS16 = WIDE.replace(name="banks16", banks=16, pixels_per_word=8)
"""As many cycles as ``swift`` with half the block RAMs and twice the LUTs: in banks, words are
merged."""

BANKS16_WORD4 = BANKS16.replace(name="banks16-word4", pixels_per_word=4)
"""Half the block RAMs of ``banks16``."""

VARIANTS = (
    PAPER.replace(name="lines8", window_lines=8),
    PAPER.replace(name="lines32", window_lines=32),
    PAPER.replace(name="word2", pixels_per_word=2),
    PAPER.replace(name="word8", pixels_per_word=8),
    PAPER.replace(name="small", pixels_per_word=2, window_lines=8),
    PAPER.replace(name="depth16", **_DEEP),
    _large("wide2048"),
    _large("wide2048-lines8", window_lines=8),
    _large(
        "largest", pixels_per_word=8, window_lines=32,
        depth_bits=16, intensity_bits=4, material_bits=4, colour_shift=7,
    ),
    BANKS16,
    BANKS16_WORD4,
)  # fmt: skip
"""By name: windows of 8 and of 32 lines, words of 2 and of 8 pixels, both as small as can be; 16
bits of depth; 2048 columns, with a window that stays as small; the largest of everything, all with
lanes; and sixteen banks of words of eight pixels, and of four."""

SHAPED = (PAPER.with_shapes(), PAPER.with_shapes("full"))
"""Engines with a shape ROM: ``paper-rom`` holds the sizes up to 8 and fits the paper's FPGA,
``paper-rom-full`` those up to 16."""

ALL_OF_EIGHT = (
    PRESETS["rgb24"].replace(
        name="planes-word8", banks=16, pixels_per_word=8, dither=True, mark_words=2
    ),
    BANKS16.replace(name="dither-word8", dither=True, mark_words=4, shapes="small"),
    BANKS16.replace(name="narrow-word8", raster_words=1, x_bits=5, depth_bits=13),
    SWIFT.replace(name="narrow-lanes", window_lines=32, x_bits=5, depth_bits=13),
)
"""Sixteen banks of words of eight with all that may be combined with them."""
