"""The decoder, against the contract's own words: which pixels a code word covers."""

import random
from functools import cache

import cocotb
from blocks import block_rows
from presets import CONFIG, run_bench

from splatline.rtl.decoder import Decoder
from splatline.rtl.layouts import FootprintLayout, GeometryLayout
from splatline.rtl.presets import PAPER
from splatline.rtl.variants import BANKS16
from splatline.sim.cosim.streams import StreamBench

PLACES = {name: (f.offset, f.width) for name, f in GeometryLayout(CONFIG)}
FOOTPRINT = FootprintLayout(CONFIG)
PIXELS = CONFIG.pixels_per_word
LAST = (1 << CONFIG.line_bits + 1) - 1


def element(rows, mode, x, top, **rest):
    scans = sum((first | last << 3) << 6 * row for row, (first, last) in enumerate(rows))
    values = {"scans": scans, "mode": mode, "x": x, "top": top, **rest}
    bits = 0
    for name, value in values.items():
        offset, width = PLACES[name]
        bits |= (value & (1 << width) - 1) << offset
    return bits


def contract_pixels(rows, mode, x, top, width, height):
    """Pixels that docs/contract.md says are covered."""
    return {
        (top + row, x + column)
        for row, first, last in block_rows(rows, mode)
        for column in range(first, last + 1)
        if 0 <= top + row < height and x + column < width
    }


@cache
def place(*path):
    """First bit and mask of a field deep in the footprint."""
    offset, layout = 0, FOOTPRINT
    for key in path:
        field = layout[key]
        offset, layout = offset + field.offset, field.shape
    return offset, (1 << field.width) - 1


def get(bits, *path):
    offset, mask = place(*path)
    return bits >> offset & mask


def footprint_pixels(bits, top, width):
    """Pixels that a footprint names, and a check that each line stands where it belongs."""
    pixels = set()
    word0 = get(bits, "word")
    for residue in range(4):
        upper_line = top + (residue - top) % 4
        assert get(bits, "upper_group", residue) == upper_line // 4 % 4
        for line, half in ((upper_line, "upper"), (upper_line + 4, "lower")):
            words = get(bits, half, residue, "words")
            if not words:
                continue
            begin = get(bits, half, residue, "first")
            end = get(bits, half, residue, "last")
            for word in range(CONFIG.block_words):
                if words >> word & 1:
                    first, last = max(begin, PIXELS * word), min(end, PIXELS * (word + 1) - 1)
                    assert first <= last, "a word is named that the span does not touch"
                    pixels |= {(line, PIXELS * word0 + p) for p in range(first, last + 1)}
    # The last word of a line may reach past the border; the window clips it.
    return {(line, x) for line, x in pixels if x < width or x // PIXELS != (width - 1) // PIXELS}


async def check(dut, cases, width, height, rates, seed):
    bench = StreamBench(dut, seed)
    bench.source("i", (element(*case) for case in cases), rates[0])
    sink = bench.sink("o", rates[1])
    dut.oldest.value, dut.running.value = LAST, 1  # all lines are in the window
    dut.last_column.value = width - 1
    dut.last_line.value = height - 1
    await bench.reset()
    cycles = await bench.run(lambda: len(sink.received) == len(cases), most_cycles=200_000)
    for (rows, mode, x, top), bits in zip(cases, sink.received, strict=True):
        expected = contract_pixels(rows, mode, x, top, width, height)
        found = footprint_pixels(bits, top, width)
        assert found == expected, (rows, mode, x, top, width, height)
    return cycles


ROW_CODES = [(first, last) for first in range(8) for last in range(8)]


@cocotb.test()
async def all_pairs_of_rows(dut):
    """Every pair of row codes, in neighbouring rows, both modes, every offset in a word."""
    cases = []
    for number, (a, b) in enumerate((a, b) for a in ROW_CODES for b in ROW_CODES):
        for mode in (0, 1):
            for offset in range(PIXELS):
                rows = [(a, b, b, a), (b, a, a, b)][number % 2]
                cases.append((rows, mode, 100 + offset, 40 + (number + offset) % 8))
    cycles = await check(dut, cases, 512, 512, (1.0, 1.0), 1)
    assert cycles <= len(cases) + 4, "one element a cycle"


@cocotb.test()
async def middles_at_half_pixels(dut):
    """Every code of a raised middle row and of an empty first row, at every offset."""
    rng = random.Random(6)
    raised = [(first, last) for first in range(4, 8) for last in range(4)]
    empty = [(first, last) for first in range(8) for last in range(first)]
    cases = [
        (rows, mode, 100 + offset, 40 + rng.randrange(8))
        for offset in range(PIXELS)
        for mode in (0, 1)
        for row in [(1, 0), (0, 0), (0, 7), (2, 5)]
        for rows in [
            *([row, *rng.choices(ROW_CODES, k=2), code] for code in raised),
            *([code, *rng.choices(ROW_CODES, k=2), row] for code in empty),
        ]
    ]
    await check(dut, cases, 108, 512, (1.0, 1.0), 6)


@cocotb.test()
async def all_columns(dut):
    """Every X of the image, at the borders too, for images of several widths."""
    rng = random.Random(2)
    for width in (512, 511, 510, 509, 5, 1):
        cases = [
            ([rng.choice(ROW_CODES) for _ in range(4)], x % 2, x, 4 + x % 16) for x in range(512)
        ]
        await check(dut, cases, width, 512, (0.9, 0.7), width)


@cocotb.test()
async def all_lines(dut):
    """Every line near the upper and lower border, for images of several heights."""
    rng = random.Random(3)
    for height in (1, 2, 7, 8, 512, 1024):
        tops = [*range(-4, 20), *range(max(-4, height - 12), height + 12), 1023, 2046, 2047]
        cases = [
            ([rng.choice(ROW_CODES) for _ in range(4)], mode, rng.randrange(512), top)
            for top in tops
            for mode in (0, 1)
            for _ in range(8)
        ]
        await check(dut, cases, 512, height, (0.7, 0.9), height)


@cocotb.test()
async def what_passes_through(dut):
    """Depth, line and the end token arrive unchanged."""
    rng = random.Random(4)
    fields = [{"z": rng.randrange(512), "end": rng.randrange(2)} for _ in range(200)]
    tops = [rng.randrange(-4, 500) for _ in fields]
    bench = StreamBench(dut, 4)
    full = [(0, 7)] * 4
    bench.source(
        "i", (element(full, 0, 50, t, **f) for t, f in zip(tops, fields, strict=True)), 0.5
    )
    sink = bench.sink("o", 0.5)
    dut.last_column.value = 511
    dut.last_line.value = 511
    dut.oldest.value, dut.running.value = LAST, 1
    await bench.reset()
    await bench.run(lambda: len(sink.received) == len(fields), most_cycles=5000)
    for top, field, bits in zip(tops, fields, sink.received, strict=True):
        assert get(bits, "top") == top % (1 << FOOTPRINT["top"].width)
        assert {name: get(bits, name) for name in field} == field
        if field["end"]:
            assert not footprint_pixels(bits, top, 512)


@cocotb.test()
async def an_element_waits_for_the_window(dut):
    """It comes in the cycle after its last line is in; its first line shows before that."""
    rng = random.Random(5)
    tops = sorted(rng.randrange(-4, 400) for _ in range(150))
    bench = StreamBench(dut, 5)
    cases = [element([(0, 7)] * 4, 0, 50, top) for top in tops]
    source = bench.source("i", [*cases, element([(1, 0)] * 4, 0, 0, LAST, end=1)])
    sink = bench.sink("o", 0.8)
    dut.last_column.value = dut.last_line.value = 511
    oldest = seen = inside = late = running = ran = 0
    dut.oldest.value = dut.running.value = 0
    await bench.reset()

    def drive():
        nonlocal oldest, seen, inside, running, ran
        seen = oldest if running else seen
        oldest += (rng.random() < 0.5) * rng.choice([1, 1, 1, 9])
        ran, running = running, rng.random() < 0.7
        dut.oldest.value, dut.running.value = oldest, running
        inside = source.sent - len(sink.received)

    def observe():
        nonlocal late
        valid = int(dut.o__valid.value)
        top = get(dut.o__payload.value.to_unsigned(), "top")
        if not inside:
            assert not valid
            late = 0
            return
        taken = valid and int(dut.o__ready.value)
        at_hand = len(sink.received) - taken
        if at_hand == len(tops):
            assert valid, "the end waits for no line"
            return
        assert top == tops[at_hand] % (1 << FOOTPRINT["top"].width)
        assert not valid or tops[at_hand] - seen < 8
        if valid or tops[at_hand] - seen >= 8:
            late = 0
        else:
            late += ran
        assert late <= 1, "its lines have been in the window for two cycles"

    await bench.run(
        lambda: len(sink.received) == len(tops) + 1,
        most_cycles=5_000,
        drive=drive,
        observe=observe,
    )
    assert sink.received[-1] >> place("end")[0] & 1


def test_decoder_covers_the_pixels_of_the_contract(simulator_name):
    """In Icarus the random ones alone: all pairs of rows take half a minute there."""
    test = None if simulator_name == "verilator" else "all_columns"
    run_bench(PAPER, Decoder, __file__, simulator_name=simulator_name, test=test)


def test_decoder_covers_them_in_words_of_eight_pixels():
    run_bench(BANKS16, Decoder, __file__, simulator_name="verilator")
