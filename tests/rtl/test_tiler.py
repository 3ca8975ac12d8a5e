"""The tiler, against the contract's own words: each covered pixel once, in the right lane."""

import itertools
import random

import cocotb
from tiles import places_of, unpack_tile

from splatline.rtl.format import PAPER
from splatline.rtl.layouts import GeometryLayout
from splatline.rtl.tiler import Tiler
from splatline.sim.cosim.blocks import run_bench
from splatline.sim.cosim.streams import StreamBench

WORDS = 1 << PAPER.word_bits
LOWEST = (1 << PAPER.line_bits + 1) - 1
END = ([(1, 0)] * 4, 1, 300, LOWEST)
PLACES = {name: (f.offset, f.width) for name, f in GeometryLayout(PAPER)}
ROW_CODES = [(first, last) for first in range(8) for last in range(8)]


def pack_element(rows, mode, x, top, **rest):
    scans = sum((first | last << 3) << 6 * row for row, (first, last) in enumerate(rows))
    bits = 0
    for name, value in {"scans": scans, "mode": mode, "x": x, "top": top, **rest}.items():
        if name in PLACES:
            offset, width = PLACES[name]
            bits |= (value & (1 << width) - 1) << offset
    return bits


def random_rows(rng):
    """Four rows: any, mostly empty, or within a few columns."""
    kind = rng.randrange(4)
    if kind == 0:
        return [rng.choice(ROW_CODES) for _ in range(4)]
    if kind == 1:
        return [rng.choice([(1, 0), (7, 3), rng.choice(ROW_CODES)]) for _ in range(4)]
    low = rng.randrange(5)
    return [(low + rng.randrange(2), low + rng.randrange(4)) for _ in range(4)]


def expected_tiles(rows, mode, x, top, width, height):
    """Tiles that docs/contract.md asks for, {(lower, right): pixels in the image's words}."""
    block = list(rows)
    if mode == 0:
        block += [(7 - last, 7 - first) for first, last in reversed(rows)]
    tiles = {}
    for row, (first, last) in enumerate(block):
        for column in range(first, last + 1):
            pixels = tiles.setdefault((row // 4, column // 4), set())
            if 0 <= top + row < height and (x + column) // 4 <= (width - 1) // 4:
                pixels.add((top + row, x + column))
    return tiles


def tile_pixels(tile, x, top):
    """Which tile this is of an element, and its pixels; each lane must have its own place."""
    first, second = tile["words"] % WORDS, tile["words"] // WORDS
    assert second == (first + 1) % WORDS
    lower, right = tile["lower"], (first - x // 4) % WORDS
    assert right in (0, 1)
    pixels = set()
    for q in range(4):
        line = top + 4 * lower
        line += (q - line) % 4
        assert tile["group"] >> 2 * q & 3 == line // 4 % 4
        for p in range(4):
            column = x + 4 * right
            column += (p - column) % 4
            assert (second if tile["next"] >> p & 1 else first) == column // 4 % WORDS
            if tile["mask"] >> 4 * q + p & 1:
                pixels.add((line, column))
    return (lower, right), pixels


async def play(dut, cases, given, width, height, rates, seed):
    """Send elements; return the tiles, the cycles, and which tiles followed at once on another."""
    words = [
        pack_element(*case, z=z, colour=colour, end=case is END)
        for case, (z, colour) in zip(cases, given, strict=True)
    ]
    bench = StreamBench(dut, seed)
    source = bench.source("i", words, rates[0])
    sink = bench.sink("o", rates[1])
    dut.last_column.value, dut.last_line.value = width - 1, height - 1
    at_once, taken, waiting = [], False, False

    def drive():
        if source.sent:  # the colour of the element that was taken last
            dut.shade.value = given[source.sent - 1][1]

    def observe():
        nonlocal taken, waiting
        valid = int(dut.o__valid.value)
        if valid and not waiting:
            at_once.append(taken)
        taken = valid and int(dut.o__ready.value)
        waiting = valid and not taken

    await bench.reset()
    begin = bench.cycles
    await bench.run(
        lambda: source.sent == len(words),
        most_cycles=50_000,
        drive=drive,
        observe=observe,
        after=0,
    )
    cycles = bench.cycles - begin
    for _ in range(4 if rates[1] == 1.0 else 100):
        await bench.step(drive, observe)
    return [unpack_tile(bits) for bits in sink.received], cycles, at_once


async def check(dut, cases, width=512, height=512, rates=(1.0, 1.0), seed=1):
    """Send (rows, mode, x, top), or END, and compare; return the cycles and how many are needed."""
    rng = random.Random(seed)
    given = [(rng.getrandbits(PAPER.depth_bits), rng.getrandbits(9)) for _ in cases]
    expected = [{} if case is END else expected_tiles(*case, width, height) for case in cases]
    counts = [1 if case is END else len(e) for case, e in zip(cases, expected, strict=True)]
    received, cycles, at_once = await play(dut, cases, given, width, height, rates, seed)
    assert len(received) == sum(counts)
    before = set()
    for tile, follows in zip(received, at_once, strict=True):
        places = places_of(tile)
        # Of a tile that was taken earlier it does not matter.
        assert bool(follows and places & before) <= tile["meets"] <= bool(places & before)
        before = places
    tiles = iter(received)
    for case, count, wanted, (z, colour) in zip(cases, counts, expected, given, strict=True):
        _, _, x, top = case
        found = {}
        for tile in itertools.islice(tiles, count):
            assert tile["end"] == (case is END), case
            assert tile["top"] == top % (1 << PAPER.line_bits + 2)
            if case is END:
                assert tile["mask"] == 0
                continue
            assert (tile["z"], tile["colour"]) == (z, colour)
            key, pixels = tile_pixels(tile, x, top)
            assert key not in found, "a tile came twice"
            found[key] = pixels
        assert found == wanted, (case, width, height)
    return cycles, sum(count or 1 for count in counts)


@cocotb.test()
async def one_tile_a_cycle(dut):
    """Random rows, both modes, every offset; elements without a pixel take a cycle."""
    rng = random.Random(1)
    cases = [
        (random_rows(rng), mode, 100 + offset, 40 + n)
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
    """Each comes once, without pixels, in its place among the elements, under stalls."""
    for seed, rates in enumerate([(1.0, 1.0), (1.0, 0.2), (0.3, 1.0), (0.6, 0.6)]):
        rng = random.Random(seed)
        cases = [
            END
            if rng.random() < 0.2
            else (random_rows(rng), rng.randrange(2), rng.randrange(99), rng.randrange(-4, 60))
            for _ in range(100)
        ]
        await check(dut, cases, 64, 48, rates, seed)


def test_tiler_cuts_the_pixels_of_the_contract(simulator_name):
    run_bench(Tiler(PAPER), __file__, simulator_name=simulator_name)
