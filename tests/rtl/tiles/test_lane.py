"""A lane: depth test and write back, one pixel a cycle, standing still in between."""

import random

import cocotb

from splatline.contract.presets import PAPER
from splatline.rtl.layouts import PixelLayout
from splatline.rtl.tiles.lane import Lane, LaneRequestLayout, lane_address_bits
from splatline.sim.cosim.blocks import pack, run_bench, unpack
from splatline.sim.cosim.streams import StreamBench
from tests.support.bench_config import CONFIG, PAIRED
from tests.support.bench_config import run_bench as run_preset

REQUEST, PIXEL = LaneRequestLayout(PAPER), PixelLayout(PAPER)
PIXELS = 1 << lane_address_bits(PAPER)
BACKGROUND = (PAPER.background_depth, None)  # its colour means nothing
CLEAR = None


class Operator:
    """Sends requests a cycle at a time and keeps the pixels as they ought to be.

    Beside a request that is in flight another pixel may be loaded, which is there at once.
    """

    def __init__(self, dut, seed):
        self.dut = dut
        self.bench = StreamBench(dut, seed)
        self.pixels = {}
        self.in_flight = None

    async def reset(self):
        self.dut.enable.value = 1
        self.dut.request.value = self.dut.new_.value = self.dut.loaded.value = 0
        await self.bench.reset()
        for address in range(PIXELS):
            await self.cycle((address, CLEAR))
        await self.cycle()

    async def cycle(self, request=None, enable=1, load=False):
        """One cycle: a request (address, pixel or CLEAR) is taken if the lane is enabled."""
        # As the lane demands, its user leaves a pixel alone that is being written.
        assert request is None or self.in_flight is None or request[0] != self.in_flight[0]
        address, pixel = request or (self.bench.random.randrange(PIXELS), CLEAR)
        draw, clear = request is not None and pixel is not CLEAR, request is not None and not pixel
        bits = pack(REQUEST, draw=draw and not load, clear=clear, load=load, address=address)
        loaded = pixel if load else (self.bench.random.randrange(512), 0x2A)
        flying = self.in_flight
        drawn = flying[1] if flying and flying[1] else (self.bench.random.randrange(512), 0x155)

        def drive():
            self.dut.enable.value = enable
            self.dut.request.value = bits
            self.dut.new_.value = pack(PIXEL, depth=drawn[0], colour=drawn[1])
            self.dut.loaded.value = pack(PIXEL, depth=loaded[0], colour=loaded[1])

        def observe():
            if flying and flying[0] in self.pixels:
                self.compare(self.pixels[flying[0]])

        await self.bench.step(drive, observe)
        if enable:
            self._finish()
            self.in_flight = None if load else request
            if load:
                self.pixels[address] = pixel

    def compare(self, expected):
        """Look at the pixel as it stood before the last request."""
        old = unpack(PIXEL, int(self.dut.old.value))
        assert old.depth == expected[0]
        assert expected[1] in (None, old.colour)

    def _finish(self):
        if self.in_flight:
            address, pixel = self.in_flight
            if pixel is CLEAR:
                self.pixels[address] = BACKGROUND
            elif pixel[0] < self.pixels[address][0]:
                self.pixels[address] = pixel

    async def read(self, address, expected):
        """Clear a pixel that is not in flight and compare what stood there."""
        await self.cycle((address, CLEAR))
        self.compare(expected)
        await self.cycle()


@cocotb.test()
async def random_requests(dut):
    """Few pixels, then all; few depths, so that ties are common; pauses now and then."""
    for seed, (spread, depths, rate) in enumerate(
        [(2, 512, 1.0), (3, 5, 0.7), (PIXELS, 4, 0.8), (9, 512, 0.3)]
    ):
        operator = Operator(dut, seed)
        rng = random.Random(seed)
        await operator.reset()
        for _ in range(500):
            request, load = None, False
            if rng.random() < 0.9:
                # Spread over the whole memory: neighbours, and places far apart.
                place = rng.randrange(spread) * (PIXELS // spread) % PIXELS
                depth = rng.randrange(depths) * (512 // depths)
                pixel = CLEAR if rng.random() < 0.05 else (depth, rng.randrange(512))
                if operator.in_flight is None or operator.in_flight[0] != place:
                    request = (place, pixel)
                    load = pixel is not CLEAR and rng.random() < 0.2
            await operator.cycle(request, enable=rng.random() < rate, load=load)
        await operator.cycle()
        places = range(0, PIXELS, PIXELS // min(spread, 64))
        for place, expected in [(place, operator.pixels[place]) for place in places]:
            await operator.read(place, expected)


@cocotb.test()
async def nearer_wins_and_equal_stays(dut):
    """Z < stored draws, Z == stored and Z > stored do not; the background's depth never does."""
    operator = Operator(dut, 9)
    await operator.reset()
    for address, pixels, expected in (
        (3, [(100, 1), (100, 2), (101, 3), (511, 4)], (100, 1)),
        (500, [(100, 1), (99, 2), (99, 3), (0, 4), (0, 5)], (0, 4)),
        (511, [(511, 6), (511, 7)], BACKGROUND),
        (0, [(511, 6), (510, 7)], (510, 7)),
    ):
        for pixel in pixels:
            await operator.cycle((address, pixel))
            await operator.cycle()
        await operator.read(address, expected)
        await operator.read(address, BACKGROUND)


@cocotb.test()
async def what_is_loaded_is_there_whatever_was(dut):
    """Behind or before the old pixel, or background; while the pixel before it is written."""
    operator = Operator(dut, 11)
    await operator.reset()
    for pixel in ((100, 1), (200, 2), (50, 3), (511, 4)):
        await operator.cycle((12, (300, 5)))
        await operator.cycle((13, pixel), load=True)
        await operator.cycle((13, (400, 6)))
        await operator.cycle()
        await operator.read(13, pixel if pixel[0] < 400 else (400, 6))
        await operator.read(12, (300, 5))
    await operator.cycle((13, (7, 7)), enable=0, load=True)
    await operator.read(13, BACKGROUND)


@cocotb.test()
async def a_paused_lane_writes_once(dut):
    """A draw that stands still for many cycles comes out as if it had not; no request is taken."""
    operator = Operator(dut, 10)
    await operator.reset()
    await operator.cycle((8, (50, 8)))
    await operator.cycle((7, (40, 7)))
    for _ in range(5):
        await operator.cycle((8, (1, 1)), enable=0)
    await operator.cycle()
    await operator.read(7, (40, 7))
    await operator.read(8, (50, 8))


def is_pixel(port, expected):
    """Whether a pixel stands on a port; a background's colour means nothing."""
    seen = unpack(PIXEL, int(port.value))
    return seen.depth == expected[0] and expected[1] in (None, seen.colour)


class PairOperator:
    """Requests of a lane whose clears are of pairs, and the pixels as they ought to be."""

    def __init__(self, dut, rng):
        self.dut, self.rng = dut, rng
        self.pixels = {}
        self.asked = None  # what was requested last, its address and the pixel that was there
        self.due = None  # the odd pixel of the pair requested before that

    def request(self, kind, address, enable):
        """Set the ports for a cycle, check what they give in it, and let it pass."""
        dut, rng, pixels = self.dut, self.rng, self.pixels
        new, loaded = ((rng.randrange(511), rng.randrange(512)) for _ in range(2))
        if kind == "clear":
            loaded = BACKGROUND[0], loaded[1]
        flags = {name: name == kind for name in ("draw", "clear", "load")}
        asked, due = self.asked, self.due

        def drive():
            dut.enable.value = int(enable)
            dut.request.value = pack(REQUEST, address=address, **flags)
            dut.new_.value = pack(PIXEL, depth=new[0], colour=new[1])
            dut.loaded.value = pack(PIXEL, depth=loaded[0], colour=loaded[1])

        def observe():
            assert not asked or asked[0] == "load" or is_pixel(dut.old, asked[2])
            assert not due or is_pixel(dut.odd, due)

        if enable:
            self.due = None
            if asked and asked[0] == "draw" and new[0] < asked[2][0]:
                pixels[asked[1]] = new
            if asked and asked[0] == "clear":
                self.due, pixels[asked[1] | 1] = pixels[asked[1] | 1], BACKGROUND
            self.asked = (kind, address, pixels.get(address)) if kind else None
            if kind in ("clear", "load"):
                pixels[address] = BACKGROUND if kind == "clear" else loaded
        return drive, observe


@cocotb.test(skip=CONFIG.flush_words == 1)
async def a_pair_is_cleared_through_both_ports(dut):
    """Any requests, with pauses; none of a pair that the one before is still writing."""
    for seed, rate in enumerate((1.0, 0.6, 0.2)):
        rng, bench = random.Random(seed), StreamBench(dut, seed)
        operator = PairOperator(dut, rng)
        dut.enable.value = 1
        dut.request.value = dut.new_.value = dut.loaded.value = 0
        await bench.reset()
        for n in range(PIXELS + 3000):
            enable, kind, address = True, "load", n
            if n >= PIXELS:
                enable = rng.random() < rate
                kind = rng.choice(["draw", "draw", "load", "clear", None])
                address = rng.randrange(4) * (PIXELS // 4) + rng.randrange(4)
            if kind == "clear":
                address &= ~1
            if operator.asked and address | 1 == operator.asked[1] | 1 and n >= PIXELS:
                kind = None
            await bench.step(*operator.request(kind, address, enable))


def test_a_lane_clears_pairs():
    run_preset(PAIRED, Lane, __file__, test="a_pair_is_cleared_through_both_ports")


def test_lane_keeps_the_nearest(block_simulator):
    run_bench(Lane(PAPER), __file__, simulator_name=block_simulator)
