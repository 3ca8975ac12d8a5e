"""The flush scan: each written pair of words is asked for once, in order, and nothing else is."""

import random

import cocotb
import pytest
from cocotb.triggers import Timer

from splatline.contract.presets import PAPER
from splatline.contract.variants import VARIANTS
from splatline.rtl.layouts import PlaceLayout
from splatline.rtl.tiles.dirty_bits import RESIDUES
from splatline.rtl.tiles.flush_scan import TileFlushScan
from tests.rtl.tiles.test_dirty_bits import STRETCHES, WORDS, Touch
from tests.rtl.window.slides import Slide
from tests.support.bench_config import CONFIG, PAIRED, run_bench

PLACE = PlaceLayout(CONFIG)
LOWEST = (1 << CONFIG.line_bits + 1) - 1
NOTHING = Touch(0, [(0, 0)] * RESIDUES, [0] * RESIDUES)


class LaneSlide(Slide):
    """A flush scan over lanes whose window slides down an image."""

    def __init__(self, dut, seed, rate=1.0):
        super().__init__(dut, seed, rate, PLACE, LOWEST)
        self.enabled = 1  # in the cycle before

    async def start(self, jump=1):
        self.dut.jump.value = jump
        inputs = ("touch", "group", "words", "reaching", "restart", "close", "enable", "top")
        inputs += ("load", "load_word", "lone", "limit")
        await self.reset(inputs, self.dut.wipe_row, range(4 * STRETCHES))

    def line_of(self, place, lowest):
        """The line from ``lowest`` on that stands in a place of the window."""
        return lowest + (place - lowest) % CONFIG.window_lines

    def words_of(self, bits):
        """Return what is asked for: the word, or with pairs both of them."""
        ((line, word),) = super().words_of(bits)
        assert CONFIG.flush_words == 1 or word % 2 == 0
        return [(line, word + n) for n in range(CONFIG.flush_words)]

    async def cycle(self, top, touch=NOTHING, enable=1, limit=LOWEST, load=None):
        """One cycle; what is to be written waits if marks are taken. Return whether it was not.

        With pairs what lies in other rows of lanes is written all the same.
        ``load``: word and line of the initial raster, in a row that ``touch`` leaves free.
        """
        dut = self.dut
        dut.top.value, dut.limit.value = (n % (1 << CONFIG.line_bits + 2) for n in (top, limit))
        dut.enable.value = enable
        await Timer(1, unit="ns")
        oldest = int(dut.oldest.value)
        taking = int(dut.taking.value)
        assert self.enabled or not taking
        assert not taking or oldest < top
        beside = taking and CONFIG.flush_words == 2
        if beside:
            touch, load = touch.without(oldest % 4), None
        touch.drive(dut, idle=taking and not beside, load=load)
        dut.reaching.value = int(bool(touch.dirty_bits()))

        def observe():
            assert int(dut.taking.value) == taking, "taking is known before all else"
            self.check_flush(oldest, top)

        await self.bench.step(observe=observe)
        self.enabled = enable
        if not taking or beside:
            for place, pair in touch.dirty_bits(load):
                line = self.line_of(place, oldest)
                self.expected |= {(line, 2 * pair), (line, 2 * pair + 1)}
        return not taking

    async def finish(self, rng):
        """Let everything leave, and compare."""
        await self.leave(lambda: self.cycle(LOWEST, enable=rng.random() < 0.8))
        assert await self.cycle(-4)
        assert int(self.dut.oldest.value) == 0


def random_touch(rng, low, high, word, single):
    """Words of a tile on lines low .. high, at most four, or a word of one of them."""
    touched, groups = [(0, 0)] * RESIDUES, [rng.randrange(4) for _ in range(RESIDUES)]
    lines = [rng.randrange(low, high + 1)] if single else range(low, min(low + 4, high + 1))
    for line in lines:
        flags = (1, 0) if single else (rng.randrange(2), rng.randrange(2) * (word < WORDS - 1))
        touched[line % 4], groups[line % 4] = flags, line // 4 % 4
    return Touch(word, touched, groups, rng.randrange(WORDS) if single else None)


@cocotb.test()
async def drawn_words_are_asked_for_once_and_in_order(dut):
    """Tiles all over the eight lines from ``top`` on; dense and sparse, quick and slow sinks."""
    for seed, (rate, height, words, share, jump) in enumerate(
        [
            (1.0, 90, 8, 0.9, 1),
            (0.4, 40, WORDS, 0.3, 1),
            (0.7, 300, WORDS, 0.04, 0),
            (1.0, 30, 40, 0.5, 0),
        ]
    ):
        rng, slide, top, cycles = random.Random(seed), LaneSlide(dut, seed, rate), -4, 0
        await slide.start(jump)
        while top < height:
            oldest, touch = int(dut.oldest.value), NOTHING
            if top - oldest < 8 and rng.random() < share:
                low = max(top + 4 * rng.randrange(2), 0)
                word = rng.randrange(WORDS - words, WORDS)
                touch = random_touch(rng, low, low + 3, word, single=False)
            await slide.cycle(top, touch, enable=rng.random() < 0.9)
            if top - oldest < 8:
                top += rng.choice([0] * 25 + [1, 1, 2, 9])
            cycles += 1
            assert cycles < 50_000
        assert len(slide.expected) > 100
        await slide.finish(rng)


@cocotb.test()
async def loaded_words_too(dut):
    """An initial raster: a word beside a tile, which lies on lines that have come.

    Lines leave behind both, and marks are taken meanwhile.
    """
    both = 0
    for seed, (rate, per_line) in enumerate([(1.0, 9), (1.0, 2), (0.5, 2), (1.0, 0.05)]):
        rng, slide = random.Random(seed), LaneSlide(dut, seed, rate)
        await slide.start(jump=0)
        top, limit = -4, 0  # no word comes for lines above ``limit``
        for _ in range(2000):
            oldest, touch, load = int(dut.oldest.value), NOTHING, None
            if top >= 0 and top + 4 < limit and rng.random() < 0.5:
                last = top + rng.randrange(3)
                touch = random_touch(rng, top, last, rng.randrange(WORDS), single=False)
            if limit < oldest + CONFIG.window_lines and rng.random() < per_line / (1 + per_line):
                load = rng.randrange(WORDS), limit
                if any(touch.touched[limit % 4]):
                    load = None
            elif limit < oldest + CONFIG.window_lines:
                limit += 1
            if top + 5 < limit and rng.random() < 0.3:
                top += 1
            both += load is not None and bool(touch.dirty_bits())
            await slide.cycle(top, touch, rng.random() < 0.9, limit, load)
        await slide.finish(rng)
    assert both > 50


@cocotb.test()
async def a_full_window_takes_a_cycle_a_word(dut):
    """And one for each stretch, and two for each line; lines that wait take none.

    With pairs a cycle a pair, and two for each stretch, as its last one is asked for in one cycle.
    A line's first word is asked for four cycles after the last one of the line before. The marks of
    other stretches are taken while the last word is asked for, and the first of them is picked one
    cycle later.
    """
    rng, slide = random.Random(7), LaneSlide(dut, 7)
    await slide.start()
    lines = 12
    for word in range(0, WORDS, 2):
        for group in range(lines // 4):
            await slide.cycle(0, Touch(word, [(1, 1)] * 4, [group] * 4))
    begin = slide.bench.cycles
    while int(dut.oldest.value) < lines:
        asked = WORDS // CONFIG.flush_words + STRETCHES * CONFIG.flush_words
        assert slide.bench.cycles - begin <= lines * (asked + 2) + 3
        await slide.cycle(lines)
    await slide.finish(rng)


@cocotb.test()
async def a_stretch_that_nothing_reached_is_passed_over(dut):
    """A pair a line takes five cycles, in whatever stretch, though the window is never clean.

    What was reached in another one is forgotten once the window has twice moved on.
    """
    rng, slide = random.Random(3), LaneSlide(dut, 3)
    await slide.start()
    lines, line = 11, 0
    for stretch in range(STRETCHES):
        for _ in range(4):
            for _ in range(lines):
                word, groups = stretch * WORDS // STRETCHES + 5, [line // 4 % 4] * 4
                touch = Touch(word, [(q == line % 4, 0) for q in range(4)], groups)
                while not await slide.cycle(line - lines, touch):
                    pass
                line += 1
            begin = slide.bench.cycles
            while int(dut.oldest.value) < line - 1:
                await slide.cycle(line - 1)
        assert slide.bench.cycles - begin <= 5 * lines + 1
    await slide.finish(rng)


@cocotb.test()
async def a_tile_on_two_stretches_reaches_both(dut):
    """From a clean window, so that nothing else has."""
    for stretch in range(1, STRETCHES):
        rng, slide = random.Random(stretch), LaneSlide(dut, stretch)
        await slide.start()
        await slide.cycle(0, Touch(stretch * WORDS // STRETCHES - 1, [(1, 1)] * 4, [0] * 4))
        await slide.finish(rng)


@cocotb.test()
async def untouched_lines_leave_at_once(dut):
    """One by one before a written line; all at once from a clean window, if nothing is to come."""
    rng, slide = random.Random(8), LaneSlide(dut, 8)
    await slide.start(jump=0)
    await slide.cycle(0, random_touch(rng, 9, 9, 50, single=True))
    for _ in range(12):
        await slide.cycle(14)
    assert int(dut.oldest.value) == 9 or slide.flush.received
    await slide.finish(rng)
    slide = LaneSlide(dut, 9)
    await slide.start(jump=1)
    for _ in range(2):
        await slide.cycle(700)
    assert int(dut.oldest.value) == 700
    await slide.finish(rng)


@cocotb.test()
async def nothing_leaves_unasked(dut):
    """No line from ``top`` on, none that is not loaded, and no marks are taken without leave."""
    for case, (top, enable, limit, jump) in enumerate(
        [(3, 1, 0, 1), (12, 0, 0, 1), (3, 1, 12, 0), (12, 1, 2, 0)]
    ):
        rng, slide = random.Random(case), LaneSlide(dut, case)
        await slide.start(jump)
        assert await slide.cycle(0, random_touch(rng, 3, 3, 99, single=True))
        for _ in range(12):
            assert await slide.cycle(top, enable=enable, limit=limit)
        assert not slide.flush.received
        assert int(dut.oldest.value) == (3 if jump else min(3, limit))
        await slide.finish(rng)


@pytest.mark.parametrize("config", [PAPER, PAIRED], ids=lambda config: config.name)
def test_flush_scan_asks_for_what_was_written(config, block_simulator):
    run_bench(config, TileFlushScan, __file__, simulator_name=block_simulator)


def test_flush_scan_chooses_among_sixteen_stretches():
    (config,) = (config for config in VARIANTS if config.name == "wide2048")
    run_bench(config, TileFlushScan, __file__)
