"""Dealing to the banks: every pixel once, in its own place, in no more cycles than needed."""

import random
from collections import Counter

import cocotb
from footprints import footprint, place_of_word

from splatline.rtl.bank import BankRequestLayout
from splatline.rtl.format import PAPER
from splatline.rtl.scatter import BANKS, Scatter
from splatline.sim.cosim.blocks import run_bench
from splatline.sim.cosim.streams import StreamBench

REQUEST = BankRequestLayout(PAPER)


def random_spans(rng):
    rows = rng.choice([range(8), range(4), range(2, 6), [rng.randrange(8)], []])
    spans = {}
    for row in rows:
        first = rng.randrange(8)
        spans[row] = (first, rng.randrange(first, 8))
    return spans


async def deal(dut, bench, bits, stall):
    """Run one footprint to its end; return its requests and the cycles it took."""
    requests, cycles, done = [], 0, False
    while not done:
        seen = {}

        def drive():
            dut.footprint.value = bits
            dut.go.value = bench.random.random() >= stall
            dut.conflict.value = bench.random.getrandbits(8) if stall else 0

        def observe(seen=seen):
            seen["go"] = int(dut.go.value)
            seen["done"] = int(dut.done.value)
            seen["requests"] = int(dut.requests.value)
            seen["conflict"] = int(dut.conflict.value)

        await bench.step(drive, observe)
        cycles += 1
        assert cycles < 400, "an element that never ends"
        for bank in range(BANKS):
            request = REQUEST.from_bits(
                seen["requests"] >> bank * REQUEST.size & (1 << REQUEST.size) - 1
            )
            if request.draw:
                assert seen["go"] and not seen["conflict"] >> bank & 1
                requests.append((bank, request.address, request.mask))
        done = bool(seen["done"])
    return requests, cycles


async def check(dut, stall, seed, count):
    rng = random.Random(seed)
    bench = StreamBench(dut, seed)
    dut.go.value = 0
    dut.footprint.value = 0
    dut.conflict.value = 0
    dut.whole.value = 0
    await bench.reset()
    for _ in range(count):
        top, x = rng.randrange(-4, 60), rng.randrange(512)
        bits, pixels = footprint(top, x, random_spans(rng))
        expected = {}
        for line, column in pixels:
            place = place_of_word(line, column // 4)
            expected[place] = expected.get(place, 0) | 1 << column % 4
        requests, cycles = await deal(dut, bench, bits, stall)
        found = {(bank, address): mask for bank, address, mask in requests}
        assert len(found) == len(requests), "a word was asked for twice"
        assert found == expected, (top, x)
        if not stall:
            busiest = max(Counter(bank for bank, _ in expected).values(), default=1)
            assert cycles == busiest


@cocotb.test()
async def free_banks(dut):
    """As many cycles as the busiest bank has words, 1 to 3."""
    await check(dut, 0.0, 1, 1500)


@cocotb.test()
async def busy_banks(dut):
    """Conflicts and pauses lose and repeat nothing."""
    await check(dut, 0.4, 2, 500)


@cocotb.test()
async def four_lines_of_two_words_take_one_cycle(dut):
    """What the two interleaved halves of a line are for."""
    bench = StreamBench(dut, 3)
    dut.go.value = 0
    dut.conflict.value = 0
    dut.whole.value = 0
    dut.footprint.value = 0
    await bench.reset()
    for top in range(8):
        bits, _ = footprint(top, 6, dict.fromkeys(range(2, 6), (0, 5)))
        requests, cycles = await deal(dut, bench, bits, 0.0)
        assert (len(requests), cycles) == (8, 1)


def test_scatter_deals_every_word_once(simulator_name):
    run_bench(Scatter(PAPER), __file__, simulator_name=simulator_name)
