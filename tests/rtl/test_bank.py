"""A bank: depth test, merge and write back, whatever follows whatever."""

import random

import cocotb

from splatline.rtl.bank import Bank, BankRequestLayout, bank_address_bits
from splatline.rtl.format import PAPER
from splatline.rtl.layouts import WordLayout
from splatline.sim.cosim.blocks import pack, run_bench
from splatline.sim.cosim.streams import StreamBench

REQUEST, WORD = BankRequestLayout(PAPER), WordLayout(PAPER)
WORDS = 1 << bank_address_bits(PAPER)
BACKGROUND = [(511, 0)] * 4


class Operator:
    """Sends requests a cycle at a time and keeps the memory as it ought to be."""

    def __init__(self, dut, seed):
        self.dut = dut
        self.bench = StreamBench(dut, seed)
        self.memory = {}
        self.in_flight = None

    async def reset(self):
        self.dut.enable.value = 1
        self.dut.request.value = 0
        self.dut.new.value = 0
        await self.bench.reset()

    async def cycle(self, request=None, enable=1):
        """One cycle: a request (address, mask or None for clear, pixels) unless it conflicts.

        Return whether it was issued.
        """
        address, mask, _ = request or (0, 0, BACKGROUND)
        conflict = self.in_flight is not None and self.in_flight[0] == address
        issue = bool(request is not None and enable and not conflict)
        bits = pack(
            REQUEST,
            address=address,
            mask=mask or 0,
            draw=int(issue and mask is not None),
            clear=int(issue and mask is None),
        )

        def drive():
            self.dut.enable.value = enable
            self.dut.request.value = bits
            if self.in_flight is not None:
                drawn = self.in_flight[2]
                self.dut.new.value = pack(
                    WORD, depth=[z for z, _ in drawn], colour=[c for _, c in drawn]
                )

        def observe():
            if request is not None:
                assert int(self.dut.conflict.value) == conflict, (request, self.in_flight)

        await self.bench.step(drive, observe)
        if enable:
            self._finish()
            if issue:
                self.in_flight = request
        return issue

    def _finish(self):
        if self.in_flight is None:
            return
        address, mask, pixels = self.in_flight
        old = self.memory.get(address, BACKGROUND)
        if mask is None:
            self.memory[address] = BACKGROUND
        else:
            self.memory[address] = [
                new if mask >> i & 1 and new[0] < before[0] else before
                for i, (new, before) in enumerate(zip(pixels, old, strict=True))
            ]
        self.in_flight = None

    async def read(self, address):
        """Clear a word and return what stood there."""
        while not await self.cycle((address, None, BACKGROUND)):
            pass
        word = WORD.from_bits(int(self.dut.old.value))
        return [(word.depth[i], word.colour[i]) for i in range(4)]


@cocotb.test()
async def random_requests(dut):
    """Few addresses, so that requests collide; standing still now and then; all read back."""
    for seed, spread in enumerate((1, 2, 5, WORDS)):
        rng = random.Random(seed)
        operator = Operator(dut, seed)
        await operator.reset()
        for address in range(WORDS):
            await operator.cycle((address, None, BACKGROUND))
        await operator.cycle()
        for _ in range(1500):
            request = None
            if rng.random() < 0.9:
                mask = None if rng.random() < 0.05 else rng.randrange(16)
                pixels = [(rng.randrange(512), rng.randrange(512)) for _ in range(4)]
                request = (rng.randrange(spread), mask, pixels)
            await operator.cycle(request, enable=rng.random() < 0.8)
        await operator.cycle()
        expected = {a: list(operator.memory.get(a, BACKGROUND)) for a in range(spread)}
        for address in range(spread):
            assert await operator.read(address) == expected[address], address


@cocotb.test()
async def nearer_wins_and_equal_stays(dut):
    """Z < stored draws, Z == stored and Z > stored do not; only pixels of the mask."""
    operator = Operator(dut, 9)
    await operator.reset()
    await operator.cycle((3, None, BACKGROUND))
    for mask, depth, colour in (
        (0b1111, 100, 1),
        (0b0011, 100, 2),
        (0b0110, 99, 3),
        (0b1000, 101, 4),
    ):
        await operator.cycle()
        await operator.cycle((3, mask, [(depth, colour)] * 4))
    await operator.cycle()
    assert await operator.read(3) == [(100, 1), (99, 3), (99, 3), (100, 1)]


@cocotb.test()
async def a_word_rests_for_one_cycle(dut):
    """The same word again has to wait for one cycle, another word never; a third try is free."""
    operator = Operator(dut, 10)
    await operator.reset()
    same, other = (7, 0b1111, [(1, 1)] * 4), (8, 0b1111, [(1, 1)] * 4)
    issued = [await operator.cycle(r) for r in (same, same, same, other, same, other, other)]
    assert issued == [True, False, True, True, True, True, False]


def test_bank_merges_by_depth(simulator_name):
    run_bench(Bank(PAPER), __file__, simulator_name=simulator_name)
