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
CLEAR, LOAD, FURTHER = "clear", "load", "further"  # instead of a mask


def cut(pixels):
    """Return what is drawn or loaded of a word early and late."""
    plane = [[z >> BITS * n & (1 << BITS) - 1 for _, z in pixels] for n in range(3)]
    early = {"depth": [z for z, _ in pixels], "colour": plane[0]}
    return early, {"depth": plane[2], "colour": plane[1]}


class Operator:
    """Sends requests a cycle at a time and keeps the memory as it ought to be.

    A request is (address, mask or CLEAR or LOAD or FURTHER, pixels). A word that was loaded has its
    further planes loaded next, before anything else is done with it: ``half`` has those words.
    """

    def __init__(self, dut, seed):
        self.dut = dut
        self.bench = StreamBench(dut, seed)
        self.memory = {}
        self.half = {}
        self.flight = deque([None] * 3, 3)  # the requests of the three cycles before

    async def reset(self):
        self.dut.enable.value = 1
        for name in ("request", "new", "loaded"):
            getattr(self.dut, name).value = 0
        await self.bench.reset()

    async def cycle(self, request=None, enable=1):
        """One cycle; return whether the request was issued."""
        address, kind, pixels = request or (0, None, BACKGROUND)
        assert (address in self.half) == (kind == FURTHER) or request is None
        last, before, third = self.flight
        blocked = before is not None and before["planes"]
        conflict = last is not None and last["address"] == address and not last["loads"]
        asked = request is not None and not blocked and not conflict
        drawn = last is not None and last["kind"] != CLEAR
        # What means nothing is anything.
        random = self.bench.random
        masked = kind not in (None, CLEAR, LOAD, FURTHER)
        bits = pack(
            REQUEST,
            address=address,
            mask=kind if masked else random.randrange(16),
            draw=asked and masked,
            clear=asked and kind == CLEAR,
            load=asked and kind in (LOAD, FURTHER),
            further=asked and kind == FURTHER,
        )
        loaded = {LOAD: cut(pixels)[0], FURTHER: self.late(pixels)}.get(kind, self.noise())

        def drive():
            self.dut.enable.value = enable
            # While all stands still it is asked for in vain.
            self.dut.request.value = bits
            self.dut.new.value = self.paint(last, third)
            self.dut.loaded.value = pack(PLANE, **loaded)

        def observe():
            assert int(self.dut.busy.value) == bool(blocked), (request, self.flight)
            assert int(self.dut.drawn.value) == drawn
            assert not drawn or int(self.dut.drawn_address.value) == last["address"]

        await self.bench.step(drive, observe)
        issue = bool(asked and enable)
        if enable:
            self.finish(last)
            self.flight.appendleft(self.entry(request) if issue else None)
        return issue

    def entry(self, request):
        address, kind, pixels = request
        if kind == LOAD:
            self.half[address] = pixels
        elif kind == FURTHER:
            del self.half[address]
        loads = kind in (LOAD, FURTHER)
        return {
            "address": address,
            "kind": kind,
            "pixels": pixels,
            "loads": loads,
            "draws": not loads and kind != CLEAR,
            "planes": False,
        }

    def noise(self):
        return cut(random_pixels(self.bench.random))[0]

    def late(self, pixels):
        """The further planes of a word: of two planes the memory of the depths has none."""
        late = cut(pixels)[1]
        return late if CONFIG.colour_planes == 3 else {**late, "depth": self.noise()["depth"]}

    def paint(self, last, third):
        """What stands on ``new`` one cycle after a request and three cycles after another."""
        early, late = self.noise(), self.noise()
        if last is not None and last["draws"]:
            early = cut(last["pixels"])[0]
        if third is not None and third["draws"]:
            late = self.late(third["pixels"])
        return pack(PAINT, early=early, late=late)

    def finish(self, entry):
        if entry is None:
            return
        address, kind = entry["address"], entry["kind"]
        old = self.memory.get(address, BACKGROUND)
        if kind == CLEAR:
            entry["planes"] = any(z != DEPTH for z, _ in old)
            self.memory[address] = BACKGROUND
        elif kind == LOAD:
            self.memory[address] = entry["pixels"]
        elif entry["draws"]:
            passes = [
                bool(kind >> i & 1) and entry["pixels"][i][0] < before[0]
                for i, before in enumerate(old)
            ]
            entry["planes"] = any(passes)
            self.memory[address] = [
                new if passed else before
                for passed, new, before in zip(passes, entry["pixels"], old, strict=True)
            ]

    async def read(self, address):
        """Clear a word and return what stood there, all planes of it."""
        while not await self.cycle((address, CLEAR, BACKGROUND)):
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
                address = rng.randrange(spread)
                kind = rng.choice([CLEAR] * 2 + [LOAD] * 4 + [*range(16)])
                request = (address, kind, random_pixels(rng))
                if address in operator.half:
                    request = (address, FURTHER, operator.half[address])
            await operator.cycle(request, enable=n < 250 or rng.random() < 0.7)
        for address, pixels in list(operator.half.items()):
            while not await operator.cycle((address, FURTHER, pixels)):
                pass
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
        return address, 15, [(depth, depth)] * 4

    near = [draw(address, 5) for address in range(4)]
    far = [draw(address, 6) for address in range(4)]
    # Two drawn, two lost; those that were lost come again.
    assert await issued(*near) == [True, True, False, False]
    assert await issued(*near[2:], None, None) == [True, True, False, False]
    assert await issued(*far, *far) == [True] * 8
    assert await issued(far[1], far[1], far[1]) == [True, False, True]
    clears = [(address, CLEAR, BACKGROUND) for address in range(3)]
    assert await issued(clears[0], None, clears[1], clears[1]) == [True, False, False, True]
    await issued(None, None, None)
    # Nothing was in them any more.
    assert await issued(clears[0], clears[1], clears[0], clears[1]) == [True] * 4


@cocotb.test()
async def a_load_is_a_copy(dut):
    """In two cycles, beside the writes of words; whatever was there, and whatever comes."""
    operator = await swept(dut, 10)

    async def play(*requests):
        for request in requests:
            assert await operator.cycle(request) == (request is not None), request

    def pixels(*depths):
        return [(z, z * 1_000_003 % (1 << CONFIG.colour_bits)) for z in depths]

    near, far, mixed = pixels(5, 5, 5, 5), pixels(400, 400, 400, 400), pixels(300, DEPTH, 0, 401)
    # Both parts beside a write to word 4: of its further planes, and of its depths.
    await play((4, 15, near), None, None, (3, LOAD, far), (3, FURTHER, far))
    await play((3, LOAD, mixed), (4, 15, far), (3, FURTHER, mixed), (3, 0b1010, far), None, None)
    await play(None, None)
    drawn = [mixed[0], far[1], mixed[2], far[3]]
    assert await operator.read(3) == drawn
    assert await operator.read(4) == near
    await play(None, (3, LOAD, near), (3, FURTHER, near))
    await play((3, LOAD, BACKGROUND), (4, LOAD, far), (3, FURTHER, BACKGROUND), (4, FURTHER, far))
    # Nothing of this takes the bank for longer.
    await play((3, CLEAR, BACKGROUND), (4, 15, pixels(*[401] * 4)), (5, CLEAR, BACKGROUND))
    await play(None, None)
    assert await operator.read(3) == BACKGROUND
    assert await operator.read(4) == far


@pytest.mark.parametrize("config", [c for c in OTHERS if c.colour_planes > 1], ids=lambda c: c.name)
def test_planes_merge_by_depth(config):
    run_bench(config, PlanarBank, __file__)
