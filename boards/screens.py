"""Video modes of the boards, with pixel clocks that their PLL makes exactly."""

from __future__ import annotations

from litex.soc.cores.video import video_timings

__all__ = ["DEFAULT_SCREEN", "SCREENS", "screen"]

SCREENS = {"640x480": ("640x480@60Hz", 25e6), "1024x768": ("1024x768@60Hz", 65e6)}
"""LiteX's name of the mode, and Hz of the pixel clock. The standard has 25.175 MHz for 640 x 480;
screens take 25."""

DEFAULT_SCREEN = "640x480"


def screen(name: str) -> dict:
    """Return the timings of a video mode, as LiteX has them."""
    mode, clock = SCREENS[name]
    return {**video_timings[mode], "pix_clk": clock}
