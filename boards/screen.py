"""The video mode of the boards."""

from __future__ import annotations

from litex.soc.cores.video import video_timings

__all__ = ["SCREEN"]

SCREEN = {**video_timings["640x480@60Hz"], "pix_clk": 25e6}
"""640 x 480 as LiteX has it, but for the clock, which the boards' PLL makes exactly. The standard
has 25.175 MHz; screens take 25. The serialisers of 1024 x 768 would need 325 MHz
(``docs/boards.md``)."""
