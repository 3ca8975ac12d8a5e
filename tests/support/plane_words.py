"""docs/contract.md, "Plane words", in plain Python, pixel by pixel: independent of golden."""

import itertools

import numpy as np

from splatline.contract.frame import Frame
from splatline.contract.presets import PLANE
from splatline.contract.raster import Raster
from splatline.contract.variants import CONFIGS as CONFIGS_BY_NAME
from tests.support.codewords import bits, random_tables, rows_of, shown

# More engines: the one for wide images, and two at the limits of a configuration: narrow slopes
# with the deepest depth and the widest image, and the widest slopes with the fewest levels.
WIDE = CONFIGS_BY_NAME["plane-4096"]
DEEP = PLANE.replace(
    name="deep-plane", depth_bits=16, slope_bits=5, x_bits=12, intensity_bits=5, material_bits=9,
    colour_shift=7,
)  # fmt: skip
FLAT = PLANE.replace(
    name="flat-plane", depth_bits=2, slope_bits=8, x_bits=6, intensity_bits=9, material_bits=3,
    line_bits=5, channel_bits=1,
)  # fmt: skip
CONFIGS = (PLANE, WIDE, DEEP, FLAT)

NOTHING = [(1, 0)] * 4


def widths(config):
    """Return lowest bit and width of each field above SCANS."""
    low = {"d": config.intensity_bits, "s": config.intensity_bits, "m": config.material_bits,
           "x": config.x_bits}  # fmt: skip
    high = {"raised": 1, "first_out": 1, "last_out": 1, "a": config.slope_bits,
            "b": config.slope_bits, "scale": 2, "z": config.depth_bits + 1}  # fmt: skip
    found, lsb = {"sides": (56, 8)}, 25
    for name, width in low.items():
        found[name] = lsb, width
        lsb += width
    lsb = 64
    for name, width in high.items():
        found[name] = lsb, width
        lsb += width
    return found


def encode(rows, *, mode=1, config=PLANE, **fields):
    """Return a plane word of (first, last) pairs; slopes may be negative."""
    word = mode
    for k, (first, last) in enumerate(rows):
        word |= (first | last << 3) << (1 + 6 * k)
    for name, (lsb, width) in widths(config).items():
        value = fields.pop(name, 0)
        if name in ("a", "b"):
            assert -(1 << width - 1) <= value < 1 << width - 1
            value &= (1 << width) - 1
        assert 0 <= value < 1 << width, name
        word |= value << lsb
    assert not fields
    return word


def advance(lines, config=PLANE):
    return encode(NOTHING, x=lines, config=config)


def end(config=PLANE):
    return encode(NOTHING, d=1, config=config)


def array_of(words):
    """Return Python integers as code words of a frame."""
    low = [word & (1 << 64) - 1 for word in words]
    return np.array([low, [word >> 64 for word in words]], np.uint64).T.copy()


def integers_of(codewords):
    """Return the code words of a frame as Python integers."""
    return [low | high << 64 for low, high in codewords.tolist()]


def make_frame(words, size, tables=None, config=PLANE):
    if tables is None:
        tables = random_tables(np.random.default_rng(1), config)
    return Frame(array_of([*words, end(config)]), tables, *size, config)


def random_word(rng, size, config=PLANE):
    """Return 96 random bits in which every field often is at an end of its range."""
    word = int(rng.integers(0, 1 << 64, dtype=np.uint64)) | int(rng.integers(0, 1 << 32)) << 64
    for name, (lsb, width) in widths(config).items():
        top = (1 << width) - 1
        ends = [0, 1, top >> 1, (top >> 1) + 1, top - 1, top]
        value = ends[rng.integers(len(ends))] if rng.random() < 0.3 else bits(word, lsb, width)
        if name == "x" and rng.random() < 0.8:
            value = int(rng.integers(0, min(size[0] + 2, top + 1)))
        word = word & ~(top << lsb) | (value & top) << lsb
    return word


def random_frame(rng, count, size, config=PLANE):
    """Return a frame of random words that advance by few lines; no word ends it but the last."""
    stream = []
    while len(stream) < count:
        word = random_word(rng, size, config)
        if is_control(word):  # by chance: rare, but it would end the frame or leave the image
            continue
        stream.append(word)
        if rng.random() < (size[1] + 8) / count / 2:
            stream.append(advance(int(rng.integers(0, 4)), config) | int(rng.integers(64)) << 90)
    return make_frame(stream, size, random_tables(rng, config), config)


def extreme_frames(config):
    """Yield frames of elements that have every extreme of slopes, scale and Z, at every place.

    A sum has its largest and least values at the corners of a block, for either sign of either
    slope. The hardware takes what lies before a block from its column modulo the pixels of a word
    and its line modulo four, so each combination is drawn at all of these. Elements lie apart.
    """
    half, top = 1 << config.slope_bits - 1, (1 << config.depth_bits + 1) - 1
    depths = 0, 1, top // 2 + 1, top - 3, top
    planes = list(
        itertools.product(
            (-half, half - 1, 0), (-half, half - 1, -1), range(4), depths,
            range(config.pixels_per_word),
        )
    )  # fmt: skip
    width, height = min(config.max_width, 512), min(config.max_height, 512)
    across, rows = (width - 8) // 12, (height - 16) // 12 + 1
    for down in range(4):
        for begin in range(0, len(planes), across * rows):
            words = [advance(4 + down, config)]
            for number, (a, b, scale, z, right) in enumerate(planes[begin : begin + across * rows]):
                if number and number % across == 0:
                    words.append(advance(12, config))
                x = 12 * (number % across) + right
                fields = {"x": x, "z": z, "a": a, "b": b, "scale": scale}
                words.append(encode([(0, 7)] * 4, mode=0, config=config, **fields))
            yield make_frame(words, (width, height), config=config)


def is_control(word):
    return bits(word, 0, 1) == 1 and all(first > last for first, last in rows_of(word))


def covers(word, row, column, config=PLANE):
    """Return whether a plane word's block has a pixel."""
    rows = rows_of(word)
    if row < 4:
        return rows[row][0] <= column <= rows[row][1]
    if bits(word, 0, 1) == 1:
        return False
    raised = bits(word, 64, 1)
    k = (6 if raised else 7) - row
    if k < 0:
        return False
    first, last = rows[k]
    if first > last:
        return False
    one, two = bits(word, 56 + 2 * k, 1), bits(word, 57 + 2 * k, 1)
    new_first = 7 - last + (-one if bits(word, 65, 1) else one)
    new_last = 7 - first + (two if bits(word, 66, 1) else -two)
    return min(max(new_first, 0), 7) <= column <= min(max(new_last, 0), 7)


def depth_at(word, row, column, config=PLANE):
    """Return the depth of a pixel of a plane word's block."""
    fields = {name: bits(word, *place) for name, place in widths(config).items()}
    half = 1 << config.slope_bits - 1
    shift = [0, 1, 2, 4][fields["scale"]]
    a, b = (((fields[name] ^ half) - half) * 2**shift for name in ("a", "b"))
    total = 2 * fields["z"] + column * a + row * b
    return min(max(total // 4, 0), 2**config.depth_bits - 1)


def draw(frame, initial=None):
    """Return the picture of a frame by the contract."""
    config, tables = frame.config, frame.tables
    if initial is None:
        initial = Raster.background(frame.width, frame.height, config)
    depth = initial.depth.tolist()
    colour = initial.colour.tolist()
    places = widths(config)
    y = 0
    for word in integers_of(frame.codewords):
        fields = {name: bits(word, *place) for name, place in places.items()}
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
            for column in range(8):
                line, place = y - 4 + row, fields["x"] + column
                if not (0 <= line < frame.height and place < frame.width):
                    continue
                z = depth_at(word, row, column, config)
                if covers(word, row, column, config) and z < depth[line][place]:
                    depth[line][place] = z
                    colour[line][place] = [shown(total, config) for total in sums]
    size = (frame.height, frame.width)
    return Raster(
        np.array(depth, np.uint16).reshape(size),
        np.array(colour, np.uint8).reshape(*size, 3),
        config,
    )
