"""An optional processor on a board's bus, beside the link."""

from __future__ import annotations

import struct
from typing import Any

__all__ = ["IDLE", "PROCESSORS", "REGISTERS", "ROM_BYTES", "processor_options"]

PROCESSORS = {"serv": "standard", "vexriscv": "minimal"}
"""Processors by LiteX's names, and their variants. The package ``pythondata-cpu-NAME`` has each."""

REGISTERS = 0xF000_0000
"""First address of the registers in a system with a processor; caches leave them out."""

ROM_BYTES, RAM_BYTES = 0x2000, 0x1000
"""Of block RAM: the program, from address 0 on, and its data, from 0x1000_0000 on."""

IDLE = struct.pack("<I", 0x0000_006F)
"""A program that only jumps to itself."""


def processor_options(cpu: str | None, program: bytes) -> dict[str, Any]:
    """Return LiteX's options of a system for a processor that starts at address 0.

    Raises
    ------
    ValueError
        If the program does not fit into the ROM.
    """
    if cpu is None:
        return {}
    if len(program) > ROM_BYTES:
        raise ValueError(f"the program has {len(program)} bytes, and the ROM has {ROM_BYTES}")
    words = struct.iter_unpack("<I", program + bytes(-len(program) % 4))
    return {
        "cpu_type": cpu,
        "cpu_variant": PROCESSORS[cpu],
        "integrated_rom_size": ROM_BYTES,
        "integrated_rom_init": [word for (word,) in words],
        "integrated_sram_size": RAM_BYTES,
        "with_timer": True,
        # On a shared bus a processor that fetches in every cycle lets no other master in (0113).
        "bus_interconnect": "crossbar",
    }
