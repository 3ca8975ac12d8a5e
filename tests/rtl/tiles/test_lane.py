"""A lane: depth test and write back, one pixel a cycle, standing still in between."""

import random

import cocotb

from splatline.contract.presets import PAPER
from splatline.rtl.layouts import PixelLayout
from splatline.rtl.tiles.lane import Lane, LaneRequestLayout, lane_address_bits
from splatline.sim.cosim.blocks import pack, run_bench, unpack
from splatline.sim.cosim.streams import StreamBench

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
        self.dut.request.value = self.dut.new.value = self.dut.loaded.value = 0
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
            self.dut.new.value = pack(PIXEL, depth=drawn[0], colour=drawn[1])
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


def test_lane_keeps_the_nearest(block_simulator):
    run_bench(Lane(PAPER), __file__, simulator_name=block_simulator)
