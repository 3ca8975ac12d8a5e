"""The ring of lines: touched ones are flushed whole and in order, others are stepped over."""

import random

import cocotb

from splatline.rtl.format import PAPER
from splatline.rtl.ring import PlaceLayout, Ring
from splatline.sim.cosim.blocks import run_bench
from splatline.sim.cosim.streams import StreamBench

PLACE = PlaceLayout(PAPER)
FAR = (1 << PAPER.line_bits + 1) - 1


async def play(dut, seed, rate, height, last_word, share, jump):
    """Slide down an image, touching lines at random; return the touched lines and the flushes."""
    rng = random.Random(seed)
    bench = StreamBench(dut, seed)
    flush = bench.sink("flush", rate)
    for name in ("touch", "load", "load_place", "restart"):
        getattr(dut, name).value = 0
    dut.top.value = -4 % (1 << PAPER.line_bits + 2)
    dut.loaded.value, dut.jump.value, dut.last_word.value = 1, jump, last_word
    await bench.reset()
    touched, top, cycles = set(), -4, 0
    while top < height:
        # Only lines that stand in the window may be touched: the eight from the top on.
        oldest = int(dut.oldest.value)
        lines = [n for n in range(max(top, 0), min(top + 8, height)) if rng.random() < share]
        if top - oldest >= 8:
            lines = []
        touched |= set(lines)
        mask = sum({1 << n % 16 for n in lines})
        shown = top % (1 << PAPER.line_bits + 2)

        def drive(mask=mask, shown=shown):
            dut.touch.value = mask
            dut.top.value = shown

        await bench.step(drive)
        if top - oldest < 8:
            top += rng.choice([0, 0, 1, 1, 2, 7])
        cycles += 1
        assert cycles < 100_000

    def finish():
        dut.touch.value = 0
        dut.top.value = FAR

    await bench.step(finish)
    await bench.run(lambda: bool(int(dut.clean.value)), most_cycles=50_000, drive=finish)
    places = [PLACE.from_bits(bits) for bits in flush.received]
    return touched, [(place.line, place.word) for place in places]


@cocotb.test()
async def touched_lines_are_flushed_whole_and_in_order(dut):
    """Dense and sparse images, any readiness of what comes after."""
    cases = [
        (1.0, 60, 5, 0.5, 1),
        (0.3, 60, 5, 0.1, 1),
        (0.7, 40, 0, 1.0, 1),
        (0.5, 200, 3, 0.02, 0),
    ]
    for seed, (rate, height, last_word, share, jump) in enumerate(cases):
        touched, flushed = await play(dut, seed, rate, height, last_word, share, jump)
        words = range(last_word + 1)
        assert flushed == [(line, word) for line in sorted(touched) for word in words]


@cocotb.test()
async def untouched_lines_leave_at_once(dut):
    """With no initial raster to come, a clean window jumps to where it is needed."""
    bench = StreamBench(dut, 9)
    bench.sink("flush")
    for name in ("touch", "load", "load_place", "restart", "last_word"):
        getattr(dut, name).value = 0
    dut.loaded.value, dut.jump.value, dut.top.value = 1, 1, 700
    await bench.reset()
    await bench.step()
    assert int(dut.oldest.value) == 700
    await bench.step(lambda: setattr(dut.restart, "value", 1))
    assert int(dut.oldest.value) == 0


@cocotb.test()
async def a_line_stays_until_it_is_loaded(dut):
    """A line that the initial raster may still write into does not leave."""
    bench = StreamBench(dut, 10)
    flush = bench.sink("flush")
    for name in ("touch", "restart", "last_word", "jump", "loaded"):
        getattr(dut, name).value = 0
    dut.top.value = 3
    dut.load_place.value, dut.load.value = 0, 1
    await bench.reset()
    for _ in range(5):
        await bench.step()
    assert (int(dut.oldest.value), len(flush.received)) == (0, 0)

    def loaded():
        dut.load.value, dut.loaded.value = 0, 1

    for _ in range(8):
        await bench.step(loaded)
    assert [PLACE.from_bits(bits).line for bits in flush.received] == [0]
    assert int(dut.oldest.value) == 3


def test_ring_flushes_what_was_touched(simulator_name):
    run_bench(Ring(PAPER), __file__, simulator_name=simulator_name)
