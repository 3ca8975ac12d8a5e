"""A bank of several planes: what a bank does, and every plane of a colour in its place."""

import random
from collections import deque

import cocotb
import pytest
from presets import CONFIG, OTHERS, run_bench

from splatline.rtl.bank import BankRequestLayout
from splatline.rtl.bank_layout import bank_address_bits
from splatline.rtl.layouts import PlaneLayout
from splatline.rtl.planar_bank import PaintLayout, PlanarBank
from splatline.sim.cosim.blocks import pack, unpack
from splatline.sim.cosim.streams import StreamBench

REQUEST, PAINT, PLANE = BankRequestLayout(CONFIG), PaintLayout(CONFIG), PlaneLayout(CONFIG)
WORDS = 1 << bank_address_bits(CONFIG)
BITS, DEPTH = CONFIG.plane_bits, CONFIG.background_depth
BACKGROUND = [(DEPTH, 0)] * 4
WHOLE = 16  # instead of a mask
NOTHING = {"depth": [0] * 4, "colour": [0] * 4}


def cut(pixels):
    """Return what is drawn of a word early and late."""
    plane = [[z >> BITS * n & (1 << BITS) - 1 for _, z in pixels] for n in range(3)]
    early = {"depth": [z for z, _ in pixels], "colour": plane[0]}
    return early, {"depth": plane[2], "colour": plane[1]}


class Operator:
    """Sends requests a cycle at a time and keeps the memory as it ought to be.

    A request is (address, mask or WHOLE, or None for clear, pixels, whether they are the initial
    raster's).
    """

    def __init__(self, dut, seed):
        self.dut = dut
        self.bench = StreamBench(dut, seed)
        self.memory = {}
        self.flight = deque([None] * 3, 3)  # the requests of the three cycles before

    async def reset(self):
        self.dut.enable.value = 1
        self.dut.request.value = 0
        self.dut.new.value = 0
        await self.bench.reset()

    async def cycle(self, request=None, enable=1):
        """One cycle; return whether the request was issued."""
        address, mask = request[:2] if request else (0, 0)
        last, before, third = self.flight
        blocked = before is not None and before["planes"]
        conflict = blocked or (last is not None and last["address"] == address)
        busy_bus = request is not None and before is not None
        busy_bus = busy_bus and mask is not None and (request[3] or before["loaded"])
        issue = bool(request is not None and enable and not conflict and not busy_bus)
        bits = pack(
            REQUEST,
            address=address,
            mask=(mask or 0) % WHOLE,
            whole=int(mask == WHOLE),
            draw=int(issue and mask is not None),
            clear=int(issue and mask is None),
        )

        def drive():
            self.dut.enable.value = enable
            self.dut.request.value = bits
            self.dut.new.value = self.paint(last, third)

        def observe():
            assert int(self.dut.busy.value) == bool(blocked), (request, self.flight)

        await self.bench.step(drive, observe)
        if enable:
            self.finish(last)
            self.flight.appendleft(self.entry(request) if issue else None)
        return issue

    def entry(self, request):
        address, mask, pixels, loaded = request
        return {
            "address": address,
            "mask": mask,
            "pixels": pixels,
            "loaded": loaded,
            "planes": False,
        }

    def paint(self, last, third):
        """What stands on ``new`` one cycle after a request and three cycles after another."""
        values = {"early": NOTHING, "late": NOTHING, "loaded": NOTHING, "depth": [0] * 4}
        for entry, part, place in ((last, 0, "early"), (third, 1, "late")):
            if entry is not None and entry["mask"] is not None:
                values["loaded" if entry["loaded"] else place] = cut(entry["pixels"])[part]
        if last is not None:
            values["depth"] = [z for z, _ in last["pixels"]]
        early = values["early"]
        if CONFIG.colour_planes < 3:
            values["late"] = {**values["late"], "depth": [0] * 4}
        return pack(PAINT, **{**values, "early": early})

    def finish(self, entry):
        if entry is None:
            return
        address, mask = entry["address"], entry["mask"]
        old = self.memory.get(address, BACKGROUND)
        if mask is None:
            entry["planes"] = any(z != DEPTH for z, _ in old)
            self.memory[address] = BACKGROUND
            return
        passes = [
            (mask == WHOLE or bool(mask >> i & 1)) and entry["pixels"][i][0] < before[0]
            for i, before in enumerate(old)
        ]
        entry["planes"] = any(passes)
        self.memory[address] = [
            new if passed else before
            for passed, new, before in zip(passes, entry["pixels"], old, strict=True)
        ]

    async def read(self, address):
        """Clear a word and return what stood there, all planes of it."""
        while not await self.cycle((address, None, BACKGROUND, False)):
            pass
        first = unpack(PLANE, int(self.dut.old.value))
        first = [(first.depth[i] & DEPTH, first.colour[i]) for i in range(4)]
        await self.cycle()
        await self.cycle()
        late = unpack(PLANE, int(self.dut.old.value))
        word = []
        for i, (depth, colour) in enumerate(first):
            colour |= late.colour[i] << BITS
            if CONFIG.colour_planes == 3:
                colour |= (late.depth[i] & (1 << BITS) - 1) << 2 * BITS
            # Under background the colours are whatever they were.
            word.append((depth, colour if depth != DEPTH else 0))
        return word


def random_pixels(rng):
    return [(rng.randrange(DEPTH + 1), rng.getrandbits(CONFIG.colour_bits)) for _ in range(4)]


async def swept(dut, seed):
    """A bank after a reset, cleared a word a cycle without regard to whether it is busy."""
    operator = Operator(dut, seed)
    await operator.reset()
    for address in range(WORDS):
        bits = pack(REQUEST, address=address, mask=0, draw=0, clear=1)
        await operator.bench.step(lambda bits=bits: setattr(dut.request, "value", bits))
    dut.request.value = 0
    for _ in range(4):
        await operator.bench.step()
    return operator


@cocotb.test()
async def random_requests(dut):
    """Few addresses, so that requests collide; standing still now and then; all read back."""
    for seed, spread in enumerate((1, 2, 5, WORDS)):
        rng = random.Random(seed)
        operator = await swept(dut, seed)
        for n in range(500):
            request = None
            if rng.random() < 0.9:
                mask = None if rng.random() < 0.1 else rng.randrange(16)
                loaded = rng.random() < 0.2
                mask = WHOLE if loaded and mask is not None else mask
                request = (rng.randrange(spread), mask, random_pixels(rng), loaded)
            await operator.cycle(request, enable=n < 250 or rng.random() < 0.7)
        for _ in range(4):
            await operator.cycle()
        expected = {a: list(operator.memory.get(a, BACKGROUND)) for a in range(spread)}
        for address in range(spread):
            word = await operator.read(address)
            assert word == [p if p[0] != DEPTH else (DEPTH, 0) for p in expected[address]], address


@cocotb.test()
async def what_is_hidden_costs_one_cycle_and_what_is_drawn_two(dut):
    """The cycle is the second after the request, whatever is asked for then."""
    operator = await swept(dut, 9)

    async def issued(*requests):
        return [await operator.cycle(request) for request in requests]

    def draw(address, depth):
        return address, 15, [(depth, depth)] * 4, False

    near = [draw(address, 5) for address in range(4)]
    far = [draw(address, 6) for address in range(4)]
    # Two drawn, two lost; those that were lost come again.
    assert await issued(*near) == [True, True, False, False]
    assert await issued(*near[2:], None, None) == [True, True, False, False]
    assert await issued(*far, *far) == [True] * 8
    assert await issued(far[1], far[1], far[1]) == [True, False, True]
    clears = [(address, None, BACKGROUND, False) for address in range(3)]
    assert await issued(clears[0], None, clears[1], clears[1]) == [True, False, False, True]
    await issued(None, None, None)
    # Nothing was in them any more.
    assert await issued(clears[0], clears[1], clears[0], clears[1]) == [True] * 4


@pytest.mark.parametrize("config", [c for c in OTHERS if c.colour_planes > 1], ids=lambda c: c.name)
def test_planes_merge_by_depth(config):
    run_bench(config, PlanarBank, __file__)
