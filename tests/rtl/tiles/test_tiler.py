"""The tiler, against the contract's own words: each covered pixel once, in the right lane."""

import itertools
import random

import cocotb
import numpy as np

from splatline.contract.presets import PAPER
from splatline.rtl.tiles.layouts import TileLayout
from splatline.rtl.tiles.tiler import Tiler
from splatline.sim.cosim.blocks import run_bench
from splatline.sim.cosim.streams import StreamBench
from tests.rtl.tiles.tiles import LOWEST, ROOM, overlap, unpack_tile
from tests.support.block_rows import block_rows, is_shifted
from tests.support.elements import END, ElementSlide, pack_element, random_rows, sorted_frames

WORDS = 1 << PAPER.word_bits
TOPS = 1 << PAPER.line_bits + 2


def expected_tiles(rows, mode, x, top, width, height):
    """Tiles that docs/contract.md asks for, {(lower, right): pixels in the image's words}."""
    tiles = {}
    for row, first, last in block_rows(rows, mode):
        moved = row // 4 * is_shifted(rows, mode)
        for column in range(first, last + 1):
            pixels = tiles.setdefault((row // 4, (column - moved) // 4), set())
            if 0 <= top + row < height and (x + column) // 4 <= (width - 1) // 4:
                pixels.add((top + row, x + column))
    return tiles


def tile_pixels(tile, rows, mode, x, top):
    """Which tile this is of an element, and its pixels; each lane must have its own place."""
    first, second = tile["words"] % WORDS, tile["words"] // WORDS
    assert second == (first + 1) % WORDS
    right = (first - x // 4) % WORDS
    lower = ((tile["group"] >> 2 * (top % 4)) - top // 4) % 4
    assert right in (0, 1) and lower in (0, 1)
    pixels = set()
    for q in range(4):
        line = top + 4 * lower
        line += (q - line) % 4
        assert tile["group"] >> 2 * q & 3 == line // 4 % 4
        for p in range(4):
            column = x + 4 * right + lower * is_shifted(rows, mode)
            column += (p - column) % 4
            assert (second if tile["next"] >> p & 1 else first) == column // 4 % WORDS
            if tile["mask"] >> 4 * q + p & 1:
                pixels.add((line, column))
    return (lower, right), pixels


class TileSlide(ElementSlide):
    """Tiles, each of which waits for its own four lines."""

    layout = TileLayout(PAPER)

    def in_window(self, bits, case):
        lower = tile_pixels(unpack_tile(bits), *case)[0][0]
        return case[3] + 4 * lower - self.oldest < ROOM


async def check(dut, cases, width=512, height=512, rates=(1.0, 1.0), seed=1, follow=(1.0, LOWEST)):
    """Send (rows, mode, x, top), or END, and compare; return the cycles and how many are needed."""
    expected = [{} if case is END else expected_tiles(*case, width, height) for case in cases]
    counts = [1 if case is END else len(e) for case, e in zip(cases, expected, strict=True)]
    slide = TileSlide.begin(dut, cases, width, height, rates, seed, follow)
    await slide.bench.reset()
    cycles = await slide.run()
    received = [unpack_tile(bits) for bits in slide.sink.received]
    assert len(received) == sum(counts)
    before = None
    for tile, follows in zip(received, slide.at_once, strict=True):
        if not tile["end"]:
            # Of a tile that was taken earlier it does not matter, and must not hold this one up.
            assert tile["meets"] == bool(follows and overlap(tile, before))
        before = tile
    tiles = iter(received)
    for case, count, wanted, z in zip(cases, counts, expected, slide.depths, strict=True):
        top = case[3]
        found = {}
        for tile in itertools.islice(tiles, count):
            assert tile["end"] == (case is END), case
            assert tile["top"] == top % TOPS
            if case is END:
                assert tile["mask"] == 0
                continue
            assert tile["z"] == z
            key, pixels = tile_pixels(tile, *case)
            assert key not in found, "a tile came twice"
            found[key] = pixels
        assert found == wanted, (case, width, height)
    return cycles, sum(count or 1 for count in counts)


@cocotb.test()
async def one_tile_a_cycle(dut):
    """Random rows, both modes, every offset; elements without a pixel take a cycle."""
    rng = random.Random(1)
    cases = [
        (random_rows(rng), mode, 100 + offset, n)
        for n in range(16)
        for offset in range(8)
        for mode in (0, 1)
        for _ in range(3)
    ]
    cycles, needed = await check(dut, cases)
    assert cycles <= needed + 2


@cocotb.test()
async def each_single_pixel(dut):
    """One pixel, or two of a turned pair, for every place in block, word and four lines."""
    cases = [
        (
            [(column, column) if k == row else (1, 0) for k in range(4)],
            n % 2,
            60 + n // 4,
            8 + n % 4,
        )
        for n in range(16)
        for row in range(4)
        for column in range(8)
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
        (rows, mode, 100 + offset, 4 + offset)
        for offset in range(4)
        for mode in (0, 0, 1)
        for rows in [
            *([rng.choice(others), *random_rows(rng)[:2], code] for code in raised),
            *([code, *random_rows(rng)[:2], rng.choice(others)] for code in empty),
        ]
    ]
    await check(dut, cases, 104, 512)


@cocotb.test()
async def right_border(dut):
    """Whole words are clipped, at images of several widths; nothing wraps round to the left."""
    rng = random.Random(3)
    for seed, width in enumerate((512, 511, 509, 510, 6, 1)):
        columns = [x for x in [*range(width - 14, width + 6), 508, 511] if 0 <= x < 512]
        cases = [(random_rows(rng), n, x, 4 + x % 16) for x in columns for n in (0, 1)]
        await check(dut, cases, width, 512, (0.9, 0.7), seed)


@cocotb.test()
async def upper_and_lower_border(dut):
    """Lines above 0 and below the image, however far, at images of several heights."""
    rng = random.Random(4)
    for seed, height in enumerate((1, 2, 7, 8, 11, 512, 1024)):
        tops = [*range(-4, 3), *range(max(3, height - 9), height + 6), 1023, 2046, LOWEST]
        cases = [(random_rows(rng), n, rng.randrange(512), top) for top in tops for n in (0, 1)]
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
async def a_tile_comes_as_soon_as_its_lines(dut):
    """Upper tiles less than 12 lines below the window's first, lower ones less than 8.

    Two cycles after the window has moved on. An element after one that goes while its lower lines
    are not there yet comes one cycle later, and no other does. What waits shows its ``top`` two
    cycles after it was taken.
    """
    for top in (0, 7, 12, 13, 100, 1000):
        cases = [([(0, 7)] * 4, mode, 40, top) for mode in (1, 0, 1)]
        slide = TileSlide.begin(dut, cases, 512, 1024, (1.0, 1.0), top, (0.0, 0))
        await slide.bench.reset()

        async def tiles_after(oldest, *counts, slide=slide):
            slide.oldest = oldest
            for count in counts:
                await slide.bench.step(slide.drive, slide.observe)
                assert len(slide.sink.received) == count, oldest

        if top < 8:
            await tiles_after(0, 0, 0, *range(1, 9), 8, 8)
            continue
        await tiles_after(top - 12, *[0] * 9)
        assert (slide.source.sent, slide.shown) == (1, top)
        await tiles_after(top - 11, 0, 0, 1, 2, 2, 3, *[4] * 9)
        await tiles_after(top - 8, *[4] * 9)
        await tiles_after(top - 7, 4, 4, 5, 6, 7, 8, 8, 8)


@cocotb.test()
async def an_element_behind_an_end(dut):
    """Its first tile comes three cycles after the end token was taken, and the token at once."""
    bench, element = StreamBench(dut, 1), ([(0, 3)] * 4, 1, 40, 0)
    cases = [element, END, element, element]
    dut.last_column.value = dut.last_line.value = 511
    dut.oldest.value = 0
    bench.source("i", [pack_element(*case, z=0, end=case is END) for case in cases])
    sink, times = bench.sink("o"), []
    await bench.reset()
    for cycle in range(12):
        await bench.step()
        times += [cycle] * (len(sink.received) - len(times))
    assert [unpack_tile(bits)["end"] for bits in sink.received] == [0, 1, 0, 0]
    assert np.diff(times).tolist() == [1, 3, 1]


@cocotb.test()
async def reset_in_the_middle(dut):
    """Whatever was at hand, offered or shown before: the next frame is as after any reset."""
    rng = random.Random(9)
    for seed in range(12):
        cases = [(random_rows(rng), 0, 50, 30 * n) for n in range(9)]
        follow = (0.0, 0) if seed % 2 else (1.0, LOWEST)
        slide = TileSlide.begin(dut, cases, 512, 512, (0.8, 0.5), seed, follow)
        await slide.bench.reset()
        for _ in range(6 + seed):
            await slide.bench.step(slide.drive, slide.observe)
        assert slide.shown > -4 or slide.hand is not None
        await check(dut, sorted_frames(rng, 2, 9, 9), 64, 48, (1.0, 0.8), seed)


def test_tiler_cuts_the_pixels_of_the_contract(block_simulator):
    run_bench(Tiler(PAPER), __file__, simulator_name=block_simulator)
