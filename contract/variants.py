"""Engines beside the presets: other windows, sizes and depths.

The tests simulate them, and ``splatline bench configurations`` compares them.
"""

from __future__ import annotations

from .config import EngineConfig
from .presets import PAPER, PLANE, PRESETS, RGB24, SWIFT

__all__ = ["CONFIGS", "NARROW_BLOCKS", "PLANE_VARIANTS", "SHAPED", "VARIANTS"]


def _large(name: str, **changes: object) -> EngineConfig:
    """Return an engine for images of up to 2048 x 2048 pixels.

    X has two more bits, one from each intensity.
    """
    taken: dict[str, object] = {
        "x_bits": 11,
        "line_bits": 11,
        "intensity_bits": 6,
        "colour_shift": 7,
    }
    return RGB24.replace(name=name, **{**taken, **changes})


VARIANTS = (
    PAPER.replace(name="lines8", window_lines=8),
    PAPER.replace(name="lines32", window_lines=32),
    PAPER.replace(name="word2", pixels_per_word=2),
    PAPER.replace(name="small", pixels_per_word=2, window_lines=8),
    RGB24.replace(
        name="depth12", depth_bits=12, intensity_bits=6, material_bits=6, colour_shift=7
    ),
    RGB24.replace(
        name="depth16", depth_bits=16, intensity_bits=5, material_bits=4, colour_shift=6
    ),
    _large("wide2048"),
    _large("wide2048-lines8", window_lines=8),
    _large(
        "largest", pixels_per_word=8, window_lines=32,
        depth_bits=16, intensity_bits=4, material_bits=4, colour_shift=5,
    ),
)  # fmt: skip
"""By name: windows of 8 and of 32 lines and words of 2 pixels with the paper's colours, both as
small as can be; 12 and 16 bits of depth in 24-bit colour, which intensities and materials give up;
2048 columns, with a window that stays as small; the largest of everything."""

SHAPED = (PAPER.with_shapes(), PAPER.with_shapes("full"))
"""Engines with a shape ROM: ``paper-rom`` holds the sizes up to 8 and fits the paper's FPGA,
``paper-rom-full`` those up to 16."""

PLANE_VARIANTS = (
    PLANE.replace(
        name="plane-4096", x_bits=12, line_bits=12, intensity_bits=6, material_bits=7,
        colour_shift=7,
    ),
)  # fmt: skip
"""Engines with planes of other sizes: for images of up to 4096 x 4096 pixels X has three more bits,
one from each intensity and one from MATERIAL."""

CONFIGS = {
    **PRESETS,
    **{config.name: config for config in (*SHAPED, *VARIANTS, *PLANE_VARIANTS)},
}
"""Every configuration with a name that a command takes: the presets first."""

NARROW_BLOCKS = SWIFT.replace(name="narrow-blocks", window_lines=32, x_bits=5, depth_bits=13)
"""A window of blocks as narrow and as high as can be; for tests."""
