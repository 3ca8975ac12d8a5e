"""A bank: depth test, merge and write back, whatever follows whatever."""

import random
from collections import deque

import cocotb

from splatline.rtl.bank import Bank, BankRequestLayout
from splatline.rtl.bank_layout import bank_address_bits
from splatline.rtl.format import PAPER
from splatline.rtl.layouts import WordLayout
from splatline.sim.cosim.blocks import pack, run_bench, unpack
from splatline.sim.cosim.streams import StreamBench

REQUEST, WORD = BankRequestLayout(PAPER), WordLayout(PAPER)
WORDS = 1 << bank_address_bits(PAPER)
BACKGROUND = [(511, 0)] * 4
WHOLE = 16  # instead of a mask


class Operator:
    """Sends requests a cycle at a time and keeps the memory as it ought to be."""

    def __init__(self, dut, seed):
        self.dut = dut
        self.bench = StreamBench(dut, seed)
        self.memory = {}
        self.flight = deque([None] * 2, 2)  # the requests of the two cycles before

    async def reset(self):
        self.dut.enable.value = 1
        self.dut.request.value = 0
        self.dut.new.value = 0
        await self.bench.reset()

    async def cycle(self, request=None, enable=1):
        """One cycle: a request, unless it is too soon.

        A request is (address, mask or WHOLE, or None for clear, pixels).

        Return whether it was issued.
        """
        address, mask, _ = request or (0, 0, BACKGROUND)
        last, before = self.flight
        too_soon = any(flying is not None and flying[0] == address for flying in self.flight)
        issue = bool(request is not None and enable and not too_soon)
        bits = pack(
            REQUEST,
            address=address,
            mask=(mask or 0) % WHOLE,
            whole=int(mask == WHOLE),
            draw=int(issue and mask is not None),
            clear=int(issue and mask is None),
        )
        drawn = last is not None and last[1] is not None

        def drive():
            self.dut.enable.value = enable
            self.dut.request.value = bits
            if before is not None:
                pixels = before[2]
                self.dut.new.value = pack(
                    WORD, depth=[z for z, _ in pixels], colour=[c for _, c in pixels]
                )

        def observe():
            assert int(self.dut.drawn.value) == drawn
            assert not drawn or int(self.dut.drawn_address.value) == last[0]

        await self.bench.step(drive, observe)
        if enable:
            self.flight.appendleft(request if issue else None)
            if issue:
                self._draw(request)
        return issue

    def _draw(self, request):
        address, mask, pixels = request
        old = self.memory.get(address, BACKGROUND)
        if mask is None:
            self.memory[address] = BACKGROUND
        else:
            self.memory[address] = [
                new if (mask == WHOLE or mask >> i & 1) and new[0] < before[0] else before
                for i, (new, before) in enumerate(zip(pixels, old, strict=True))
            ]

    async def read(self, address):
        """Clear a word and return what stood there."""
        while not await self.cycle((address, None, BACKGROUND)):
            pass
        await self.cycle()
        word = unpack(WORD, int(self.dut.old.value))
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
                mask = None if rng.random() < 0.05 else rng.randrange(WHOLE + 1)
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
        (WHOLE, 100, 5),
    ):
        while not await operator.cycle((3, mask, [(depth, colour)] * 4)):
            pass
    await operator.cycle()
    assert await operator.read(3) == [(100, 1), (99, 3), (99, 3), (100, 1)]


def test_bank_merges_by_depth(block_simulator):
    run_bench(Bank(PAPER), __file__, simulator_name=block_simulator)
