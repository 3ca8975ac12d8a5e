"""Where the words of a window lie: in its banks, and in stretches of marks.

Of eight banks ``(line + 4 * (word % 2)) % 8`` holds a word, of sixteen
``line % 8 + 8 * (word % 2)``.
"""

from amaranth.hdl import Const

from .format import EngineConfig

__all__ = ["bank_address_bits", "column_bits", "residue_bits", "stretch_bits", "turned"]


def residue_bits(config: EngineConfig) -> int:
    """Return how many of a line's lowest bits say in which two banks it lies."""
    return (config.banks // 2).bit_length() - 1


def turned(config: EngineConfig, line):
    """Return whether a line's even words lie in the upper half of the banks, not in the lower."""
    return line[2] if config.banks == 8 else Const(0)


def bank_address_bits(config: EngineConfig) -> int:
    """Return the address bits of a bank: some for its lines, the rest for half a line's words.

    A bank of eight has the even words of two lines of the window and the odd words of two others, a
    bank of sixteen the even or the odd words of two lines.
    """
    return config.slot_bits - residue_bits(config) + config.word_bits - 1


def column_bits(config: EngineConfig) -> int:
    """Return the bits of a word's number among those of its stretch and bank: up to eight words."""
    return min(3, config.word_bits - 1)


def stretch_bits(config: EngineConfig) -> int:
    """Return the bits of a stretch's number in its line; a stretch has up to sixteen words."""
    return config.word_bits - 1 - column_bits(config)
