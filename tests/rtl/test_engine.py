"""Whole frames through the generated Verilog, against the golden renderer, bit for bit."""

import numpy as np
import pytest
from amaranth.sim import Simulator

from splatline.contract.presets import PAPER, SWIFT
from splatline.host.encode.sort_by_line import advance_word, end_word
from splatline.rtl.engine import Engine, engine_latency
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player.frames import Job, play
from tests.support.engines import engine, mismatches
from tests.support.faults import rewrite
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


def check(jobs, simulator_name="verilator"):
    """Play the jobs in one run and compare every picture; return the outcomes."""
    outcomes = play(jobs, built=engine(PAPER, simulator_name))
    for number, (job, outcome) in enumerate(zip(jobs, outcomes, strict=True)):
        assert mismatches(job, outcome) == 0, number
    return outcomes


def test_random_elements_under_every_pattern_of_stalls():
    rng = np.random.default_rng(1)
    frames = [shapes(rng, 400, 64, 48), shapes(rng, 300, 61, 40), shapes(rng, 200, 509, 30)]
    jobs = [
        Job(frame=frame, rates=rates, seed=seed)
        for frame in frames
        for seed, rates in enumerate(RATES)
    ]
    pictures = [outcome.raster for outcome in check(jobs)]
    assert pictures[0].drawn.mean() > 0.3


def test_any_64_bits_draw_what_the_contract_says():
    rng = np.random.default_rng(2)
    sizes = [(64, 64), (512, 20), (1, 1), (3, 100), (510, 9)]
    jobs = [
        Job(frame=nonsense(rng, 1500, *size), rates=RATES[n % len(RATES)], seed=n)
        for n, size in enumerate(sizes)
    ]
    check(jobs)


@pytest.mark.skipif(not simulator.available("icarus"), reason="Icarus is not installed")
def test_icarus_draws_the_same_with_and_without_stalls():
    """Small frames: it takes a hundred times as long as Verilator."""
    rng = np.random.default_rng(12)
    jobs = [
        Job(frame=draw(rng, count, 29, 24), rates=rates, seed=seed)
        for draw, count in ((shapes, 60), (nonsense, 150))
        for seed, rates in enumerate((RATES[0], RATES[3]))
    ]
    check(jobs, "icarus")


def test_elements_that_all_fall_on_one_word():
    """Each meets the word while its predecessor's is on the way back to memory."""
    rng = np.random.default_rng(3)
    one_pixel = [(1, 0), (1, 0), (1, 0), (2, 2)]
    block = [(0, 3)] * 4
    same_pixel = [word(one_pixel, 98, int(z)) for z in rng.integers(0, 512, 500)]
    same_block = [
        word(block, 96, int(z), diffuse=n % 128, material=n % 128)
        for n, z in enumerate(rng.permutation(500))
    ]
    ties = [word(block, 96, 7, diffuse=n, material=n) for n in range(100)]
    start = [advance_word(20, PAPER)]
    jobs = [
        Job(frame=frame_of(start + words, 104, 40), rates=rates, seed=seed)
        for words in (same_pixel, same_block, ties)
        for seed, rates in enumerate(RATES[:3])
    ]
    outcomes = check(jobs)
    # A word rests for one cycle between two elements.
    assert outcomes[3].cycles <= 2 * 501 + 200


def test_no_code_word_takes_more_than_four_cycles():
    """Whole blocks across three words of eight lines, each on the words of the one before."""
    words = [advance_word(20, PAPER)]
    words += [word(FULL, 93, 500 - n, mode=0) for n in range(500)]
    job = Job(frame=frame_of(words, 104, 40))
    outcome = check([job, job])[1]  # the first waits for the window to be cleared
    flushed = 8 * 104 // 4
    assert outcome.cycles <= 4 * len(words) + flushed + 40


def test_every_border_is_clipped_exactly():
    """Full blocks over each side and corner, for sizes that end within a word."""
    jobs = []
    for width, height in ((32, 20), (31, 19), (30, 18), (29, 17), (5, 3), (512, 12), (511, 12)):
        words, before = [], 0
        for line in range(height + 8):
            words += [advance_word(1, PAPER)] if line > before else []
            before = line
            for x in {0, 1, 3, width - 9, width - 8, width - 5, width - 1, width, 510, 511}:
                if 0 <= x < 512:
                    words.append(word(FULL, x, (7 * x + line) % 511, mode=line % 2))
        jobs.append(Job(frame=frame_of(words, width, height)))
    check(jobs)


def test_an_empty_frame_and_frames_with_nothing_visible():
    empty_block = word([(1, 0)] * 4, 5, 5, mode=0)
    frames = [
        frame_of([], 512, 512),
        frame_of([empty_block] * 50, 512, 512),
        frame_of([advance_word(511, PAPER)] * 9 + [word(FULL, 5, 5, mode=0)] * 9, 512, 512),
        frame_of([word(FULL, 5, 511, mode=0)] * 9, 512, 512),
        frame_of([word(FULL, 5, 5, mode=1)], 512, 512),  # rows above the image alone
    ]
    outcomes = check([Job(frame=frame) for frame in frames])
    assert len(outcomes[0].beats) == 1
    # The end beat stands on the port in the cycle after an element would write its pixels: that
    # nothing is left in the window is known by a register.
    assert outcomes[0].cycles == engine_latency(PAPER) + 2


def test_one_full_line_of_elements():
    rng = np.random.default_rng(4)
    words = [advance_word(100, PAPER)]
    words += [
        word(FULL, int(x), int(rng.integers(511)), mode=0) for x in rng.permutation(np.arange(505))
    ]
    outcome = check([Job(frame=frame_of(words))])[0]
    assert (outcome.raster.drawn.sum(axis=1) == 512).sum() == 8


def test_empty_lines_are_skipped_not_walked():
    """A few elements far apart: neither cleared, loaded nor flushed in between.

    Each of the 20 lines that were written takes eleven cycles, eight of them for its marks: each of
    its four stretches takes two, as it is wanted in one cycle and taken in the next. All others
    together take a few.
    """
    words = [
        word(FULL, 8, 1, mode=0),
        advance_word(400, PAPER),
        word(FULL, 8, 1, mode=0),
        advance_word(100, PAPER),
        word(FULL, 8, 1, mode=0),
    ]
    job = Job(frame=frame_of(words, 16, 512))
    outcome = check([job, job])[1]  # the first waits for the window to be cleared
    assert outcome.cycles < 260


def test_a_reset_in_the_middle_leaves_no_trace():
    rng = np.random.default_rng(5)
    frame = shapes(rng, 1500, 96, 64)
    other = shapes(rng, 300, 96, 64)
    jobs = [
        Job(frame=frame, reset_after=after, rates=RATES[after % len(RATES)], seed=after)
        for after in (140, 300, 450, 700, 1300)
    ]
    check([*jobs, Job(frame=other)])


def test_an_initial_raster_is_drawn_over():
    rng = np.random.default_rng(6)
    jobs = []
    for seed, rates in enumerate(RATES):
        for width, height, share in ((40, 30, 0.5), (37, 60, 0.02), (512, 10, 1.0)):
            jobs.append(
                Job(
                    frame=shapes(rng, 200, width, height),
                    initial=random_raster(rng, width, height, share),
                    rates=rates,
                    seed=seed,
                )
            )
    jobs.append(Job(frame=frame_of([], 40, 30), initial=random_raster(rng, 40, 30, 0.3)))
    check(jobs)


def test_an_engine_draws_over_what_another_has_drawn():
    rng = np.random.default_rng(7)
    picture = check([Job(frame=shapes(rng, 600, 64, 40))])[0].raster
    second = shapes(rng, 300, 64, 40)
    check([Job(frame=second, initial=picture, rates={"initial": 0.5})])


def test_tables_outlast_a_frame():
    rng = np.random.default_rng(8)
    frame = shapes(rng, 300, 64, 40)
    check([Job(frame=frame), Job(frame=frame, write_tables="none"), Job(frame=frame)])


def back_to_back(rng):
    """Pairs of frames that differ in tables and size, the second pressing behind the first."""
    return [
        Job(
            frame=shapes(rng, 300, 64, 40),
            followed_by=[shapes(rng, 300, 37, 52)],
            initial=random_raster(rng, 64, 40, 0.2) if seed % 2 else None,
            # Without a gap: at a gap the engine would let the waiting code words in.
            rates={**rates, "table": 1.0},
            seed=seed,
        )
        for seed, rates in enumerate(RATES)
    ]


def rasters_ahead(rng):
    """Frames with and without an initial raster, which is offered long before its frame."""
    sizes = [(64, 40), (37, 52), (50, 33), (20, 60)]
    return [
        Job(
            frame=shapes(rng, 100, *sizes[0]),
            followed_by=[shapes(rng, 100, *size) for size in sizes[1:]],
            initial=[
                random_raster(rng, *sizes[0], 0.2),
                None,
                random_raster(rng, 50, 33, 0.5),
                None,
            ],
            rates={**rates, "table": 1.0},
            seed=seed,
        )
        for seed, rates in enumerate(RATES)
    ]


def test_an_initial_raster_waits_for_its_frame():
    check(rasters_ahead(np.random.default_rng(13)))


def ends_taken(config):
    """Return how many end words an engine takes one after the other while no beat is."""
    dut, taken = Engine(config), 0

    async def bench(ctx):
        nonlocal taken
        ctx.set(dut.codewords.valid, 1)
        ctx.set(dut.codewords.payload.as_value(), end_word(config))
        for _ in range(dut.clear_cycles + 100):
            taken += ctx.get(dut.codewords.ready)
            await ctx.tick()

    simulation = Simulator(dut)
    simulation.add_clock(1e-6)
    simulation.add_testbench(bench)
    simulation.run()
    return taken


def test_a_third_frame_waits():
    """The first end beat stands on the port, and two frames more may be in the engine."""
    assert ends_taken(PAPER.with_shapes("small")) == 3


def test_a_third_frame_waits_for_an_end_beat_in_a_queue_to_be_taken():
    assert ends_taken(SWIFT) == 2


@pytest.mark.parametrize("config", [PAPER, SWIFT], ids=lambda config: config.name)
def test_tables_wait_until_the_end_beat_is_taken(config):
    """However long ``raster`` takes nothing, and though the beats wait elsewhere than in lanes."""
    dut = Engine(config)
    codewords, tables, raster = dut.codewords, dut.tables, dut.raster
    words = [word([(0, 7)] * 4, x, 5, config=config) for x in (0, 100, 200)]

    async def bench(ctx):
        await ctx.tick().repeat(dut.clear_cycles)
        ctx.set(codewords.valid, 1)
        for bits in [*words, end_word(config)]:
            ctx.set(codewords.payload.as_value(), bits)
            await ctx.tick().until(codewords.ready)
        ctx.set(codewords.valid, 0)
        ctx.set(tables.valid, 1)
        for _ in range(100):
            await ctx.tick()
            assert not ctx.get(tables.ready)
        ctx.set(raster.ready, 1)
        ended = False
        for _ in range(100):
            assert ctx.get(tables.ready) == ended
            ended |= bool(ctx.get(raster.valid) and ctx.get(raster.payload.end))
            await ctx.tick()
        assert ended

    simulation = Simulator(dut)
    simulation.add_clock(1e-6)
    simulation.add_testbench(bench)
    simulation.run()


@pytest.mark.planted
def test_a_third_frame_that_is_let_in_is_noticed(monkeypatch):
    rewrite(monkeypatch, Engine, "elaborate", r" & ~unfinished\[1\]", "")
    assert ends_taken(PAPER.with_shapes("small")) > 3


def test_no_table_write_comes_between_the_words_that_a_compact_one_makes():
    """A large one makes two, but is taken at once: then the frame is open."""
    config = PAPER.with_shapes("full")
    dut = Engine(config)
    codewords, tables = dut.codewords, dut.tables
    compact = word([(0, 0)] * 4, 40, 5, mode=0, config=config) & ~(((1 << 24) - 1) << 1)
    compact |= 12 << 1 | 32 << 6 | 32 << 12 | 1 << 18 | 1 << 21

    async def bench(ctx):
        ctx.set(codewords.valid, 1)
        ctx.set(codewords.payload.as_value(), compact)
        assert ctx.get(tables.ready) and ctx.get(codewords.ready)
        await ctx.tick()
        ctx.set(tables.valid, 1)
        assert not ctx.get(tables.ready)

    simulation = Simulator(dut)
    simulation.add_clock(1e-6)
    simulation.add_testbench(bench)
    simulation.run()


def test_tables_and_words_of_the_next_frame_wait_for_this_one_to_end():
    check(back_to_back(np.random.default_rng(10)))


def test_frames_follow_while_the_one_before_leaves():
    check(list(films(np.random.default_rng(12), RATES)))


def test_a_frame_of_the_largest_size():
    rng = np.random.default_rng(9)
    check([Job(frame=shapes(rng, 3000, 512, 1024)), Job(frame=shapes(rng, 100, 512, 16))])


@pytest.mark.parametrize("scene", ["terrain", "knot"])
def test_the_built_in_scenes(scene):
    frame = scene_frame(scene)
    outcome = check([Job(frame=frame, rates={"raster": 0.95}, seed=3)])[0]
    assert outcome.cycles < 4 * len(frame.codewords)
