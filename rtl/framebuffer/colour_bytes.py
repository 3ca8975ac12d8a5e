"""The bytes of a colour."""

from __future__ import annotations

from amaranth.hdl import Const, Value
from amaranth.lib.data import View

from splatline.contract.config import EngineConfig
from splatline.rtl.lib.mux import pick

__all__ = ["colour_bytes", "level_byte"]


def level_byte(level: int, channel_bits: int) -> int:
    """Return the byte of a channel's level: 255 times its share of the largest level, rounded.

    These are the bytes of the picture that ``splatline render`` writes: ``Raster.to_rgb``, then
    ``plots.figure.rgb_levels``. No level lies half way between two bytes, as the largest is odd.
    """
    largest = (1 << channel_bits) - 1
    return (510 * level + largest) // (2 * largest)


def colour_bytes(colour: Value | View, config: EngineConfig) -> list[Value]:
    """Return the bytes red, green and blue of a stored colour."""
    bits = config.channel_bits
    channels = [Value.cast(colour)[bits * n :][:bits] for n in range(3)]
    if bits == 8:
        return channels
    levels = [Const(level_byte(level, bits), 8) for level in range(1 << bits)]
    return [pick(levels, channel) for channel in channels]
