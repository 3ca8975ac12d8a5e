"""The devices that an engine fits: LUTs, flip-flops, block RAMs and multipliers of two families.

The numbers are those of the vendors' data sheets: Xilinx DS031 (Virtex-II) and DS180 (Artix-7). A
block RAM has 18 kbit and is 36 bits wide on both its ports, as the budgets count it. A block RAM of
an Artix-7 is two of these. Its LUTs have six inputs, so an engine takes fewer than its budget says.
An ECP5 has ports of 18 bits that read and write; ``splatline pnr`` counts its block RAMs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

__all__ = ["FAMILIES", "FpgaDevice", "smallest_device"]


class FpgaDevice(NamedTuple):
    """A device: its name, LUTs, flip-flops, block RAMs of 18 kbit, and multipliers."""

    name: str
    lut4: int
    ff: int
    bram: int
    mult: int


VIRTEX2 = (
    FpgaDevice("XC2V40", 512, 512, 4, 4),
    FpgaDevice("XC2V80", 1024, 1024, 8, 8),
    FpgaDevice("XC2V250", 3072, 3072, 24, 24),
    FpgaDevice("XC2V500", 6144, 6144, 32, 32),
    FpgaDevice("XC2V1000", 10240, 10240, 40, 40),
    FpgaDevice("XC2V1500", 15360, 15360, 48, 48),
    FpgaDevice("XC2V2000", 21504, 21504, 56, 56),
    FpgaDevice("XC2V3000", 28672, 28672, 96, 96),
    FpgaDevice("XC2V4000", 46080, 46080, 120, 120),
    FpgaDevice("XC2V6000", 67584, 67584, 144, 144),
    FpgaDevice("XC2V8000", 93184, 93184, 168, 168),
)

ARTIX7 = (
    FpgaDevice("XC7A12T", 8000, 16000, 40, 40),
    FpgaDevice("XC7A15T", 10400, 20800, 50, 45),
    FpgaDevice("XC7A25T", 14600, 29200, 90, 80),
    FpgaDevice("XC7A35T", 20800, 41600, 100, 90),
    FpgaDevice("XC7A50T", 32600, 65200, 150, 120),
    FpgaDevice("XC7A75T", 47200, 94400, 210, 180),
    FpgaDevice("XC7A100T", 63400, 126800, 270, 240),
    FpgaDevice("XC7A200T", 134600, 269200, 730, 740),
)

FAMILIES = {"Virtex-II": VIRTEX2, "Artix-7": ARTIX7}
"""Devices of each family, the smallest first."""


def smallest_device(family: str, counts: Mapping[str, int]) -> str | None:
    """Return the name of the smallest device of a family that an engine fits; None: there is none.

    ``counts`` has ``lut4``, ``ff``, ``bram`` and ``mult``, as a budget has.
    """
    return next(
        (
            device.name
            for device in FAMILIES[family]
            if all(counts[kind] <= getattr(device, kind) for kind in device._fields[1:])
        ),
        None,
    )
