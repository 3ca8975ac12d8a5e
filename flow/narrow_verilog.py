"""The Verilog of the narrow top, and its description."""

from __future__ import annotations

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.contract.progress import Share
from splatline.rtl.bus.narrow_top import PinTop

from .verilog import convert, describe, header

__all__ = ["generate_pins"]

MEANINGS = {
    "words": "pieces of code words and table writes, in the order in which they take effect",
    "initial": "pieces of the raster that the frame starts from, if the control register asks",
    "raster": "pieces of the words of the picture with their places, then of the frame's end",
}


def generate_pins(
    config: EngineConfig = PAPER, name: str = "splatline", progress: Share | None = None
) -> tuple[str, dict]:
    """Return the Verilog and the description of an engine with its pins.

    Parameters and results are those of :func:`splatline.flow.verilog.generate`.
    """
    top = PinTop(config)
    return header(config) + convert(top, name, progress), describe(top, name, MEANINGS)
