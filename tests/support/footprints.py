"""Footprints for the benches of what comes after the decoder, packed from pixels."""

from splatline.rtl.layouts import FootprintLayout
from splatline.sim.cosim.blocks import pack
from tests.support.bench_config import CONFIG

__all__ = ["FOOTPRINT", "PIXELS", "Footprints", "end_token", "footprint", "place_of_word"]

FOOTPRINT = FootprintLayout(CONFIG)
PIXELS = CONFIG.pixels_per_word
ROOM = CONFIG.window_lines - 8
"""An element comes once its first line is less than so many below the window's first one."""


def place_of_word(line, word):
    """Bank and address of a word, in eight banks or in sixteen."""
    odd, half = word % 2, CONFIG.banks // 2
    bank = (line + 4 * odd) % 8 if half == 4 else line % 8 + 8 * odd
    return bank, line % 16 // half << CONFIG.word_bits - 1 | word // 2


def footprint(top, x, spans, z=0, width=512, height=512):
    """A footprint of spans {row of the block: (first column, last column)}, clipped.

    Return its bits and the pixels it covers, {(line, column)}.
    """
    word = x // PIXELS
    halves = {"upper": [None] * 4, "lower": [None] * 4}
    empty = {"first": 0, "last": 0, "words": 0}
    pixels = set()
    for row in range(8):
        line = top + row
        span = empty
        if row in spans and 0 <= line < height:
            first, last = (x % PIXELS + column for column in spans[row])
            touched = [
                first // PIXELS <= j <= last // PIXELS and word + j <= (width - 1) // PIXELS
                for j in range(CONFIG.block_words)
            ]
            span = {
                "first": first,
                "last": last,
                "words": sum(bit << j for j, bit in enumerate(touched)),
            }
            covered = {(line, PIXELS * word + p) for p in range(first, last + 1)}
            pixels |= {(line, column) for line, column in covered if column < width}
        halves["upper" if row < 4 else "lower"][line % 4] = span
    groups = [(top + (q - top) % 4) // 4 % 4 for q in range(4)]
    bits = pack(FOOTPRINT, **halves, upper_group=groups, word=word, z=z, top=top, end=0)
    return bits, pixels


def end_token():
    """The token that ends a frame."""
    empty = [{"first": 0, "last": 0, "words": 0}] * 4
    lowest = (1 << CONFIG.line_bits + 1) - 1
    return pack(FOOTPRINT, upper=empty, lower=empty, end=1, top=lowest)


class Footprints:
    """What a decoder offers: elements whose lines are in the window, and then the end of the frame.

    Its length is the number of them that may come by now, for a source that looks there before
    each.

    Parameters
    ----------
    elements
        First line of each element's block, and its bits.
    """

    def __init__(self, elements=()):
        self.elements = list(elements)
        self.oldest = 0  # of the window, in the last cycle in which it did not stand still
        self.near = 0

    def __len__(self):
        while self.near < len(self.elements) and self.elements[self.near][0] - self.oldest < ROOM:
            self.near += 1
        return self.near + (self.near == len(self.elements))

    def __getitem__(self, n):
        return self.elements[n][1] if n < len(self.elements) else end_token()

    def shown(self, rng, sent):
        """Bits in a cycle in which none is offered: the next element's ``top``, and nonsense."""
        top = self.elements[min(sent, len(self.elements) - 1)][0] if self.elements else -4
        if sent > len(self.elements):
            top = -4  # of the next frame
        place = FOOTPRINT["top"]
        mask = (1 << place.width) - 1
        return (
            rng.getrandbits(FOOTPRINT.size) & ~(mask << place.offset) | (top & mask) << place.offset
        )
