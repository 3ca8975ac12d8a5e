"""Where the words of a window lie: in eight banks, and in stretches of marks."""

from .format import EngineConfig

__all__ = ["BANKS", "bank_address_bits", "column_bits", "stretch_bits"]

BANKS = 8
"""Banks of the window; bank ``(line + 4 * (word % 2)) % 8`` holds a word of a line."""


def bank_address_bits(config: EngineConfig) -> int:
    """Return the address bits of a bank: two for its lines, the rest for half a line's words.

    A bank holds the even words of two lines of the window and the odd words of two others.
    """
    return 2 + config.word_bits - 1


def column_bits(config: EngineConfig) -> int:
    """Return the bits of a word's number among those of its stretch and bank: up to eight words."""
    return min(3, config.word_bits - 1)


def stretch_bits(config: EngineConfig) -> int:
    """Return the bits of a stretch's number in its line; a stretch has up to sixteen words."""
    return config.word_bits - 1 - column_bits(config)
