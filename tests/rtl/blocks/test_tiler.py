"""The tiler of whole blocks, against the contract's own words: each covered pixel in its lane."""

import random

import cocotb
import numpy as np

from splatline.contract.config import BLOCK
from splatline.contract.presets import SWIFT
from splatline.rtl.blocks.layouts import BlockLayout
from splatline.rtl.blocks.tiler import BlockTiler
from splatline.sim.cosim.blocks import unpack
from splatline.sim.cosim.streams import StreamBench
from tests.rtl.tiles.tiles import LOWEST
from tests.support.bench_config import CONFIG, run_bench
from tests.support.block_rows import block_rows, is_shifted
from tests.support.elements import END, ElementSlide, pack_element, random_rows, sorted_frames

LAYOUT = BlockLayout(CONFIG)
LINES, PIXELS, WORDS = CONFIG.window_lines, CONFIG.pixels_per_word, 1 << CONFIG.word_bits
ROOM = LINES - BLOCK
"""A block comes once its first line is less than so many below the window's first one."""
WHOLE = [(0, 7)] * 4


def expected_pixels(rows, mode, x, top, width, height):
    """Pixels that docs/contract.md asks for, in the image's words."""
    return {
        (top + row, x + column)
        for row, first, last in block_rows(rows, mode)
        for column in range(first, last + 1)
        if 0 <= top + row < height and (x + column) // PIXELS <= (width - 1) // PIXELS
    }


def block_pixels(block, rows, mode, x, top):
    """The pixels of a block; each lane must have its own place."""
    assert block.words == [x // PIXELS % WORDS, (x // PIXELS + 1) % WORDS]
    pixels = set()
    for q in range(BLOCK):
        line = top + (q - top) % BLOCK
        assert block.group[q] == line // BLOCK % (LINES // BLOCK)
        mask, odd = block.mask[q], block.odd[q]
        assert block.touch[q] == bool(mask & odd) + 2 * bool(mask & ~odd)
        assert block.rows >> q & 1 == bool(mask)
        begin = x + (line - top >= BLOCK // 2 and is_shifted(rows, mode))
        for p in range(BLOCK):
            column = begin + (p - begin) % BLOCK
            if block.mask[q] >> p & 1:
                assert block.odd[q] >> p & 1 == column // PIXELS % 2
                pixels.add((line, column))
    return pixels


def tell(dut, oldest, cleared=None, comes_to=None):
    """Say of a window where it begins, which place is cleared, and whether it is about to move."""
    dut.oldest.value = oldest
    dut.cleared.value = 0 if cleared is None else 1 + 2 * cleared
    dut.empties.value = comes_to is not None


class BlockSlide(ElementSlide):
    """Blocks, each of which waits for all its lines."""

    layout = LAYOUT

    def __init__(self, *args):
        super().__init__(*args)
        # Elements behind the one at hand: whose rows are in the columns of lanes, whose pixels are
        # in lanes, and which is offered once its lines are there.
        self.stages = [None, None, None]
        # What the window said in this cycle, and in the one before: its first line, the place that
        # is cleared, and where it is about to come to.
        self.now = self.then = (0, None, None)

    def in_window(self, bits, case):
        (_, mode, _, top), (oldest, cleared, comes_to) = case, self.then

        def is_free(place):
            return (place - top) % LINES >= (4 if mode else 8)

        comes = comes_to == top and is_free(oldest)
        return (top - oldest < ROOM or comes) and (cleared is None or is_free(cleared))

    def drive(self):
        random, oldest = self.bench.random, self.oldest
        cleared = comes_to = None
        if 0 < self.follow[0] < 1:
            cleared = random.choice([None, random.randrange(LINES)])
            comes_to = self.shown if self.shown > oldest and random.random() < 0.2 else None
        self.then, self.now = self.now, (oldest, cleared, comes_to)
        tell(self.dut, *self.now)

    def observe(self):
        over = self.over
        super().observe()
        if self.now[2] is not None and self.over == over:
            self.oldest = self.now[2]

    def check_moves(self, valid, ready):
        self.moves = bool(valid and ready) or self.stages[2] is None
        assert int(self.dut.moves.value) == int(self.dut.i__ready.value) == self.moves

    def move_on(self, over):
        if not self.moves:
            return
        last = self.stages[1]
        if over or last is not None:
            self.moved, self.shown = last, self.first_line(last)
        self.stages, self.hand = [self.hand, *self.stages[:2]], None


async def check(dut, cases, width=512, height=512, rates=(1.0, 1.0), seed=1, follow=(1.0, LOWEST)):
    """Send (rows, mode, x, top), or END, and compare; return the cycles."""
    slide = BlockSlide.begin(dut, cases, width, height, rates, seed, follow)
    await slide.bench.reset()
    cycles = await slide.run()
    assert len(slide.sink.received) == len(cases)
    for case, z, bits in zip(cases, slide.depths, slide.sink.received, strict=True):
        block = unpack(LAYOUT, bits)
        assert block.end == (case is END), case
        assert block.top == (case[3] + 2 * LOWEST + 2) % (4 * LOWEST + 4) - 2 * LOWEST - 2
        if case is END:
            assert not any(block.mask)
            continue
        assert block.z == z
        pixels = block_pixels(block, *case)
        assert pixels == expected_pixels(*case, width, height), (case, width, height)
    return cycles


@cocotb.test()
async def one_element_a_cycle(dut):
    """Random rows, both modes, every offset; elements without a pixel too."""
    rng = random.Random(1)
    cases = [
        (random_rows(rng), mode, 100 + offset, n)
        for n in range(2 * LINES)
        for offset in range(8)
        for mode in (0, 1)
        for _ in range(2)
    ]
    assert await check(dut, cases) <= len(cases) + 3


@cocotb.test()
async def each_single_pixel(dut):
    """One pixel, or two of a turned pair, for every place in block, word and eight lines."""
    rows = [
        [(column, column) if k == row else (1, 0) for k in range(4)]
        for row in range(4)
        for column in range(8)
    ]
    cases = [
        (one, mode, 56 + (x + line) % 16, 8 + line)
        for line in range(8)
        for x in range(0, 16, 3)
        for mode in (0, 1)
        for one in rows
    ]
    await check(dut, cases, rates=(1.0, 0.9), seed=2)


@cocotb.test()
async def middles_at_half_pixels(dut):
    """Every code of a raised middle row and of an empty first row, at every offset."""
    rng = random.Random(6)
    others = [(1, 0), (0, 0), (0, 7), (2, 5)]
    raised = [(first, last) for first in range(4, 8) for last in range(4)]
    empty = [(first, last) for first in range(8) for last in range(first)]
    cases = [
        (rows, mode, 96 + (offset + 3 * mode) % 8, 4 + offset)
        for offset in range(8)
        for mode in (0, 1)
        for rows in [
            *([rng.choice(others), *random_rows(rng)[:2], code] for code in raised),
            *([code, *random_rows(rng)[:2], rng.choice(others)] for code in empty),
        ]
    ]
    for width in (104, 512):  # what lies furthest right is outside the one, but not the other
        await check(dut, cases, width, 512)


@cocotb.test()
async def all_columns(dut):
    """From the first word to the last, in the widest image and a narrow one."""
    rng = random.Random(2)
    for width in (512, 19):
        cases = [(random_rows(rng), x % 2, x, 3 + x // 32) for x in range(512)]
        await check(dut, cases, width, 512, seed=width)


@cocotb.test()
async def right_border(dut):
    """Whole words are clipped, at images of several widths; nothing wraps round to the left."""
    rng = random.Random(3)
    for seed, width in enumerate((512, 511, 505, 504, 9, 8, 1)):
        columns = [x for x in [*range(width - 18, width + 10), 508, 511] if 0 <= x < 512]
        cases = [
            (rows, n, x, x % 16)
            for x in columns
            for n in (0, 1)
            for rows in (WHOLE, random_rows(rng))
        ]
        cases.sort(key=lambda case: case[3])
        await check(dut, cases, width, 512, (0.9, 0.7), seed)


@cocotb.test()
async def upper_and_lower_border(dut):
    """Lines above 0 and below the image, however far, at images of several heights."""
    rng = random.Random(4)
    for seed, height in enumerate((1, 2, 7, 8, 9, 15, 16, 17, 512, 1024)):
        near = range(max(5, height - 12), height + 9)
        tops = sorted({*range(-4, 5), *near, 1023, 1030, 2046, LOWEST})
        cases = [
            (rows, n, rng.randrange(500), top)
            for top in tops
            for n, rows in ((0, WHOLE), (1, WHOLE), (0, random_rows(rng)))
        ]
        await check(dut, cases, 512, height, (0.7, 0.9), seed)


@cocotb.test()
async def end_tokens(dut):
    """Each comes once, without pixels, after its frame's elements, under stalls."""
    for seed, rates in enumerate([(1.0, 1.0), (1.0, 0.2), (0.3, 1.0), (0.6, 0.6)]):
        cases = sorted_frames(random.Random(seed), 25, 8, 20)
        await check(dut, cases, 64, 48, rates, seed)


@cocotb.test()
async def a_window_that_lags_behind(dut):
    """Elements wait for their lines, whatever else stalls; few lines at a time, or many."""
    for seed, (rates, follow) in enumerate(
        [
            ((1.0, 1.0), (0.3, 1)),
            ((1.0, 1.0), (0.1, 30)),
            ((0.6, 0.7), (0.3, 2)),
            ((1.0, 0.3), (0.5, 1)),
            ((0.3, 1.0), (0.2, 13)),
        ]
    ):
        cases = sorted_frames(random.Random(seed), 6, 30, 12)
        await check(dut, cases, 99, 200, rates, seed, follow)


@cocotb.test()
async def a_block_comes_as_soon_as_its_lines(dut):
    """Less than 8 lines below the window's first, and in the cycle after that has moved on.

    The one behind it comes one cycle later. What waits shows its ``top`` four cycles after it was
    taken.
    """
    for top in (0, 7, 8, 9, 100, 1000):
        cases = [(WHOLE, mode, 40, top) for mode in (1, 0, 1)]
        slide = BlockSlide.begin(dut, cases, 512, 1024, seed=top, follow=(0.0, 0))
        await slide.bench.reset()

        async def blocks_after(oldest, *counts, slide=slide):
            slide.oldest = oldest
            for count in counts:
                await slide.bench.step(slide.drive, slide.observe)
                assert len(slide.sink.received) == count, oldest

        if top < 8:
            await blocks_after(0, 0, 0, 0, 0, 1, 2, 3, 3, 3)
            continue
        await blocks_after(top - 8, *[0] * 9)
        assert (slide.source.sent, slide.shown) == (3, top)
        await blocks_after(top - 7, 0, 1, 2, 3, 3, 3)


@cocotb.test()
async def a_block_waits_for_its_places_alone(dut):
    """What is cleared keeps a block waiting if it is a line of its own, for as long as it is said.

    Of what the window is about to come to, the place of the line that still leaves does.
    """
    top = 300
    for mode, rows in ((0, 8), (1, 4)):
        for below in range(LINES):
            place, far = (top + below) % LINES, top - 2 * LINES + below
            for before, told, after in (
                ((far,), (top, place), (top,)),
                ((far,), (far, None, top), (top,)),
            ):
                slide = BlockSlide.begin(dut, [(WHOLE, mode, 40, top)], 512, 512)
                tell(dut, *before)
                await slide.bench.reset()
                for says, count in ((before, 9), (told, 1), (after, 1), (after, 1)):
                    received = len(slide.sink.received)
                    for _ in range(count):
                        await slide.bench.step(lambda says=says: tell(dut, *says))
                    if says is told:
                        assert not received
                assert received == (below >= rows), (mode, below, told)
                assert len(slide.sink.received) == 1


@cocotb.test()
async def an_element_behind_an_end(dut):
    """It comes two cycles after the end token was taken, and the token at once."""
    bench, element = StreamBench(dut, 1), ([(0, 3)] * 4, 1, 40, 0)
    cases = [element, END, element, element]
    dut.last_column.value = dut.last_line.value = 511
    tell(dut, 0)
    bench.source("i", [pack_element(*case, z=0, end=case is END) for case in cases])
    sink, times = bench.sink("o"), []
    await bench.reset()
    for cycle in range(12):
        await bench.step()
        times += [cycle] * (len(sink.received) - len(times))
    assert [unpack(LAYOUT, bits).end for bits in sink.received] == [0, 1, 0, 0]
    assert np.diff(times).tolist() == [1, 2, 1]


@cocotb.test()
async def reset_in_the_middle(dut):
    """Whatever was at hand, offered or shown before: the next frame is as after any reset."""
    rng = random.Random(9)
    for seed in range(12):
        cases = [(random_rows(rng), 0, 50, 30 * n) for n in range(9)]
        follow = (0.0, 0) if seed % 2 else (1.0, LOWEST)
        slide = BlockSlide.begin(dut, cases, 512, 512, (0.8, 0.5), seed, follow)
        await slide.bench.reset()
        for _ in range(6 + seed):
            await slide.bench.step(slide.drive, slide.observe)
        assert slide.shown > -4 or slide.hand is not None
        await check(dut, sorted_frames(rng, 2, 9, 9), 64, 48, (1.0, 0.8), seed)


def test_block_tiler_lays_out_the_pixels_of_the_contract():
    run_bench(SWIFT, BlockTiler, __file__, simulator_name="verilator")
