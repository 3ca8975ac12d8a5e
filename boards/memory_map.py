"""Addresses on the bus of a board's system, which gateware and driver share."""

from __future__ import annotations

__all__ = [
    "CSR_PAGES", "ENGINE", "ENGINE_BYTES", "FRAME_LIST", "FRAME_LIST_BYTES", "MAIN_RAM",
]  # fmt: skip

CSR_PAGES = {
    name: number
    for number, name in enumerate(("ctrl", "sdram", "scanout", "engine", "player", "video_timing"))
}
"""Page of each group of LiteX's registers, from address 0. With a processor these, the list and the
engine lie :data:`splatline.boards.processor.REGISTERS` higher."""

FRAME_LIST = 0x0001_0000
"""The player's list: of each frame the byte address in SDRAM, and the number of 32-bit words."""

FRAME_LIST_BYTES = 0x800

ENGINE = 0x0002_0000
"""The engine's registers (``docs/registers.md``)."""

ENGINE_BYTES = 0x4000

MAIN_RAM = 0x4000_0000
"""SDRAM."""
