"""Tiles for the benches of the lanes: packed from pixels, and taken apart again."""

import itertools

from splatline.rtl.tiles.layouts import TileLayout
from tests.support.bench_config import CONFIG

__all__ = ["LOWEST", "ROOM", "Tiles", "overlap", "pack_tile", "tiles_of", "unpack_tile"]

PLACES = {name: (field.offset, field.width) for name, field in TileLayout(CONFIG)}
WORDS = 1 << CONFIG.word_bits
LOWEST = (1 << CONFIG.line_bits + 1) - 1
"""``top`` of the token that ends a frame."""
ROOM = CONFIG.window_lines - 4
"""A tile comes once its first line is less than so many below the window's first one."""


def pack_tile(**values):
    """Bits of a tile; arrays are given as integers, their first element lowest.

    What is no field of it, such as the colour that comes beside it, is left out.
    """
    bits = 0
    for name, value in values.items():
        if name in PLACES:
            offset, width = PLACES[name]
            bits |= (value & (1 << width) - 1) << offset
    return bits


def unpack_tile(bits):
    """The fields of a tile, arrays as integers."""
    return {name: bits >> offset & (1 << width) - 1 for name, (offset, width) in PLACES.items()}


def tiles_of(top, x, spans, width=512, height=512):
    """The tiles of spans {row of the block: (first column, last column)}, one after the other.

    Return the fields of each, and the pixels of the image that they draw.
    """
    tiles, drawn = [], set()
    for lower in (0, 1):
        for right in (0, 1):
            pixels = [
                (top + row, x + column)
                for row, (first, last) in spans.items()
                for column in range(first, last + 1)
                if (row // 4, column // 4) == (lower, right)
            ]
            if not pixels:
                continue
            line, column = top + 4 * lower, x + 4 * right
            inside = {(a, b) for a, b in pixels if 0 <= a < height and b // 4 <= (width - 1) // 4}
            drawn |= {(a, b) for a, b in inside if b < width}
            groups = [(line + (q - line) % 4) // 4 % 4 for q in range(4)]
            word = column // 4
            tiles.append(
                {
                    "mask": sum(1 << 4 * (a % 4) + b % 4 for a, b in inside),
                    "group": sum(group << 2 * q for q, group in enumerate(groups)),
                    "words": word % WORDS | (word + 1) % WORDS << CONFIG.word_bits,
                    "next": (1 << column % 4) - 1,
                    "top": top,
                    "line": line,
                }
            )
    return tiles, drawn


def overlap(tile, other):
    """Whether the squares of two tiles overlap in the window, whatever they draw."""

    def sides(tile):
        words = [tile["words"] % WORDS, tile["words"] // WORDS]
        lines = {4 * (tile["group"] >> 2 * q & 3) + q for q in range(4)}
        return lines, {4 * words[tile["next"] >> p & 1] + p for p in range(4)}

    return all(a & b for a, b in zip(sides(tile), sides(other), strict=True))


def end_tile():
    """The token that ends a frame."""
    return {"end": 1, "top": LOWEST}


class Tiles:
    """What a tiler offers: tiles whose lines are in the window, and then the end of the frame.

    Its length is the number of tiles that may come by now, for a source that looks there before
    each. A tile is told that it meets the one before if that was just taken.

    Parameters
    ----------
    tiles
        Fields of each; ``line`` is the first one of its square.
    oldest
        Tells the first line in the window.
    just_taken
        Tells whether the tile before was taken in the cycle before this one.
    """

    def __init__(self, tiles, oldest, just_taken):
        self.tiles, self.oldest, self.just_taken = [*tiles, end_tile()], oldest, just_taken
        pairs = itertools.pairwise(tiles)
        self.meets = [False, *(overlap(a, b) for a, b in pairs), False]
        self.near = 0

    @property
    def whole(self):
        """Number of all tiles and the end."""
        return len(self.tiles)

    def __len__(self):
        oldest = self.oldest()
        while self.near < self.whole and self.tiles[self.near].get("line", 0) - oldest < ROOM:
            self.near += 1
        return self.near

    def __getitem__(self, n):
        return pack_tile(**self.tiles[n], meets=self.meets[n] and self.just_taken())
