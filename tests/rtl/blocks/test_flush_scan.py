"""The flush scan over beats asks for each written beat once, in order, and for nothing else."""

import random

import cocotb

from splatline.contract.presets import SWIFT
from splatline.rtl.blocks.flush_scan import BlockFlushScan
from tests.rtl.blocks.beat_slide import LINE, LOWEST, BeatSlide, random_touch, stretch_word
from tests.rtl.blocks.test_dirty_bits import (
    BEATS,
    LINES,
    NOTHING,
    STRETCHES,
    WORDS,
    Touch,
)
from tests.support.bench_config import run_bench


@cocotb.test()
async def written_beats_are_asked_for_once_and_in_order(dut):
    """Blocks in the eight lines from ``top`` on; dense and sparse, quick and slow sinks.

    Now and then ``top`` moves on in the cycle behind a block.
    """
    for seed, (rate, height, words, share, jump) in enumerate(
        [
            (1.0, 60, 20, 0.9, 1),
            (0.4, 40, WORDS, 0.3, 1),
            (0.7, 300, WORDS, 0.08, 0),
            (1.0, 60, WORDS, 0.5, 0),
            (1.0, 150, WORDS, 0.2, 1),
        ]
    ):
        rng, slide, top, cycles = random.Random(seed), BeatSlide(dut, seed, rate), -4, 0
        await slide.start(jump)
        while top < height:
            oldest, touch = int(dut.oldest.value), NOTHING
            if top - oldest < 8 and rng.random() < share:
                word = rng.randrange(WORDS - words, WORDS)
                touch = random_touch(rng, top, word, rng.choice([0.1, 0.5]))
            await slide.cycle(top, touch, rng.choice([0, 1, 1, 1, "first"]))
            if top - oldest < 8:
                top += rng.choice([0] * 25 + [1, 1, 2, 9])
            cycles += 1
            assert cycles < 50_000
        assert len(slide.expected) > 50
        await slide.finish(rng)


@cocotb.test()
async def loaded_beats_too(dut):
    """An initial raster: a beat beside a block, which lies on lines that have come.

    Lines leave behind both, and marks are taken meanwhile.
    """
    both = 0
    for seed, (rate, per_line) in enumerate([(1.0, 9), (1.0, 2), (0.5, 2), (1.0, 0.05)]):
        rng, slide = random.Random(seed), BeatSlide(dut, seed, rate)
        await slide.start(jump=0)
        top, limit = -4, 0  # no beat comes for lines above ``limit``
        for _ in range(1500):
            oldest, touch, load = int(dut.oldest.value), NOTHING, None
            if top >= 0 and top + 8 < limit and rng.random() < 0.5:
                touch = random_touch(rng, top, rng.randrange(WORDS))
            if limit < oldest + LINES and rng.random() < per_line / (1 + per_line):
                load = rng.randrange(WORDS), limit
                if touch.wants(limit):
                    load = None
            elif limit < oldest + LINES:
                limit += 1
            both += load is not None and bool(touch.dirty_bits())
            await slide.cycle(top, touch, rng.choice([0, 1, 1, "first"]), limit, load)
            if top + 9 < limit and rng.random() < 0.3:
                top += 1
        assert top > 15
        await slide.finish(rng)
    assert both > 50


@cocotb.test()
async def the_next_frame_is_drawn_while_one_leaves(dut):
    """Its lines take the places of those that left, of a turn of the window or of two."""
    behind = 0
    for seed, (rate, share) in enumerate([(1.0, 0.5), (0.3, 0.3), (1.0, 0.05), (0.5, 1.0)]):
        rng, slide, top = random.Random(seed), BeatSlide(dut, seed, rate), -4
        await slide.start()
        for _ in range(8):
            last = rng.randrange(40)
            while top < last:
                touch = NOTHING
                if top - dut.front.value.to_signed() < 8:
                    if rng.random() < share:
                        touch = random_touch(rng, top, rng.randrange(WORDS), rng.random())
                    if await slide.cycle(top, touch):
                        top += rng.choice([0] * 5 + [1, 3])
                else:
                    await slide.cycle(top)
            top = LOWEST

            async def cycle(slide=slide, rng=rng, share=share):
                nonlocal top
                touch = NOTHING
                if top == LOWEST:
                    await slide.cycle(top)
                    top = -4
                    return
                if top - dut.front.value.to_signed() < 8:
                    if rng.random() < share:
                        touch = random_touch(rng, top, rng.randrange(WORDS), 0.5, low=0)
                    top += rng.choice([0] * 9 + [1]) * (top < 6)
                await slide.cycle(top, touch)

            await slide.change(cycle)
            behind += len(slide.expected)
        while top < 40:
            top += await slide.cycle(top)
        await slide.finish(rng)
    assert behind > 100


@cocotb.test()
async def a_full_window_takes_a_cycle_a_beat(dut):
    """The marks of the next stretch are taken while the last beat of one is asked for."""
    rng, slide, lines = random.Random(7), BeatSlide(dut, 7), 8
    await slide.start()
    for word in range(0, WORDS, 2):
        await slide.cycle(0, Touch(word, [(1, 1)] * 8, [0] * 8))
    begin = slide.bench.cycles
    while len(slide.flush.received) < lines * LINE:
        assert slide.bench.cycles - begin <= lines * LINE + 3
        await slide.cycle(lines)
    await slide.finish(rng)


@cocotb.test()
async def a_beat_a_line_takes_a_cycle_a_line(dut):
    """Ten on neighbouring lines, in the third cycle after they are complete, in any stretch."""
    for stretch in range(STRETCHES):
        rng, slide = random.Random(stretch), BeatSlide(dut, stretch)
        await slide.start()
        for line in range(10):
            await slide.cycle(0, Touch.of_line(line, stretch_word(stretch, line % BEATS)))
        for cycle in range(13):
            assert len(slide.flush.received) == max(0, cycle - 2)
            await slide.cycle(10)
        await slide.finish(rng)


@cocotb.test()
async def a_stretch_that_nothing_reached_is_passed_over(dut):
    """A beat a line takes a cycle, though the window is never clean, in whatever stretch.

    What was reached in another one is forgotten once the window has twice moved on.
    """
    rng, slide = random.Random(3), BeatSlide(dut, 3)
    await slide.start()
    lines, line = 7, 0
    for stretch in range(STRETCHES):
        for _ in range(6):
            for _ in range(lines):
                touch = Touch.of_line(line, stretch_word(stretch, 1, 1))
                while not await slide.cycle(line - lines, touch):
                    pass
                line += 1
            begin = slide.bench.cycles
            while int(dut.oldest.value) < line - 1:
                await slide.cycle(line - 1)
        assert slide.bench.cycles - begin <= lines + 3
    await slide.finish(rng)


@cocotb.test()
async def a_block_on_two_stretches_reaches_both(dut):
    """From a clean window, so that nothing else has."""
    for stretch in range(1, STRETCHES):
        rng, slide = random.Random(stretch), BeatSlide(dut, stretch)
        await slide.start()
        await slide.cycle(0, Touch(stretch_word(stretch) - 1, [(1, 1)] * 8, [0] * 8))
        await slide.finish(rng)


@cocotb.test()
async def the_first_beat_comes_first(dut):
    """Drawn in the cycle before its line is complete, left of stretches that were long known."""
    for lag in range(4):
        rng, slide = random.Random(lag), BeatSlide(dut, lag)
        await slide.start()
        for line in range(30):
            while line - int(dut.oldest.value) >= 8:
                await slide.cycle(line)
            await slide.cycle(line, Touch.of_line(line, stretch_word(5)))
            for _ in range(lag):
                await slide.cycle(line)
            await slide.cycle(line, Touch.of_line(line, stretch_word(line % 5, 3)))
        await slide.finish(rng)


@cocotb.test()
async def the_window_waits_for_what_is_asked_for(dut):
    """A beat that nothing takes keeps its line in the window; others are read ahead, not left."""
    rng, slide = random.Random(4), BeatSlide(dut, 4, rate=0.0)
    await slide.start()
    for line in (2, 3, 9):
        await slide.cycle(0, Touch.of_line(line, 4))
    for _ in range(20):
        await slide.cycle(12)
    assert (int(dut.oldest.value), slide.flush.received) == (2, [])
    assert int(dut.line.value) == 3
    slide.flush.rate = 0.2
    await slide.finish(rng)


@cocotb.test()
async def untouched_lines_leave_at_once(dut):
    """One by one before a written line; all at once from a clean window, if nothing is to come."""
    rng, slide = random.Random(8), BeatSlide(dut, 8)
    await slide.start(jump=0)
    await slide.cycle(0, Touch.of_line(9, 50))
    for _ in range(13):
        await slide.cycle(14)
    assert int(dut.oldest.value) == 9 or slide.flush.received
    await slide.finish(rng)
    slide = BeatSlide(dut, 9)
    await slide.start(jump=1)
    for _ in range(3):
        await slide.cycle(700)
    assert int(dut.oldest.value) == 700
    await slide.finish(rng)


@cocotb.test()
async def where_the_window_comes_to_is_told(dut):
    """While the last beat of all is asked for: not before, and not where a raster may still come.

    (``cycle`` checks that it comes there.)
    """
    for jump in (1, 0):
        for beats in range(1, BEATS + 1):
            rng, slide = random.Random(beats), BeatSlide(dut, beats)
            await slide.start(jump)
            for line in (4, 6):
                for beat in range(beats):
                    await slide.cycle(0, Touch.of_line(line, stretch_word(2, beat)))
            slide.came = 0
            while len(slide.flush.received) < 2 * beats:
                assert not slide.came
                await slide.cycle(300)
            assert slide.came == jump
            await slide.finish(rng)


@cocotb.test()
async def nothing_leaves_unasked(dut):
    """No line from ``top`` on, none that is not loaded, and no marks are taken without leave."""
    for case, (top, enable, limit, jump) in enumerate(
        [(3, 1, 0, 1), (12, 0, 0, 1), (3, 1, 12, 0), (12, 1, 2, 0), (12, 1, 3, 0)]
    ):
        rng, slide = random.Random(case), BeatSlide(dut, case)
        await slide.start(jump)
        assert await slide.cycle(0, Touch.of_line(3, 49), limit=0)
        for _ in range(12):
            assert await slide.cycle(top, enable=enable, limit=limit)
        assert not slide.flush.received
        assert int(dut.oldest.value) == (3 if jump else min(3, limit))
        await slide.finish(rng)


def test_flush_scan_asks_for_what_was_written():
    run_bench(SWIFT, BlockFlushScan, __file__)
