"""Tiles for the benches of the lanes: packed from pixels, and taken apart again."""

import itertools

from presets import CONFIG

from splatline.rtl.layouts import TileLayout

__all__ = ["Tiles", "places_of", "tiles_of", "unpack_tile"]

PLACES = {name: (field.offset, field.width) for name, field in TileLayout(CONFIG)}
WORDS = 1 << CONFIG.word_bits


def pack_tile(**values):
    """Bits of a tile; arrays are given as integers, their first element lowest."""
    bits = 0
    for name, value in values.items():
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
                    "lower": lower,
                    "top": top,
                }
            )
    return tiles, drawn


def places_of(tile):
    """Where a tile, given by its fields, draws: {(place of the line in the window, column)}."""
    words = [tile["words"] % WORDS, tile["words"] // WORDS]
    return {
        (4 * (tile["group"] >> 2 * q & 3) + q, 4 * words[tile["next"] >> p & 1] + p)
        for q in range(4)
        for p in range(4)
        if tile["mask"] >> 4 * q + p & 1
    }


def end_tile():
    """The token that ends a frame."""
    return {"end": 1, "top": (1 << CONFIG.line_bits + 1) - 1}


class Tiles:
    """What a tiler offers: a tile is told that it meets the one before if that was just taken."""

    def __init__(self, tiles, just_taken):
        self.tiles, self.just_taken = [*tiles, end_tile()], just_taken
        places = [places_of(tile) if "mask" in tile else set() for tile in self.tiles]
        self.meets = [False, *(bool(a & b) for a, b in itertools.pairwise(places))]

    def __len__(self):
        return len(self.tiles)

    def __getitem__(self, n):
        return pack_tile(**self.tiles[n], meets=self.meets[n] and self.just_taken())
