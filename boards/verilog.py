"""The Verilog of a system, LiteX's and the engine's, and its constraints."""

from __future__ import annotations

import re
from pathlib import Path

from litex.build.generic_platform import IOStandard, Misc

from splatline.contract.config import EngineConfig
from splatline.flow.framebuffer_verilog import generate_framebuffer

from .engine_core import MODULE

__all__ = ["TOP", "system_files"]

TOP = "board"
"""Name of the top module."""

CONSTRAINTS = f"{TOP}.lpf"

MEMORY_BITS = 32
"""Bits of the bus over which the engine writes pictures."""


def system_files(soc, config: EngineConfig) -> dict[str, str]:
    """Finalise a system; return its Verilog, its constraints, and the contents of its memories.

    Of the same system they are the same texts.

    Returns
    -------
    dict
        Texts by file name: ``board.v``, ``splatline.v``, ``board.lpf``, and files that ``board.v``
        reads.
    """
    soc.finalize()
    fragment = soc.get_fragment()
    soc.platform.finalize(fragment)
    written = soc.platform.get_verilog(fragment, name=TOP)
    # Without the date and the drawing of the hierarchy.
    text = re.sub(r"^// Date .*\n", "", written.main_source, flags=re.MULTILINE)
    text = re.sub(r"/\*.*?\*/", "", text, count=1, flags=re.DOTALL)
    engine, _ = generate_framebuffer(config, MODULE, MEMORY_BITS)
    return {
        f"{TOP}.v": text,
        f"{MODULE}.v": engine,
        CONSTRAINTS: "\n".join(_constraints(soc.platform, written.ns)) + "\n",
        **{Path(name).name: content for name, content in written.data_files.items()},
    }


def _constraints(platform, names):
    """Yield the lines of the constraints file: pins, their standards, and clocks."""
    yield "BLOCK RESETPATHS;"
    yield "BLOCK ASYNCPATHS;"
    signals, commands = platform.resolve_signals(names)
    for signal, pins, others, _ in signals:
        for number, pin in enumerate(pins):
            port = f"{signal}[{number}]" if len(pins) > 1 else signal
            yield f'LOCATE COMP "{port}" SITE "{pin}";'
            for constraint in others:
                if isinstance(constraint, IOStandard):
                    yield f'IOBUF PORT "{port}" IO_TYPE={constraint.name};'
                elif isinstance(constraint, Misc):
                    yield f'IOBUF PORT "{port}" {constraint.misc};'
    yield from commands
