"""A bank: depth test, merge and write back, and loads beside it, whatever follows whatever."""

import random
from collections import deque

import cocotb

from splatline.rtl.bank import Bank, BankRequestLayout
from splatline.rtl.bank_layout import bank_address_bits
from splatline.rtl.layouts import WordLayout
from splatline.rtl.presets import PAPER
from splatline.sim.cosim.blocks import pack, run_bench, unpack
from splatline.sim.cosim.streams import StreamBench

REQUEST, WORD = BankRequestLayout(PAPER), WordLayout(PAPER)
WORDS = 1 << bank_address_bits(PAPER)
BACKGROUND = [(511, 0)] * 4
CLEAR, LOAD = "clear", "load"  # instead of a mask


def random_pixels(rng):
    return [(rng.randrange(512), rng.randrange(512)) for _ in range(4)]


def word_of(pixels):
    return pack(WORD, depth=[z for z, _ in pixels], colour=[c for _, c in pixels])


class Operator:
    """Sends requests a cycle at a time and keeps the memory as it ought to be."""

    def __init__(self, dut, seed):
        self.dut = dut
        self.bench = StreamBench(dut, seed)
        self.memory = {}
        self.last = None  # the request of the cycle before
        self.leaving = deque([None] * 2, 2)  # and what they send out, if that is known

    async def reset(self):
        self.dut.enable.value = 1
        for name in ("request", "new", "loaded"):
            getattr(self.dut, name).value = 0
        await self.bench.reset()

    async def cycle(self, request=None, enable=1):
        """One cycle: a request, unless it is too soon after one that writes that word.

        A request is (address, mask or CLEAR or LOAD, pixels).

        Return whether it was issued.
        """
        address, mask, pixels = request or (0, None, BACKGROUND)
        last = self.last
        too_soon = last is not None and last[0] == address and last[1] != LOAD
        asked = request is not None and not too_soon
        # What means nothing is anything.
        random = self.bench.random
        bits = pack(
            REQUEST,
            address=address,
            mask=random.randrange(16) if mask in (None, CLEAR, LOAD) else mask,
            draw=asked and mask not in (CLEAR, LOAD),
            clear=asked and mask == CLEAR,
            load=asked and mask == LOAD,
        )
        loaded = pixels if mask == LOAD else random_pixels(random)
        drawn = last is not None and last[1] != CLEAR

        def drive():
            self.dut.enable.value = enable
            # While all stands still it is asked for in vain.
            self.dut.request.value = bits
            self.dut.loaded.value = word_of(loaded)
            drawing = last is not None and last[1] != LOAD
            self.dut.new.value = word_of(last[2] if drawing else random_pixels(random))

        def observe():
            assert int(self.dut.drawn.value) == drawn
            assert not drawn or int(self.dut.drawn_address.value) == last[0]
            assert self.leaving[-1] in (None, self.given())

        await self.bench.step(drive, observe)
        issue = bool(asked and enable)
        if enable:
            self.last = request if issue else None
            cleared = issue and mask == CLEAR
            self.leaving.appendleft(self.memory.get(request[0]) if cleared else BACKGROUND)
            if issue:
                self._do(request)
        return issue

    def given(self):
        """The word on its way out."""
        word = unpack(WORD, int(self.dut.leaving.value))
        return [(word.depth[i], word.colour[i]) for i in range(4)]

    def _do(self, request):
        address, mask, pixels = request
        old = self.memory.get(address, BACKGROUND)
        if mask in (CLEAR, LOAD):
            self.memory[address] = pixels if mask == LOAD else BACKGROUND
        else:
            self.memory[address] = [
                new if mask >> i & 1 and new[0] < before[0] else before
                for i, (new, before) in enumerate(zip(pixels, old, strict=True))
            ]

    async def read(self, address):
        """Clear a word and return what stood there."""
        while not await self.cycle((address, CLEAR, BACKGROUND)):
            pass
        await self.cycle()
        return self.given()


@cocotb.test()
async def random_requests(dut):
    """Few addresses, so that requests collide; standing still now and then; all read back."""
    for seed, spread in enumerate((1, 2, 5, WORDS)):
        rng = random.Random(seed)
        operator = Operator(dut, seed)
        await operator.reset()
        for address in range(WORDS):
            await operator.cycle((address, CLEAR, BACKGROUND))
        await operator.cycle()
        for _ in range(1500):
            request = None
            if rng.random() < 0.9:
                mask = rng.choice([CLEAR, LOAD, LOAD, *range(16)])
                request = (rng.randrange(spread), mask, random_pixels(rng))
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
    await operator.cycle((3, CLEAR, BACKGROUND))
    for mask, depth, colour in (
        (0b1111, 100, 1),
        (0b0011, 100, 2),
        (0b0110, 99, 3),
        (0b1000, 101, 4),
        (0b1111, 100, 5),
    ):
        while not await operator.cycle((3, mask, [(depth, colour)] * 4)):
            pass
    await operator.cycle()
    assert await operator.read(3) == [(100, 1), (99, 3), (99, 3), (100, 1)]


@cocotb.test()
async def a_load_is_a_copy(dut):
    """In one cycle, beside the write of a word; whatever was there, and whatever comes."""
    operator = Operator(dut, 10)
    await operator.reset()

    async def play(*requests):
        for request in requests:
            assert await operator.cycle(request) == (request is not None)

    near, far = ([(z, z)] * 4 for z in (5, 400))
    mixed = [(300, 1), (511, 0), (0, 3), (511, 9)]
    await play((3, CLEAR, BACKGROUND), (4, CLEAR, BACKGROUND), None, None)
    await play((4, 15, near), None, (3, LOAD, near), (3, LOAD, mixed), (3, 0b0011, far), None)
    assert await operator.read(3) == [(300, 1), (400, 400), (0, 3), (511, 9)]
    assert await operator.read(4) == near
    await play(None, (3, LOAD, near), (3, LOAD, BACKGROUND), (4, LOAD, far))
    assert await operator.read(3) == BACKGROUND
    assert await operator.read(4) == far


def test_bank_merges_by_depth(block_simulator):
    run_bench(Bank(PAPER), __file__, simulator_name=block_simulator)
