"""The colour of a pixel against the real-valued equation, min(max, kd D + ks S), in levels."""

import numpy as np
import pytest

from splatline.contract.frame import Frame
from splatline.contract.presets import PRESETS
from splatline.host.encode.sort_by_line import advance_word, end_word
from splatline.host.pipeline import make_frame
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.materials import Materials
from splatline.sim import golden
from splatline.sim.stress.small_clouds import fitted, sphere

CELL = 4
"""Pixels a side of an element."""

PALETTE = np.array(
    [[255, 255, 255], [0, 0, 0], [1, 127, 254], [250, 40, 30], [3, 200, 100], [66, 67, 68]],
    np.uint8,
)

NOTHING_SHOWN = 1e-9
"""Of the real-valued equation's own arithmetic."""


def tables_of(config, gloss):
    """The tables that the host makes for the palette."""
    scene = fitted(sphere(len(PALETTE)))
    materials = Materials(PALETTE, np.arange(len(PALETTE), dtype=np.uint8))
    return make_frame(
        scene.cloud,
        scene.view,
        radii=scene.radii,
        lighting=Lighting(gloss=gloss),
        materials=materials,
        config=config,
    ).tables


def every_intensity(config, tables, material):
    """A frame with one 4 x 4 element for every D and S of a material, and its picture by cells."""
    count = 1 << config.intensity_bits
    diffuse, specular = (part.ravel() for part in np.mgrid[:count, :count])
    columns = config.max_width // CELL
    rows = -(-len(diffuse) // columns)
    place = np.arange(len(diffuse))
    scans = sum((CELL - 1) << config.last(row).lsb for row in range(4))
    words = np.full(len(place), 1 << config.mode.lsb | scans, np.uint64)
    for field, value in (
        (config.diffuse, diffuse),
        (config.specular, specular),
        (config.material, np.full(len(place), material)),
        (config.x, place % columns * CELL),
    ):
        words |= value.astype(np.uint64) << np.uint64(field.lsb)
    stream = []
    for row in range(rows):
        # Rows 0..3 of a block lie on the four lines before the current one.
        stream += [[advance_word(CELL, config)], words[row * columns : (row + 1) * columns]]
    stream = np.concatenate([np.asarray(part, np.uint64) for part in stream])
    stream = np.append(stream, np.uint64(end_word(config)))
    if config.plane:  # flat ones
        stream = np.stack([stream, np.zeros_like(stream)], axis=1)
    frame = Frame(stream, tables, config.max_width, rows * CELL, config)
    picture = golden.render(frame)
    levels = picture.colour.reshape(rows, CELL, columns, CELL, 3).swapaxes(1, 2)
    levels = levels.reshape(-1, CELL * CELL, 3)[: len(place)].astype(np.float64)
    return diffuse[:, np.newaxis], specular[:, np.newaxis], levels


@pytest.mark.parametrize("gloss", [0.0, 0.25, 1.0])
@pytest.mark.parametrize("name", PRESETS)
def test_colour_is_within_half_a_level_of_the_equation(name, gloss):
    """With the tables as they are: I0 is no part of the equation but the rounding to nearest."""
    config = PRESETS[name]
    tables = tables_of(config, gloss)
    for material in range(len(PALETTE)):
        diffuse, specular, levels = every_intensity(config, tables, material)
        real = tables.diffuse[material] * diffuse + tables.specular[material] * specular
        real = np.minimum(real / (1 << config.colour_shift), config.channel_max)[:, np.newaxis]
        assert np.abs(levels - real).max() <= 0.5
        assert (levels == levels[:, :1]).all()


@pytest.mark.parametrize("gloss", [0.0, 0.25, 1.0])
@pytest.mark.parametrize("name", PRESETS)
def test_colour_is_within_the_stated_bound_of_the_true_colour(name, gloss):
    """Against max (c d + gloss s) with c, d, s and gloss real: what the host rounds is counted.

    - Half a level: the shift.
    - kd and ks are each off by half a unit: D + S times half of 2^-shift.
    - D and S are each off by half a unit of an intensity: (c + gloss) max / 2 units of it.
    """
    config = PRESETS[name]
    full = (1 << config.intensity_bits) - 1
    tables = tables_of(config, gloss)
    # The real intensities that the host rounds to D and S lie up to half a unit on either side.
    rng = np.random.default_rng(1)
    for material, colour in enumerate(PALETTE / 255.0):
        diffuse, specular, levels = every_intensity(config, tables, material)
        levels = levels[:, 0]
        tables_off = 0.5 * (diffuse + specular) / (1 << config.colour_shift)
        intensity_off = 0.5 / full * (colour + gloss) * config.channel_max
        bound = 0.5 + tables_off + intensity_off + NOTHING_SHOWN
        assert bound.max() < (3.1 if config.channel_bits == 8 else 0.75)
        for _ in range(4):
            true = [
                np.clip(part + rng.uniform(-0.5, 0.5, part.shape), 0, full) / full
                for part in (diffuse, specular)
            ]
            real = np.minimum(colour * true[0] + gloss * true[1], 1.0) * config.channel_max
            assert (np.abs(levels - real) <= bound).all()


@pytest.mark.parametrize("name", PRESETS)
def test_brighter_is_never_darker(name):
    config = PRESETS[name]
    tables = tables_of(config, 0.25)
    count = 1 << config.intensity_bits
    for material in range(len(PALETTE)):
        *_, levels = every_intensity(config, tables, material)
        levels = levels.reshape(count, count, -1)
        assert (np.diff(levels, axis=0) >= 0).all()
        assert (np.diff(levels, axis=1) >= 0).all()


@pytest.mark.parametrize("name", PRESETS)
def test_white_in_full_light_is_the_largest_level_and_black_in_none_the_least(name):
    config = PRESETS[name]
    tables = tables_of(config, 0.0)
    *_, white = every_intensity(config, tables, 0)
    *_, black = every_intensity(config, tables, 1)
    assert (white[-1] == config.channel_max).all()
    assert (black[0] == 0).all()
