"""docs/contract.md in plain Python, pixel by pixel: slow and simple, independent of golden."""

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame, Tables
from splatline.contract.presets import PAPER, PRESETS
from splatline.contract.raster import Raster

# Two more engines, at the limits of a configuration.
COLOURFUL = EngineConfig(
    name="colourful", intensity_bits=6, material_bits=5, x_bits=11, depth_bits=11, line_bits=11,
    channel_bits=8, coefficient_bits=8, colour_shift=6,
)  # fmt: skip
DEEP = EngineConfig(
    name="deepest", intensity_bits=1, material_bits=9, x_bits=12, depth_bits=16, line_bits=14,
    channel_bits=1, coefficient_bits=12, colour_shift=13,
)  # fmt: skip
CONFIGS = (*(config for config in PRESETS.values() if not config.plane), COLOURFUL, DEEP)


def widths(config):
    """Return the widths of the fields above SCANS, lowest first."""
    return {
        "d": config.intensity_bits, "s": config.intensity_bits, "m": config.material_bits,
        "x": config.x_bits, "z": config.depth_bits,
    }  # fmt: skip


def encode(rows, *, mode=0, config=PAPER, **fields):
    """Return a code word of (first, last) pairs."""
    word = mode
    for k, (first, last) in enumerate(rows):
        word |= (first | last << 3) << (1 + 6 * k)
    lsb = 25
    for name, width in widths(config).items():
        value = fields.pop(name, 0)
        assert 0 <= value < 1 << width, name
        word |= value << lsb
        lsb += width
    assert lsb == 64
    assert not fields
    return word


NOTHING = [(7, 0)] * 4
EVERYTHING = [(0, 7)] * 4


def advance(lines, config=PAPER):
    return encode(NOTHING, mode=1, x=lines, config=config)


def end(config=PAPER):
    return encode(NOTHING, mode=1, d=1, config=config)


def largest_tables(config=PAPER):
    """Return tables with the largest entries and I0."""
    shape = (1 << config.material_bits, 3)
    top = (1 << config.coefficient_bits) - 1
    ambient = np.full(3, (1 << config.ambient_bits) - 1)
    return Tables(ambient, np.full(shape, top), np.full(shape, top))


def random_tables(rng, config=PAPER):
    shape = (1 << config.material_bits, 3)
    top = 1 << config.coefficient_bits
    return Tables(
        rng.integers(0, 1 << config.ambient_bits, 3) >> rng.integers(0, 4),
        rng.integers(0, top, shape),
        rng.integers(0, top, shape),
    )


def random_frame(rng, count, size, config=PAPER):
    """Return a frame of random words that advance by few lines."""
    words = rng.integers(0, 1 << 64, count, dtype=np.uint64)
    fields = widths(config)
    x_lsb = 25 + fields["d"] + fields["s"] + fields["m"]
    # Most words are near the image, the others anywhere.
    near = rng.random(count) < 0.8
    x = rng.integers(0, min(size[0] + 3, 1 << config.x_bits), count).astype(np.uint64)
    clear = np.uint64(~(((1 << config.x_bits) - 1) << x_lsb) & (2**64 - 1))
    words[near] = words[near] & clear | x[near] << np.uint64(x_lsb)
    stream = []
    for word in words.tolist():
        if is_control(word):  # by chance: rare, but it would end the frame or leave the image
            continue
        stream.append(word)
        if rng.random() < (size[1] + 8) / count / 2:
            stream.append(advance(int(rng.integers(0, 4)), config))
    stream.append(end(config))
    return make_frame(stream, size, random_tables(rng, config), config)


def make_frame(words, size, tables=None, config=PAPER):
    if tables is None:
        tables = random_tables(np.random.default_rng(1), config)
    return Frame(np.array(words, np.uint64), tables, *size, config)


def bits(word, lsb, width):
    return word >> lsb & (1 << width) - 1


def rows_of(word):
    return [(bits(word, 1 + 6 * k, 3), bits(word, 4 + 6 * k, 3)) for k in range(4)]


def is_control(word):
    return bits(word, 0, 1) == 1 and all(first > last for first, last in rows_of(word))


def covers(word, row, column):
    """Return whether a code word's block has a pixel."""
    rows = rows_of(word)
    up = right = 0  # lines and columns by which the lower half is moved
    if bits(word, 0, 1) == 0:
        first, last = rows[3]
        if first >= 4 and last <= 3:
            up, right = 1, int((first + last) % 2 == 0)
            rows[3] = last, first
        elif rows[0][0] > rows[0][1]:
            right = rows[0][0] >> 1 & 1
    if row >= 4:  # the half rotation of the upper half, if there is one
        row, column = 7 - up - row, 7 + right - column
        if bits(word, 0, 1) == 1 or row < 0 or (up and row == 3):
            return False
    first, last = rows[row]
    return first <= column <= last


def shown(total, config):
    """Return a pixel's level of a channel's sum."""
    return min(total >> config.colour_shift, (1 << config.channel_bits) - 1)


def draw(frame, initial=None):
    """Return the picture of a frame by the contract."""
    config, tables = frame.config, frame.tables
    background = (1 << config.depth_bits) - 1
    if initial is None:
        initial = Raster.background(frame.width, frame.height, config)
    depth = initial.depth.tolist()
    colour = initial.colour.tolist()
    y = 0
    for word in frame.codewords.tolist():
        fields, lsb = {}, 25
        for name, width in widths(config).items():
            fields[name] = bits(word, lsb, width)
            lsb += width
        if is_control(word):
            if bits(word, 25, 1):
                break
            y += fields["x"]
            continue
        sums = [
            int(tables.ambient[channel])
            + int(tables.diffuse[fields["m"], channel]) * fields["d"]
            + int(tables.specular[fields["m"], channel]) * fields["s"]
            for channel in range(3)
        ]
        for row in range(8):
            for column in range(9):
                line, place = y - 4 + row, fields["x"] + column
                inside = 0 <= line < frame.height and place < frame.width
                if inside and covers(word, row, column) and fields["z"] < depth[line][place]:
                    depth[line][place] = fields["z"]
                    colour[line][place] = [shown(total, config) for total in sums]
    assert background == config.background_depth
    size = (frame.height, frame.width)
    return Raster(
        np.array(depth, np.uint16).reshape(size),
        np.array(colour, np.uint8).reshape(*size, 3),
        config,
    )
