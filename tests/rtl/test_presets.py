"""Frames of every preset through its Verilog: golden's pictures, the cycle model's cycles."""

import numpy as np
import pytest

from splatline.contract.frame import Frame, Tables
from splatline.contract.presets import PAPER, SWIFT_PLANE
from splatline.contract.raster import Raster
from splatline.host.encode.sort_by_line import advance_word
from splatline.sim.cosim.player.frames import Job, play
from splatline.sim.cycles.cycles import count_cycles
from tests.support import codewords as cw
from tests.support import plane_words as pw
from tests.support.bench_config import OTHERS
from tests.support.engines import engine, mismatches
from tests.support.random_frames import films, frame_of, nonsense, random_raster, shapes, word
from tests.support.scene_frames import scene_frame

FULL = [(0, 7)] * 4
RATES = [
    {},
    {"codeword": 0.4},
    {"raster": 0.1},
    {"codeword": 0.7, "raster": 0.5, "initial": 0.3, "table": 0.3},
    {"codeword": 1.0, "raster": 0.9, "initial": 0.9, "table": 0.9},
]


def with_stalls(rng, config):
    """Elements like a host's, and any bits at all, under every pattern of stalls."""
    for seed, rates in enumerate(RATES):
        yield Job(frame=shapes(rng, 400, 64, 48, config=config), rates=rates, seed=seed)
        yield Job(frame=nonsense(rng, 800, 101, 40, config=config), rates=rates, seed=seed)


def over_an_initial_raster(rng, config):
    """Sparse, half and wholly full initial rasters, which take the lanes from the elements."""
    for seed, rates in enumerate(RATES):
        for width, height, share in ((40, 30, 0.5), (37, 60, 0.02), (130, 10, 1.0)):
            start = random_raster(rng, width, height, share, config)
            # A colour at background depth does not count.
            start.colour[~start.drawn] = config.channel_max
            yield Job(
                frame=shapes(rng, 200, width, height, config=config),
                initial=start,
                rates=rates,
                seed=seed,
            )


def back_to_back(rng, config):
    """Pairs of frames that differ in tables and size, the second pressing behind the first."""
    for seed, rates in enumerate(RATES):
        yield Job(
            frame=shapes(rng, 200, 64, 40, config=config),
            followed_by=[shapes(rng, 200, 37, 52, config=config)],
            initial=random_raster(rng, 64, 40, 0.2, config) if seed % 2 else None,
            rates={**rates, "table": 1.0},
            seed=seed,
        )


def behind_each_other(rng, config):
    """Films, whose frames follow while the one before leaves; test_engine has every pattern."""
    return films(rng, RATES[1::2], config)


def reset_in_the_middle(rng, config):
    """Stopped at many stages: what is left in the memories must not show."""
    frame = shapes(rng, 800, 96, 64, config=config)
    for after in (140, 300, 450, 700, 1301):
        yield Job(frame=frame, reset_after=after, rates=RATES[after % len(RATES)], seed=after)
    yield Job(frame=shapes(rng, 200, 96, 64, config=config))


def on_one_word(rng, config):
    """Each element meets the words while its predecessor's are on the way back to memory."""
    depths = rng.permutation(config.background_depth)[:300]
    start = [advance_word(20, config)]
    for x, rows, mode in ((98, [(1, 0)] * 3 + [(2, 2)], 1), (96, [(0, 3)] * 4, 1), (93, FULL, 0)):
        words = [
            word(rows, x, int(z), mode=mode, diffuse=n % 64, material=n % 64, config=config)
            for n, z in enumerate(depths)
        ]
        for seed, rates in enumerate(RATES[:3]):
            yield Job(frame=frame_of(start + words, 104, 40, config=config), rates=rates, seed=seed)


def extreme_colours(_, config):
    """Every corner of the ranges of I0, the coefficients and the intensities."""
    corners = [
        (material, diffuse, specular)
        for material in range(4)
        for diffuse in (0, config.diffuse.mask)
        for specular in (0, config.specular.mask)
    ]
    words = [advance_word(4, config)]
    words += [
        word(FULL, 8 * n, n, diffuse=d, specular=s, material=m, config=config)
        for n, (m, d, s) in enumerate(corners)
    ]
    largest = (1 << config.coefficient_bits) - 1
    brightest = (1 << config.ambient_bits) - 1
    unit = 1 << config.colour_shift
    size = (config.register_base, 3)
    kd, ks = np.zeros(size, np.int64), np.zeros(size, np.int64)
    kd[1], ks[2], kd[3], ks[3] = largest, largest, largest, largest
    for ambient in (0, 1, unit - 1, unit, config.channel_max * unit, brightest - 1, brightest, 0):
        tables = Tables(np.full(3, min(ambient, brightest), np.int64), kd, ks)
        codewords = frame_of(words, config=config).codewords
        yield Job(frame=Frame(codewords, tables, 128, 8, config))


def large_and_small_in_turn(rng, config):
    """Each bit of the image's size is set, then cleared."""
    for size in ((config.max_width, config.max_height), (1, 1)) * 2:
        yield Job(frame=shapes(rng, 40, *size, config=config))


def full_windows(_, config):
    """Each bit of each pixel that the window holds is set, then cleared, or the other way round."""
    for colour in (config.channel_max, 0):
        start = Raster.background(config.max_width, config.window_lines, config)
        start.depth[:], start.colour[:] = 0, colour
        yield Job(frame=frame_of([], *start.depth.shape[::-1], config=config), initial=start)


CASES = [
    with_stalls,
    over_an_initial_raster,
    back_to_back,
    behind_each_other,
    reset_in_the_middle,
    on_one_word,
    extreme_colours,
    large_and_small_in_turn,
    full_windows,
]


PLAYED = [config for config in OTHERS if config is not SWIFT_PLANE]
"""``swift-plane`` is built in ``blocks/test_planes.py``, which draws the same with it."""


def wrong_pixels(config, draw):
    """Return how many pixels are wrong in the pictures that ``draw`` makes of jobs, by case."""
    rng = np.random.default_rng(11)
    jobs, names = [], []
    for case in CASES:
        made = list(case(rng, config))
        jobs += made
        names += [f"{case.__name__} {n}" for n in range(len(made))]
    wrong = dict(zip(names, map(mismatches, jobs, draw(jobs)), strict=True))
    return {name: count for name, count in wrong.items() if count}


@pytest.mark.parametrize("config", PLAYED, ids=lambda config: config.name)
def test_every_preset_draws_what_the_contract_says(config):
    """All in one run, so that each frame meets what those before have left in the memories."""
    assert wrong_pixels(config, lambda jobs: play(jobs, built=engine(config))) == {}


def test_the_corners_of_the_paper_s_colours():
    jobs = list(extreme_colours(None, PAPER))
    assert not any(map(mismatches, jobs, play(jobs, built=engine())))


def cycles(config, draw):
    """Return the cycles of frames as ``draw`` takes them, and as they are counted."""
    rng = np.random.default_rng(5)
    random_frame = pw.random_frame if config.plane else cw.random_frame
    frames = [
        random_frame(rng, 500, (60, 50), config),
        random_frame(rng, 500, (12, 9), config),
        random_frame(rng, 2500, (512, 70), config),
        random_frame(rng, 300, (61, 300), config),
        random_frame(rng, 300, (1, 1), config),
        scene_frame("knot", view={"size": (96, 160)}, config=config),
        scene_frame("terrain", view={"size": (190, 60)}, config=config),
    ]
    outcomes = draw([Job(frame=frame) for frame in frames])
    counted = [count_cycles(frame, after_reset=index == 0) for index, frame in enumerate(frames)]
    return [outcome.cycles for outcome in outcomes], counted


@pytest.mark.parametrize("config", PLAYED, ids=lambda config: config.name)
def test_every_preset_takes_the_cycles_that_are_counted(config):
    """To the cycle; ``test_cycles`` has the same of ``paper``."""
    taken, counted = cycles(config, lambda jobs: play(jobs, built=engine(config)))
    assert taken == counted
