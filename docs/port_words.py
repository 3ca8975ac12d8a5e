"""The words that the timing diagrams show, with their labels: preset ``paper``, a small image."""

from splatline.contract.fields import Register
from splatline.contract.presets import PAPER
from splatline.host.encode.sort_by_line import advance_word, end_word

__all__ = [
    "CLEARED",
    "CONFIG",
    "LINES",
    "beat_label",
    "elements",
    "initial_beats",
    "table_writes",
]

CONFIG = PAPER
LINES = 24

CLEARED = CONFIG.clear_cycles + 5
"""A cycle after the window is cleared."""


def elements(count):
    """Return a frame's code words with labels: elements on lines 4 and 16, and the end word."""
    rows = [(0, 7)] * 4

    def element(x, z, wide):
        scans = sum((first | last << 3) << 6 * row for row, (first, last) in enumerate(wide))
        fields = ((0, CONFIG.mode), (scans, CONFIG.scans), (x, CONFIG.x), (z, CONFIG.z))
        return sum(value << place.lsb for value, place in fields)

    words = [("+4", advance_word(4, CONFIG))]
    words += [(f"e{n}", element(3 + 4 * n, 100 - n, rows)) for n in range(count)]
    words += [("+12", advance_word(12, CONFIG)), (f"e{count}", element(4, 7, [(2, 5)] * 4))]
    return [*words, ("end", end_word(CONFIG))]


def table_writes(load=0):
    """Return table writes with labels: a material, the size of the image, what it starts from."""
    base = CONFIG.register_base
    writes = {
        "mat 0": (0, 0o777777),
        "col": (base + Register.LAST_COLUMN, 15),
        "line": (base + Register.LAST_LINE, LINES - 1),
        "ctl": (base + Register.CONTROL, load),
    }
    shift = CONFIG.table_address.lsb
    return [(name, address << shift | value) for name, (address, value) in writes.items()]


def initial_beats():
    """Return an initial raster with labels: drawn beats on three lines, and the end beat."""

    def beat(line, word):
        value = line << CONFIG.raster_line.lsb | word << CONFIG.raster_word.lsb
        for pixel in range(CONFIG.raster_pixels):
            value |= 50 << CONFIG.raster_depth(pixel).lsb
        return f"{line}:{word}", value

    beats = [beat(line, word) for line in range(3) for word in range(2)]
    return [*beats, ("end", 1 << CONFIG.raster_end.lsb)]


def beat_label(beat):
    """Return line and word of a beat, or ``end``."""
    if beat >> CONFIG.raster_end.lsb & 1:
        return "end"
    line = beat >> CONFIG.raster_line.lsb & CONFIG.raster_line.mask
    return f"{line}:{beat >> CONFIG.raster_word.lsb & CONFIG.raster_word.mask}"
