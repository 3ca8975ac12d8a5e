"""The frame writer in cocotb: rasters in, and the memory of cocotbext-axi behind it.

The memory must hold the pixels of the PNG each time a picture waits to be swapped, and nothing else
may have been written. Every cycle is checked against the rules of AXI.
"""

import itertools
import logging
import random
from dataclasses import dataclass, field

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, Timer
from cocotbext.axi import AxiRamWrite, AxiResp, AxiWriteBus

from splatline.contract.raster import Raster
from splatline.contract.raster_beats import to_beats
from splatline.plots.figure import rgb_levels
from splatline.sim.cosim.streams import StreamBench
from tests.support.bench_config import CONFIG
from tests.support.random_frames import random_raster

MEMORY = 1 << 15
BURST = 8
OUTSTANDING = 4
CHANNELS = {
    "aw": ("awaddr", "awlen", "awsize", "awburst"),
    "w": ("wdata", "wstrb", "wlast"),
}
SETTINGS = ("buffer_0", "buffer_1", "stride", "last_column", "last_line", "background")


def pauses(rate, seed):
    """Whether to pause, for each cycle."""
    numbers = random.Random(seed)
    return (numbers.random() < rate for _ in itertools.count())


@dataclass
class Picture:
    """A frame to write, and its settings."""

    raster: Raster
    settings: tuple
    words: np.ndarray = field(init=False)

    def __post_init__(self):
        height, width = self.raster.depth.shape
        self.settings = (*self.settings[:3], width - 1, height - 1, self.settings[3])
        background = self.settings[-1]
        rgb = [(background >> 8 * n & 255) / 255 for n in range(3)]
        levels = rgb_levels(self.raster.to_rgb(rgb))
        self.words = np.concatenate([levels, np.zeros((height, width, 1), np.uint8)], axis=2)

    @property
    def lines(self):
        """Lines with a drawn pixel."""
        return set(np.flatnonzero(self.raster.drawn.any(axis=1)))


def picture(rng, width, height, lines, settings, share=0.4):
    """A picture with so many drawn lines, by chance."""
    raster = random_raster(rng, width, height, share, CONFIG)
    empty = rng.permutation(height)[lines:]
    raster.depth[empty], raster.colour[empty] = CONFIG.background_depth, 0
    return Picture(raster, settings)


class Bench(StreamBench):
    """Drives the writer, swaps its buffers, and compares."""

    def __init__(self, dut, seed, pictures, rates=(1.0, 1.0), *, stall=0.0):
        super().__init__(dut, seed)
        self.pictures, self.rates = pictures, rates
        self.word = len(dut.m_axi__wdata) // 8
        bus = AxiWriteBus.from_prefix(dut, "m_axi_")
        self.ram = AxiRamWrite(bus, dut.clk, dut.rst, size=MEMORY)
        self.ram.log.setLevel(logging.WARNING)
        for n, name in enumerate(("aw", "w", "b")):
            channel = getattr(self.ram, f"{name}_channel")
            channel.log.setLevel(logging.WARNING)
            if stall:
                channel.set_pause_generator(pauses(stall, f"{seed}/{n}"))
        self.ports = {
            name: [getattr(dut, f"m_axi__{name}{end}") for end in ("valid", "ready")]
            + [getattr(dut, f"m_axi__{part}") for part in parts]
            for name, parts in CHANNELS.items()
        }
        self.fill = np.random.default_rng(seed).integers(0, 256, MEMORY, np.uint8)
        self.ram.write(0, self.fill.tobytes())
        self.expected = self.fill.copy()
        self.back, self.held, self.whole = 0, {0: None, 1: None}, [False, False]
        self.swaps, self.waits, self.shown = 0, None, False
        self.restart()
        beats = [to_beats(each.raster) for each in pictures]
        self.starts = np.cumsum([0, *map(len, beats)])
        numbers = [sum(int(x) << 64 * n for n, x in enumerate(row)) for b in beats for row in b]
        self.beats = self.source("beats", numbers, rates[0])

    def restart(self):
        """Forget what is on the way."""
        self.waiting, self.open, self.written = dict.fromkeys(CHANNELS), False, []
        self.offered, self.ended, self.silent = 0, 0, 0

    def drive(self):
        """Settings count while a frame's first beat is taken, and mean nothing in other cycles."""
        dut = self.dut
        self.shown = self.waits == 0
        idle = not int(dut.swap_valid.value)  # then it means nothing
        dut.swapped.value = self.shown or (idle and self.random.random() < 0.1)
        if self.shown:
            self.swaps, self.waits, self.back = self.swaps + 1, None, 1 - self.back
        if self.swaps == len(self.pictures):
            return
        values = self.pictures[self.swaps].settings
        if self.beats.sent > self.starts[self.swaps]:
            values = [self.random.getrandbits(9)] * 6
        for name, value in zip(SETTINGS, values, strict=True):
            getattr(dut, name).value = value

    def observe(self):
        """Check the bus, and the memory of a picture that waits."""
        self._check_channels()
        if not int(self.dut.swap_valid.value) or self.shown:
            assert self.waits is None
            return
        assert self.beats.sent == self.starts[self.swaps + 1], "a beat of the next frame was taken"
        assert int(self.dut.swap_index.value) == self.back
        if self.waits is None:
            self.compare()
            self.waits = self.random.randrange(1, 12)
        self.waits -= 1

    def _check_channels(self):
        for name, (valid, ready, *parts) in self.ports.items():
            payload = [int(p.value) for p in parts] if int(valid.value) else None
            assert self.waiting[name] in (None, payload), f"{name} changed before it was taken"
            taken = payload is not None and bool(int(ready.value))
            self.waiting[name] = None if taken else payload
            if name == "aw" and taken:
                self._note_burst(*payload)
            if name == "w":
                assert payload is not None or not self.open, "a burst waits for its data"
                self.open = self.open or payload is not None
                if taken and payload[-1]:
                    self.open, self.ended = False, self.ended + 1
        # An address is offered when its data are there: these follow within two cycles.
        self.silent = self.silent + 1 if self.offered > self.ended and not self.open else 0
        assert self.silent <= 2, "an address waits for its data"

    def _note_burst(self, address, length, size, kind):
        self.offered += 1
        assert (size, kind) == ((self.word - 1).bit_length(), 1)
        assert length < BURST
        assert address // 4096 == (address + (length + 1) * self.word - 1) // 4096
        self.written.append((address, length + 1))

    def compare(self):
        """The memory holds the picture; the lines written are those that had to be."""
        each = self.pictures[self.swaps]
        *buffers, stride, last_column, last_line, _ = each.settings
        width, height = last_column + 1, last_line + 1
        base = buffers[self.back]
        for line in range(height):
            at = base + stride * line
            self.expected[at : at + 4 * width] = each.words[line].reshape(-1)
        memory = np.frombuffer(self.ram.read(0, MEMORY), np.uint8)
        assert np.array_equal(memory, self.expected), np.flatnonzero(memory != self.expected)[:8]
        if self.swaps and self.pictures[self.swaps - 1].settings != each.settings:
            self.held = {0: None, 1: None}
        before, drawn = self.held[self.back], each.lines & set(range(height))
        lines = set(range(height)) if before is None else before | drawn
        words = {-(-4 * width // self.word)}
        found = {}
        for address, beats in self.written:
            line = (address - base) // stride
            found[line] = found.get(line, 0) + beats
        assert set(found) == lines, (sorted(found), sorted(lines))
        assert set(found.values()) <= words, "a word was written twice, or not"
        self.held[self.back] = drawn
        self.written = []

    async def play(self):
        """Write all pictures."""
        self.dut.swapped.value = 0
        await self.reset()
        await self.finish()

    async def finish(self):
        """Go on until the last picture is swapped."""
        done = lambda: self.swaps == len(self.pictures)  # noqa: E731
        await self.run(done, most_cycles=6000, drive=self.drive, observe=self.observe)


def layout(dut, width, height, *, pad=1, shift=0, background=0x1F1A17):
    """Buffers behind each other, at no multiple of a burst, and lines with a gap."""
    word = len(dut.m_axi__wdata) // 8
    stride = -(-4 * width // word) * word + pad * word
    return 4096 - 3 * word + shift * word, 16384 - 5 * word, stride, background


@cocotb.test()
async def frames_by_turns(dut):
    """Other lines are drawn each time: what was drawn before and is not now is cleared."""
    rng = np.random.default_rng(1)
    settings = layout(dut, 37, 11)
    counts = (6, 0, 11, 3, 0, 0, 0, 4)
    pictures = [picture(rng, 37, 11, count, settings) for count in counts]
    bench = Bench(dut, 1, pictures, stall=0.3)
    await bench.play()
    assert int(dut.error.value) == 0


@cocotb.test()
async def other_settings(dut):
    """Every line is written after each change, in both buffers."""
    rng = np.random.default_rng(2)
    tall, wide = layout(dut, 21, 14), layout(dut, 45, 6)
    kinds = [
        *((21, 14, tall), (21, 14, tall), (21, 14, tall)),
        *((20, 13, tall), (20, 14, tall), (20, 14, tall), (20, 14, tall)),
        *((45, 6, wide), (45, 6, (*wide[:3], 0xFF8001)), (45, 6, (*wide[:3], 0xFF8001))),
        *((1, 1, wide), (1, 1, wide), (1, 1, layout(dut, 1, 1, shift=2))),
    ]
    pictures = [picture(rng, w, h, int(rng.integers(h + 1)), kind, 0.3) for w, h, kind in kinds]
    await Bench(dut, 2, pictures, rates=(0.4, 1.0), stall=0.1).play()


@cocotb.test()
async def low_bits_of_addresses(dut):
    """Those of a buffer and of the stride that lie within a bus word are ignored."""
    rng = np.random.default_rng(9)
    settings = layout(dut, 21, 5)
    pictures = [picture(rng, 21, 5, lines, settings) for lines in (3, 5, 2, 0)]
    bench = Bench(dut, 9, pictures, stall=0.1)
    aligned = pictures[0].settings
    offered = (aligned[0] + 1, aligned[1] + bench.word - 1, aligned[2] + 2, *aligned[3:])
    compare = bench.compare

    def use(values):
        for each in pictures:
            each.settings = values

    def at_whole_words():
        use(aligned)
        compare()
        use(offered)

    use(offered)
    bench.compare = at_whole_words
    await bench.play()


@cocotb.test()
async def lines_of_many_bursts(dut):
    """A line across 4 KB; memory at its full rate, and beats that come seldom."""
    rng = np.random.default_rng(3)
    settings = layout(dut, 150, 3, pad=0)
    pictures = [picture(rng, 150, 3, lines, settings, 0.3) for lines in (2, 1, 0)]
    await Bench(dut, 3, pictures, rates=(0.15, 1.0)).play()


@cocotb.test()
async def responses_that_are_errors(dut):
    """They are kept, nothing waits for ever, and the buffer is written anew."""
    rng = np.random.default_rng(4)
    settings = layout(dut, 17, 8)
    pictures = [picture(rng, 17, 8, 2, settings) for _ in range(7)]
    bench = Bench(dut, 4, pictures, stall=0.2)
    send, wrong = bench.ram.b_channel.send, {2: AxiResp.SLVERR, 3: AxiResp.DECERR}
    compare = bench.compare
    seen = []

    async def answer(response):
        kind = wrong.get(bench.swaps)
        if kind is not None and len(seen) <= bench.swaps:
            response.bresp = kind
            seen.extend([bench.swaps] * (bench.swaps + 1 - len(seen)))
        await send(response)

    def after():
        compare()
        assert int(dut.error.value) == (bench.swaps >= 2)
        if bench.swaps in wrong:
            bench.held[bench.back] = None

    bench.ram.b_channel.send, bench.compare = answer, after
    await bench.play()


@cocotb.test()
async def resets_in_mid_frame(dut):
    """After a reset every line is written, from buffer 0 on."""
    rng = np.random.default_rng(5)
    settings = layout(dut, 23, 7)
    pictures = [picture(rng, 23, 7, 3, settings) for _ in range(3)]
    bench = Bench(dut, 5, pictures, stall=0.3)
    dut.swapped.value = 0
    for cycles in (9, 60, 130, 400):
        await bench.reset()
        bench.restart()
        bench.back, bench.held, bench.swaps, bench.waits = 0, {0: None, 1: None}, 0, None
        bench.beats.sent, bench.beats.offering = 0, False
        bench.expected = np.frombuffer(bench.ram.read(0, MEMORY), np.uint8).copy()
        for _ in range(cycles):
            if bench.swaps < len(pictures):
                await bench.step(bench.drive, bench.observe)
    await FallingEdge(dut.clk)
    await bench.reset()
    bench.restart()
    bench.back, bench.held, bench.swaps, bench.waits = 0, {0: None, 1: None}, 0, None
    bench.beats.sent, bench.beats.offering = 0, False
    bench.expected = np.frombuffer(bench.ram.read(0, MEMORY), np.uint8).copy()
    await bench.finish()


@cocotb.test()
async def beats_below_the_image(dut):
    """An engine sends none. They are dropped, and the frame ends."""
    rng = np.random.default_rng(6)
    settings = layout(dut, 12, 4)
    pictures = [picture(rng, 12, 7, 7, settings) for _ in range(2)]
    for each in pictures:
        each.settings = (*each.settings[:4], 3, each.settings[5])
    await Bench(dut, 6, pictures).play()


@cocotb.test()
async def cycles_of_an_image_of_one_pixel(dut):
    """The latencies that the docstrings say."""
    settings = layout(dut, 1, 1)
    bench = Bench(dut, 7, [picture(np.random.default_rng(7), 1, 1, 1, settings, 1.0)])
    seen = {}
    events = {
        "beat": (dut.beats__valid, dut.beats__ready),
        "address": (dut.m_axi__awvalid,),
        "data": (dut.m_axi__wvalid,),
        "response": (dut.m_axi__bvalid,),
        "whole": (dut.swap_valid,),
    }
    observe = bench.observe

    def note():
        for name, signals in events.items():
            if all(int(signal.value) for signal in signals):
                seen.setdefault(name, bench.cycles)
        observe()

    bench.observe = note
    await bench.play()
    assert seen["address"] - seen["beat"] == 5 + 1
    assert seen["data"] - seen["beat"] == 5 + 2
    assert seen["whole"] - seen["response"] == 2


@cocotb.test()
async def nothing_passes_within_a_cycle(dut):
    """No output depends on an input in the same cycle."""
    rng = np.random.default_rng(8)
    settings = layout(dut, 30, 5)
    pictures = [picture(rng, 30, 5, 3, settings) for _ in range(2)]
    bench = Bench(dut, 8, pictures, stall=0.2)
    outputs = [
        *(port for valid, _, *parts in bench.ports.values() for port in (valid, *parts)),
        *(dut.beats__ready, dut.m_axi__bready, dut.swap_valid, dut.swap_index, dut.frame_done),
    ]
    inputs = [
        *(dut.beats__valid, dut.swapped, dut.m_axi__awready, dut.m_axi__wready),
        *(dut.m_axi__bvalid, dut.last_column, dut.last_line, dut.background),
    ]
    dut.swapped.value = 0
    await bench.reset()
    for _ in range(150):
        await bench.step(bench.drive, bench.observe)  # to the middle of a cycle
        before = [str(port.value) for port in outputs]
        values = [port.value for port in inputs]
        for port, value in zip(inputs, values, strict=True):
            port.value = ~int(value) & (1 << len(port)) - 1 if value.is_resolvable else 0
        await Timer(1, "ns")
        assert [str(port.value) for port in outputs] == before
        for port, value in zip(inputs, values, strict=True):
            port.value = value
        await Timer(1, "ns")
