"""The Verilog of a system: LiteX's and the engine's."""

from __future__ import annotations

import re
from pathlib import Path

from splatline.contract.config import EngineConfig
from splatline.flow.verilog import convert
from splatline.rtl.framebuffer.top import FrameBufferTop

from .engine_core import MODULE

__all__ = ["TOP", "engine_verilog", "system_verilog"]

TOP = "board"
"""Name of the top module."""

MEMORY_BITS = 32
"""Bits of the bus over which the engine writes pictures."""


def engine_verilog(config: EngineConfig) -> str:
    """Return the Verilog of an engine with its frame buffer."""
    return convert(FrameBufferTop(config, MEMORY_BITS), MODULE)


def system_verilog(soc, config: EngineConfig) -> dict[str, str]:
    """Finalise a system; return its Verilog by file name, and the contents of its memories."""
    soc.finalize()
    written = soc.platform.get_verilog(soc, name=TOP)
    # Neither the date nor the drawing of the hierarchy, so that the same system is the same text.
    text = re.sub(r"^// Date .*\n", "", written.main_source, flags=re.MULTILINE)
    text = re.sub(r"/\*.*?\*/", "", text, count=1, flags=re.DOTALL)
    files = {Path(name).name: content for name, content in written.data_files.items()}
    return {f"{TOP}.v": text, f"{MODULE}.v": engine_verilog(config), **files}
