"""Inputs that a contract allows and no host of ours sends: odd table writes, odd rasters."""

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.contract.raster_beats import put_field

from .program import Act

__all__ = ["odd_beats", "odd_writes"]


def odd_writes(act: Act, rng: np.random.Generator, config: EngineConfig) -> Act:
    """Add table writes that are ignored, in random order, with random bits above the data."""
    items = act.items["tables"]
    address, data = config.table_address, config.table_data
    junk = np.zeros((40, items.payload.shape[1]), np.uint64)
    put_field(junk, address, rng.integers(config.register_base + 6, address.mask + 1, 40))
    put_field(junk, data, rng.integers(0, 1 << min(63, data.width), 40))
    writes = np.concatenate([items.payload, junk])[rng.permutation(len(items.payload) + 40)]
    items.payload = writes
    items.after = {}
    words = act.items["codewords"]
    words.shown = {"tables": np.full(len(words.payload), len(writes))}
    return act


def odd_beats(act: Act, rng: np.random.Generator, frame: Frame) -> Act:
    """Make the initial raster odd, but the same in meaning.

    Words of a line are shuffled, some come twice, background has colours, beats lie outside of the
    image or above the line before, words of background alone come, the end beat has random bits.
    """
    config = frame.config
    beats = act.items["initial"].payload
    beats = beats[:-1]
    line_field, word_field = config.raster_line, config.raster_word
    values = [int.from_bytes(row.astype("<u8").tobytes(), "little") for row in beats]

    def get(value, field):
        return value >> field.lsb & field.mask

    def put(value, field, number):
        return value & ~(field.mask << field.lsb) | number << field.lsb

    def painted(value):
        """Give pixels of background a colour."""
        for pixel in range(config.raster_pixels):
            if get(value, config.raster_depth(pixel)) == config.background_depth:
                colour = config.raster_colour(pixel)
                value = put(value, colour, int(rng.integers(1 << colour.width)))
        return value

    lines = sorted({get(value, line_field) for value in values})
    words = -(-frame.width // config.raster_pixels)
    result: list[int] = []
    for line in lines:
        own = [painted(value) for value in values if get(value, line_field) == line]
        for n in rng.permutation(len(own)):
            if rng.random() < 0.3:  # the second of two counts
                other = own[int(rng.integers(len(own)))]
                result.append(put(other, word_field, get(own[n], word_field)))
            result.append(own[n])
            if result and rng.random() < 0.3:
                past = put(own[n], word_field, int(rng.integers(words, word_field.mask + 1)))
                below = put(
                    own[n], line_field, int(rng.integers(frame.height, line_field.mask + 1))
                )
                above = put(own[n], line_field, max(0, line - 1 - int(rng.integers(9))))
                choices = [past, below] + ([above] if line else [])
                result.append(choices[int(rng.integers(len(choices)))])
    if lines and lines[-1] < frame.height - 1:
        nothing = put(painted(_background(config)), line_field, lines[-1] + 1)
        result.append(nothing)
    end = 1 << config.raster_end.lsb | int(rng.integers(1 << 62))
    result.append(end)
    limbs = beats.shape[1]
    act.items["initial"].payload = np.array(
        [[value >> 64 * limb & (1 << 64) - 1 for limb in range(limbs)] for value in result],
        np.uint64,
    )
    act.items["initial"].after = {}
    return act


def _background(config: EngineConfig) -> int:
    """Return a beat in which nothing is drawn, of word 0."""
    depth = config.background_depth
    return sum(depth << config.raster_depth(pixel).lsb for pixel in range(config.raster_pixels))
