"""The way out of rows of lanes: every beat that shows something, once, whatever the sink does."""

import random

import cocotb

from splatline.contract.config import BLOCK
from splatline.contract.presets import SWIFT
from splatline.rtl.blocks.lane_row import HALVES, BeatWordsLayout
from splatline.rtl.blocks.readout import DEPTH, BlockReadout
from splatline.rtl.layouts import PlaceLayout, RasterLayout
from splatline.sim.cosim.blocks import pack, unpack
from splatline.sim.cosim.streams import StreamBench
from tests.support.bench_config import CONFIG, run_bench

PLACE, BEAT, RASTER = PlaceLayout(CONFIG), BeatWordsLayout(CONFIG), RasterLayout(CONFIG)
ANYWHERE, BEAT_BITS = (1 << PLACE.size) - 1, BEAT.size
COLUMNS, PIXELS = CONFIG.pixels_per_word, CONFIG.raster_pixels
BEATS = CONFIG.max_width // PIXELS
"""Beats of a line."""
BACKGROUND = (CONFIG.background_depth, 0)
BLANK = [BACKGROUND] * PIXELS
STAGES, LATENCY = 3, 6
"""Cycles from a request to the row's output, and to the port."""
MOST = range(DEPTH // 2, DEPTH // 2 + LATENCY + 1)
"""Beats that are asked for while none leaves."""


def pack_words(pixels):
    """Bits of a row's output."""
    parts = {half: pixels[COLUMNS * n : COLUMNS * (n + 1)] for n, half in enumerate(HALVES)}
    words = {
        half: {
            kind: [pixel[part] for pixel in word] for part, kind in enumerate(("depth", "colour"))
        }
        for half, word in parts.items()
    }
    return pack(BEAT, **words)


def random_beat(rng, share):
    """Pixels of a beat, of which a share are not background."""
    return [
        (rng.randrange(BACKGROUND[0]), rng.randrange(1 << CONFIG.colour_bits))
        if rng.random() < share
        else BACKGROUND
        for _ in range(PIXELS)
    ]


PACKED_BLANK = pack_words(BLANK)


class Rows:
    """Rows of lanes that give beats up, from left to right; ``expected`` must come out."""

    def __init__(self, dut, seed, rate=1.0):
        self.dut, self.bench = dut, StreamBench(dut, seed)
        self.sink = self.bench.sink("raster", rate)
        self.coming = [None] * STAGES  # rows that give a beat up, and it, by the cycle
        self.asked = 0
        self.expected = []
        self.finished = False  # in this cycle
        self.shown = ()  # what the rows give: nothing that they can give yet

    async def reset(self):
        self.dut.flush.value = self.dut.end_.value = 0
        await self.bench.reset()

    async def cycle(self, pixels=None, end=0):
        """One cycle; return whether a beat was asked for: if there is one, and room."""
        dut = self.dut
        asks = pixels is not None and bool(int(dut.room.value))
        line, word = divmod(self.asked, BEATS)
        given, self.coming = self.coming[0], [*self.coming[1:], None]
        if asks:
            self.coming[-1] = line % BLOCK, pixels
            self.asked += 1
            if pixels != BLANK:
                self.expected.append((line, word, pixels))

        def drive():
            dut.flush.value, dut.end_.value = asks, end
            dut.place.value = pack(PLACE, word=2 * word, line=line) if asks else ANYWHERE
            if given != self.shown:  # packing takes longer than the simulation
                outputs = [PACKED_BLANK] * BLOCK
                if given is not None:
                    outputs[given[0]] = pack_words(given[1])
                dut.rows.value = sum(bits << BEAT_BITS * row for row, bits in enumerate(outputs))
                self.shown = given

        def observe():
            self.finished = bool(int(dut.finished.value))
            assert end or not self.finished

        await self.bench.step(drive, observe)
        return asks

    async def ask(self, beats):
        for pixels in beats:
            while not await self.cycle(pixels):
                assert self.bench.cycles < 100_000, "no room for ever"

    async def end(self):
        """Say that the frame is over until it is, let all of it leave, and compare."""
        self.finished = False
        while not self.finished:
            await self.cycle(end=1)
            assert self.bench.cycles < 100_000, "never over"
        for _ in range(DEPTH * 20):
            if self.sink.received and unpack(RASTER, self.sink.received[-1]).end:
                break
            await self.cycle()
        beats = [unpack(RASTER, bits) for bits in self.sink.received]
        assert [beat.end for beat in beats] == [0] * len(self.expected) + [1]
        found = [
            (beat.line, beat.word, [*zip(beat.pixels.depth, beat.pixels.colour, strict=True)])
            for beat in beats[:-1]
        ]
        assert found == self.expected
        self.sink.received.clear()
        self.expected.clear()


@cocotb.test()
async def every_beat_comes_out(dut):
    """Sinks of any pace, many beats of background; many frames."""
    for seed, (rate, share) in enumerate(
        [(1.0, 1.0), (0.3, 0.5), (0.7, 0.05), (0.05, 0.3), (0.5, 0.02)]
    ):
        rng, rows = random.Random(seed), Rows(dut, seed, rate)
        await rows.reset()
        for count in (300, 1, 0, 0, 40):
            rows.asked = 0
            for _ in range(count):
                await rows.ask([random_beat(rng, share)])
                for _ in range(rng.choice([0, 0, 0, 1, 4])):
                    await rows.cycle()
            await rows.end()


@cocotb.test()
async def a_beat_a_cycle(dut):
    """Without stalls, from six cycles after the first on."""
    rng, rows = random.Random(1), Rows(dut, 1)
    await rows.reset()
    for cycle in range(400):
        assert await rows.cycle(random_beat(rng, 1.0))
        assert len(rows.sink.received) == max(0, cycle + 1 - LATENCY)
    await rows.end()


@cocotb.test()
async def background_leaves_untaken(dut):
    """A sink may wait for what shows something before it is ready for anything."""
    rng, rows = random.Random(4), Rows(dut, 4, rate=0.0)
    await rows.reset()
    await rows.ask([BLANK] * 20)
    await rows.ask([random_beat(rng, 1.0)])
    for _ in range(2 * 20 + LATENCY):
        await rows.cycle()
    assert int(dut.raster__valid.value)
    rows.sink.rate = 1.0
    await rows.end()


@cocotb.test()
async def the_queue_takes_what_there_is_room_for(dut):
    """Half of it, however long nothing leaves, and those on their way; no end beat then."""
    rng, rows = random.Random(2), Rows(dut, 2, rate=0.0)
    await rows.reset()
    for _ in range(DEPTH):
        await rows.cycle(random_beat(rng, 1.0))
    assert rows.asked in MOST
    for _ in range(30):
        await rows.cycle(end=1)
    assert not rows.finished and not rows.sink.received
    rows.sink.rate = 0.5
    await rows.end()


@cocotb.test()
async def end_beats_need_room_too(dut):
    """Of frames in which nothing is drawn, as many as there is room for."""
    rows = Rows(dut, 3, rate=0.0)
    await rows.reset()
    ended = 0
    for _ in range(2 * DEPTH):
        await rows.cycle(end=1)
        ended += rows.finished
    assert ended in MOST
    rows.sink.rate = 1.0
    for _ in range(2 * DEPTH):
        await rows.cycle()
    assert [unpack(RASTER, bits).end for bits in rows.sink.received] == [1] * ended


def test_readout_gives_every_beat():
    run_bench(SWIFT, BlockReadout, __file__, simulator_name="verilator")
