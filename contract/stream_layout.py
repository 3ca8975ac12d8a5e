"""Fields and widths of AXI4-Stream words, for texts, JSON and the C header."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["StreamField", "padding_of", "stream_bytes"]


class StreamField(NamedTuple):
    """A field of a word on a stream, or several fields of one width side by side.

    Parameters
    ----------
    name
        In small letters.
    lsb
        Lowest bit of the first one in the word.
    width
        Bits of each.
    number
        How many there are, side by side.
    meaning
        One phrase.
    """

    name: str
    lsb: int
    width: int
    number: int
    meaning: str

    @property
    def end(self) -> int:
        """The bit above the last one."""
        return self.lsb + self.number * self.width


def stream_bytes(bits: int) -> int:
    """Return the bytes of TDATA for words of so many bits: the next power of two, at least 8.

    A word is then whole 64-bit limbs, and vendors' DMA cores accept its width.
    """
    return max(8, 1 << (-(-bits // 8) - 1).bit_length())


def padding_of(
    begin: int, end: int, name: str = "padding", meaning: str = "0"
) -> list[StreamField]:
    """Return the field that fills a word from bit ``begin`` up to ``end``; none if it is empty."""
    return [StreamField(name, begin, end - begin, 1, meaning)] if end > begin else []
