"""Dealing to the banks: every pixel once, in its own place, in no more cycles than needed."""

import random
from collections import Counter

import cocotb
import pytest
from footprints import PIXELS, footprint, place_of_word
from presets import CONFIG, run_bench

from splatline.rtl.layouts import DealLayout
from splatline.rtl.presets import WIDE
from splatline.rtl.scatter import Scatter
from splatline.rtl.variants import BANKS16, BANKS16_WORD4
from splatline.sim.cosim.blocks import unpack
from splatline.sim.cosim.streams import StreamBench

DEAL = DealLayout(CONFIG)


def random_spans(rng):
    rows = rng.choice([range(8), range(4), range(2, 6), [rng.randrange(8)], []])
    spans = {}
    for row in rows:
        first = rng.randrange(8)
        spans[row] = (first, rng.randrange(first, 8))
    return spans


class Banks:
    """Banks that take what they are dealt, some at a time; elements come one by one."""

    def __init__(self, dut, seed, stall):
        self.dut, self.stall = dut, stall
        self.bench = StreamBench(dut, seed)
        self.source = self.bench.source("i", [], 1.0 - stall)
        self.taken = {}  # what banks took in the cycle before
        self.got = []  # (bank, address, mask) of the element at hand
        self.waits = 0

    async def start(self):
        for name in ("enable", "taken", "o__ready"):
            getattr(self.dut, name).value = 0
        await self.bench.reset()

    async def cycle(self):
        """Return whether what was dealt is all taken in this cycle."""
        await self.bench.step(self.drive)
        return self.finished

    def drive(self):
        """All inputs but the elements; outputs are registers, and steady by now."""
        dut, rng = self.dut, self.bench.random
        enable = rng.random() >= self.stall
        deal = unpack(DEAL, int(dut.o__payload.value))
        stale, now, left = int(dut.stale.value), {}, 0
        self.finished = False
        if int(dut.o__valid.value):
            for bank in range(CONFIG.banks):
                if not deal.want >> bank & 1:
                    continue
                share = deal.shares[bank]
                resting = share.address == self.taken.get(bank)
                assert resting == bool(stale >> bank & 1), "stale for as long as it is written"
                if resting or not enable or rng.random() < self.stall:
                    left += 1
                    continue
                now[bank] = share.address
                self.got.append((bank, share.address, share.mask))
            self.finished = enable and not left
            self.waits += not self.finished
        dut.enable.value = enable
        dut.taken.value = sum(1 << bank for bank in now)
        dut.o__ready.value = self.finished
        if enable:
            self.taken = now

    async def draw(self, bits):
        """Let an element be drawn alone; return its words and the deals that it took."""
        self.source.payloads, self.source.sent, deals = [bits], 0, 0
        self.got.clear()
        while not self.source.sent or int(self.dut.o__valid.value):
            deals += await self.cycle()
            assert self.bench.cycles < 100_000, "an element that never ends"
        return list(self.got), deals


async def check(dut, stall, seed, count):
    rng = random.Random(seed)
    banks = Banks(dut, seed, stall)
    await banks.start()
    for _ in range(count):
        top, x = rng.randrange(-4, 60), rng.randrange(512)
        bits, pixels = footprint(top, x, random_spans(rng))
        expected = {}
        for line, column in pixels:
            place = place_of_word(line, column // PIXELS)
            expected[place] = expected.get(place, 0) | 1 << column % PIXELS
        requests, deals = await banks.draw(bits)
        found = {(bank, address): mask for bank, address, mask in requests}
        assert len(found) == len(requests), "a word was asked for twice"
        assert found == expected, (top, x)
        assert deals == max(Counter(bank for bank, _ in expected).values(), default=1)
        assert deals == 1 or PIXELS == 4, "of eight pixels an element has no two words in a bank"


@cocotb.test()
async def free_banks(dut):
    """As many deals as the busiest bank has words, 1 to 3 or, of sixteen, 2; of 8 pixels, 1."""
    await check(dut, 0.0, 1, 400)


@cocotb.test()
async def busy_banks(dut):
    """Banks that are not free, and pauses, lose and repeat nothing."""
    await check(dut, 0.4, 2, 200)


@cocotb.test()
async def elements_in_a_row(dut):
    """A deal a cycle; a word that two elements in a row have rests for a cycle."""
    for seed, stall in enumerate((0.0, 0.3)):
        rng = random.Random(seed)
        banks = Banks(dut, seed, stall)
        await banks.start()
        elements, expected, deals = [], Counter(), 0
        for _ in range(300):
            # Few places, so that words come again after none, one or more elements.
            x = PIXELS * rng.randrange(6)
            bits, pixels = footprint(8 + rng.randrange(3), x, random_spans(rng))
            words = {place_of_word(line, column // PIXELS) for line, column in pixels}
            expected.update(words)
            deals += max(Counter(bank for bank, _ in words).values(), default=1)
            elements.append(bits)
        banks.source.payloads, banks.source.sent = elements, 0
        begin = banks.bench.cycles
        while banks.source.sent < len(elements) or int(dut.o__valid.value):
            await banks.cycle()
            assert banks.bench.cycles - begin < 20_000
        assert Counter((bank, address) for bank, address, _ in banks.got) == expected
        if not stall:
            assert banks.waits > 20
            assert banks.bench.cycles - begin <= deals + banks.waits + 2


@cocotb.test()
async def four_lines_of_two_words_take_one_deal(dut):
    """What the two interleaved halves of a line are for."""
    banks = Banks(dut, 3, 0.0)
    await banks.start()
    for top in range(8):
        bits, _ = footprint(top, 6, dict.fromkeys(range(2, 6), (0, 5)))
        requests, deals = await banks.draw(bits)
        assert (len(requests), deals) == (8, 1)


def test_scatter_deals_every_word_once(block_simulator):
    run_bench(WIDE, Scatter, __file__, simulator_name=block_simulator)


@pytest.mark.parametrize("config", [BANKS16, BANKS16_WORD4], ids=lambda config: config.name)
def test_scatter_deals_every_word_once_to_sixteen_banks(config):
    run_bench(config, Scatter, __file__, simulator_name="verilator")
