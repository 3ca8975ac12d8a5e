"""Engines of other windows, words, widths and depths: their pictures and their cycles."""

import os

import numpy as np
import pytest

from splatline.contract.presets import PAPER, SWIFT
from splatline.contract.raster import Raster
from splatline.contract.variants import NARROW_BLOCKS, VARIANTS
from splatline.host.encode.sort_by_line import advance_word
from splatline.rtl.tiles.tiler import Tiler
from splatline.sim import golden
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player.frames import Job, play
from splatline.sim.cosim.simulator import SimulationError
from splatline.sim.cycles.cycles import count_cycles
from tests.rtl import test_presets
from tests.support.engines import engine, mismatches
from tests.support.faults import rewrite
from tests.support.random_frames import frame_of, nonsense, random_raster, shapes, word

FULL = test_presets.FULL
PLAYED = [
    pytest.param(config, marks=[] if config.name == "largest" else pytest.mark.thorough)
    for config in VARIANTS
    if os.environ.get("SPLATLINE_TEST_VARIANTS") == "all" or config.name in ("largest", "depth16")
]
"""The largest, which differs from ``paper`` in most, and the one with the widest pixels: a build
each. All of them on demand."""


def at_the_right_border(rng, config):
    """Elements across and beyond the last column of images as wide as can be, or nearly."""
    for width in (config.max_width, config.max_width - 1, config.max_width - 9):
        words = []
        for line in range(12):
            x = rng.integers(width - 12, config.max_width, 20)
            words += [word(FULL, int(n), int(rng.integers(99)), config=config) for n in x]
            words.append(advance_word(int(line % 3), config))
        start = random_raster(rng, width, 16, 0.05, config)
        yield Job(frame=frame_of(words, width, 16, config=config), initial=start)


def down_the_image(rng, config):
    """Whole elements by turns near and far, which need all the lines that a window has."""
    for seed, rates in enumerate(test_presets.RATES):
        words = []
        for _ in range(60):
            words += [
                word(FULL, int(x), int(rng.integers(99)), mode=int(rng.integers(2)), config=config)
                for x in rng.integers(0, 40, 3)
            ]
            words.append(advance_word(int(rng.choice([1, 2, 4, 8, 9, 31])), config))
        yield Job(
            frame=frame_of(words, 40, 250, config=config),
            initial=random_raster(rng, 40, 250, 0.1, config) if seed % 2 else None,
            rates=rates,
            seed=seed,
        )


def at_full_rate(rng, config):
    """Frames whose cycles are counted."""
    for width, height in ((64, 48), (config.max_width, 30), (13, 90), (1, 1)):
        yield Job(frame=shapes(rng, 400, width, height, config=config))
        yield Job(frame=nonsense(rng, 400, width, height, config=config))
        yield Job(frame=nonsense(rng, 300, width, height, advance=0.5, config=config))


@pytest.mark.parametrize("config", PLAYED, ids=lambda config: config.name)
def test_every_variant_draws_what_the_contract_says_in_the_cycles_it_is_said_to(config):
    rng = np.random.default_rng(23)
    cases = [
        at_full_rate,  # the first, so that one of them meets the memory while it is cleared
        at_the_right_border,
        down_the_image,
        test_presets.with_stalls,
        test_presets.over_an_initial_raster,
        test_presets.back_to_back,
        test_presets.behind_each_other,
        test_presets.reset_in_the_middle,
        test_presets.on_one_word,
    ]
    made = [(case.__name__, job) for case in cases for job in case(rng, config)]
    names, jobs = zip(*made, strict=True)
    outcomes = play(jobs, built=engine(config))
    wrong = zip(names, map(mismatches, jobs, outcomes), strict=True)
    assert [(name, count) for name, count in wrong if count] == []
    timed = [n for n, name in enumerate(names) if name == "at_full_rate"]
    counted = [count_cycles(jobs[n].frame, after_reset=n == 0) for n in timed]
    assert counted == [outcomes[n].cycles for n in timed]


def behind_a_slow_raster(rng, config):
    """Frames whose beats fill the queue that rows of lanes have on their way out."""
    for seed, rate in enumerate((0.02, 0.1, 0.3)):
        frames = [nonsense(rng, 1500, 400, 60, 0.03, config=config) for _ in range(3)]
        yield Job(
            frame=frames[0],
            followed_by=frames[1:],
            initial=random_raster(rng, 400, 60, 0.1, config) if seed else None,
            rates={"raster": rate},
            seed=seed,
        )


def test_draws_blocks_at_borders_and_behind_a_slow_raster():
    rng = np.random.default_rng(31)
    cases = [at_the_right_border, down_the_image, behind_a_slow_raster]
    made = [(case.__name__, job) for case in cases for job in case(rng, SWIFT)]
    names, jobs = zip(*made, strict=True)
    wrong = zip(names, map(mismatches, jobs, play(jobs, built=engine(SWIFT))), strict=True)
    assert [(name, count) for name, count in wrong if count] == []


def in_narrow_blocks(rng, config):
    """Frames no wider than the engine takes; the first two are timed."""
    widest = config.max_width
    for width, advance in ((widest, 0.05), (min(61, widest - 3), 0.5)):
        yield Job(frame=nonsense(rng, 500, width, 40, advance, config=config))
    for seed, rates in enumerate(test_presets.RATES):
        width = min(90, widest) - seed
        yield Job(
            frame=shapes(rng, 250, width, 37, config=config),
            followed_by=[shapes(rng, 150, width // 2, 52, config=config)],
            initial=random_raster(rng, width, 37, (0.4, 0.02, 1.0)[seed % 3], config),
            rates={**rates, "table": 1.0},
            seed=seed,
        )
    yield held_up(config)


def held_up(config):
    """A block, marks that go before it, and a beat to load that wants its row, all at once.

    In a window of 32 lines. None of the three may wait for another that waits for it.
    """
    block = [word([(0, 7)] * 4, 8, z, mode=0, config=config) for z in (100, 90)]
    raster = Raster.background(config.max_width, 117, config)
    raster.depth[[90, 114]] = 150
    steps = [advance_word(31, config)] * 2 + [advance_word(30, config)]
    words = [*steps, block[0], advance_word(12, config), *block[1:] * 40]
    frame = frame_of(words, config.max_width, 117, config=config)
    return Job(frame=frame, initial=raster)


def test_blocks_of_32_lines_in_a_narrow_image():
    """Pictures, initial rasters and cycles, in one run."""
    jobs = list(in_narrow_blocks(np.random.default_rng(29), NARROW_BLOCKS))
    outcomes = play(jobs, built=engine(NARROW_BLOCKS))
    wrong = map(mismatches, jobs, outcomes)
    assert [(number, count) for number, count in enumerate(wrong) if count] == []
    counted = [count_cycles(jobs[n].frame, after_reset=n == 0) for n in range(2)]
    assert counted == [outcome.cycles for outcome in outcomes[:2]]


FAULTS = [
    # A block of eight lines in a window of eight: too early, its last ones are still on their way.
    (Tiler, "_compare", r"low > 2 \* SIDE", "low > 1 * SIDE", "lines not there yet"),
    (Tiler, "_columns", r"Cat\(1, x\[bits:\]\)", "Cat(0, x[bits:])", "a word misplaced"),
]


@pytest.mark.planted
@pytest.mark.parametrize(
    ("component", "method", "pattern", "replacement"),
    [pytest.param(*fault[:4], id=fault[4]) for fault in FAULTS],
)
def test_a_fault_in_what_sizes_decide_is_noticed(
    monkeypatch, component, method, pattern, replacement
):
    """Two pixels a word and eight lines, in the simulator that builds faster."""
    config = next(config for config in VARIANTS if config.name == "small")
    rewrite(monkeypatch, component, method, pattern, replacement)
    rng = np.random.default_rng(5)
    frame = shapes(rng, 250, 24, 60, config=config)
    quickest = "icarus" if simulator.available("icarus") else "verilator"
    try:
        outcome = play([Job(frame=frame)], simulator_name=quickest)[0]
    except SimulationError:  # words outside the image, or none for too long
        return
    assert outcome.raster.mismatches(golden.render(frame)) > 0


def test_what_windows_and_words_are_for():
    """Wide words take wide elements in fewer cycles, high windows let more lines leave."""

    def count(**changes):
        config = PAPER.replace(**changes)
        frame = shapes(np.random.default_rng(3), 3000, 200, 60, config=config)
        return count_cycles(frame, after_reset=False)

    assert count(pixels_per_word=8) < count() < count(pixels_per_word=2)
    assert count(window_lines=32) <= count() < count(window_lines=8)
