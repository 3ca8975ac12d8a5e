"""An engine of Splatline beside other logic: a picture in a ROM is drawn and counted.

Run as ``.venv/bin/python examples/amaranth/still_picture.py``.
"""

import sys

import numpy as np
from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import memory, stream, wiring
from amaranth.lib.wiring import In, Out, connect
from amaranth.sim import Simulator

from splatline.contract.presets import PAPER
from splatline.contract.raster_beats import to_beats
from splatline.rtl.engine import Engine
from splatline.rtl.layouts import CodeWordLayout, RasterLayout, TableWriteLayout
from splatline.sim import golden
from splatline.sim.cosim.player.jobs import table_writes
from splatline.sim.cosim.standalone.frames import bench_frames

MOST_CYCLES = 20_000


class Source(wiring.Component):
    """Words of a ROM on a stream, once, each until it is taken.

    **Latency**: 1 cycle, as the ROM's. **Throughput**: a word in two cycles.

    Members
    -------
    enable : In(1)
        Offer words.
    o : Out(stream of the layout)
        The words.
    done : Out(1)
        All words were taken.
    """

    def __init__(self, layout, words):
        self.words = words
        self.rom = memory.Memory(shape=layout.size, depth=len(words), init=words)
        super().__init__({"enable": In(1), "o": Out(stream.Signature(layout)), "done": Out(1)})

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        m.submodules.rom = self.rom
        port = self.rom.read_port()
        index = Signal(range(len(self.words) + 1))
        here = Signal()  # the ROM's output is the word at ``index``
        taken = self.o.valid & self.o.ready
        m.d.comb += [
            port.addr.eq(index),
            self.done.eq(index == len(self.words)),
            self.o.payload.eq(port.data),
            self.o.valid.eq(here & self.enable),
        ]
        m.d.sync += here.eq(~self.done & ~taken)
        with m.If(taken):
            m.d.sync += index.eq(index + 1)
        return m


class RasterCounter(wiring.Component):
    """Takes a raster and counts what is in it; always ready.

    Members
    -------
    i : In(stream of RasterLayout)
        The raster.
    beats, pixels, frames : Out(32)
        Beats, end beats among them; pixels in front of the background; end beats.
    """

    def __init__(self, config):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(RasterLayout(config))),
                "beats": Out(32),
                "pixels": Out(32),
                "frames": Out(32),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        beat = self.i.payload
        depths = [beat.pixels.depth[n] for n in range(self.config.raster_pixels)]
        drawn = sum(depth != self.config.background_depth for depth in depths)
        m.d.comb += self.i.ready.eq(1)
        with m.If(self.i.valid):
            m.d.sync += [
                self.beats.eq(self.beats + 1),
                self.pixels.eq(self.pixels + Mux(beat.end, 0, drawn)),
                self.frames.eq(self.frames + beat.end),
            ]
        return m


class StillPicture(wiring.Component):
    """A picture in two ROMs, the engine that draws it, and a counter.

    Members
    -------
    beats, pixels, frames : Out(32)
        As of :class:`RasterCounter`.
    """

    beats: Out(32)
    pixels: Out(32)
    frames: Out(32)

    def __init__(self, frame):
        config = frame.config
        self.engine = Engine(config)
        writes = table_writes(frame.tables, frame.width, frame.height, False, config)
        self.tables = Source(TableWriteLayout(config), integers(writes))
        words = frame.codewords.reshape(len(frame.codewords), -1)
        self.codewords = Source(CodeWordLayout(config), integers(words))
        self.counter = RasterCounter(config)
        super().__init__()

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        m.submodules.engine = self.engine
        m.submodules.tables = self.tables
        m.submodules.codewords = self.codewords
        m.submodules.counter = self.counter
        connect(m, self.tables.o, self.engine.tables)
        connect(m, self.codewords.o, self.engine.codewords)
        connect(m, self.engine.raster, self.counter.i)
        m.d.comb += [
            self.tables.enable.eq(1),
            self.codewords.enable.eq(self.tables.done),
            self.engine.initial.valid.eq(0),  # a frame starts from background
        ]
        m.d.comb += [
            getattr(self, name).eq(getattr(self.counter, name))
            for name in ("beats", "pixels", "frames")
        ]
        return m


def integers(limbs):
    """Return numbers of several limbs of 64 bits, of shape (n, limbs), as integers."""
    return [sum(int(limb) << 64 * place for place, limb in enumerate(row)) for row in limbs]


def simulate(design):
    """Run the design until its frame is out; return the raster's beats, and the count of pixels."""
    simulator = Simulator(design)
    simulator.add_clock(10e-9)
    beats, counts = [], []

    async def watch(ctx):
        raster = design.engine.raster
        for _ in range(MOST_CYCLES):
            _, _, taken, beat, end = await ctx.tick().sample(
                raster.valid & raster.ready, raster.payload.as_value(), raster.payload.end
            )
            if taken:
                beats.append(beat)
            if taken and end:
                break
        counts.append(ctx.get(design.pixels))

    simulator.add_testbench(watch)
    simulator.run()
    return beats, counts[0]


def main(frame=None, design=None):
    """Draw the picture, print the counts; return the exit code."""
    frame = frame or bench_frames(PAPER)[0]
    beats, pixels = simulate(design or StillPicture(frame))
    picture = golden.render(frame)
    expected = integers(to_beats(picture))
    # Of an end beat the end bit alone counts.
    unlike = sum(one != other for one, other in zip(beats[:-1], expected[:-1], strict=False))
    unlike += abs(len(beats) - len(expected))
    drawn = int(np.count_nonzero(picture.drawn))
    print(f"{len(beats)} beats, {unlike} unlike golden; {pixels} pixels counted, {drawn} in golden")
    return 1 if unlike or pixels != drawn else 0


if __name__ == "__main__":
    sys.exit(main())
