"""The frame buffer top in cocotb: code words in, and what golden draws in memory."""

import dataclasses
import logging

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge
from cocotbext.axi import (
    AxiLiteBus,
    AxiLiteMaster,
    AxiRamWrite,
    AxiStreamBus,
    AxiStreamFrame,
    AxiStreamSource,
    AxiWriteBus,
)

from splatline.contract.register_map import register_map
from splatline.host.device.driver import Engine
from splatline.plots.figure import rgb_levels
from splatline.sim import golden
from tests.rtl.framebuffer.writer_bench import MEMORY, pauses
from tests.support import bus_words
from tests.support.bench_config import CONFIG

WIDTH, HEIGHT = 37, 21
BACKGROUND = 0x1F1A17
STRIDE = 256
BUFFERS = 0x800, 0x4400
PATIENCE = 6000


class Registers:
    """A device that keeps what the driver writes, for the bus."""

    def __init__(self):
        self.written = []
        self.values = {
            register.offset: sum(f.reset << f.place.lsb for f in register.fields)
            for register in register_map(CONFIG).registers
        }

    def read32(self, offset):
        return self.values[offset]

    def write32(self, offset, value):
        self.written.append((offset, value))

    def write_words(self, offset, words):
        self.written += zip(range(offset, offset + 4 * len(words), 4), words.tolist(), strict=True)


class Bench:
    """An engine with its bus models, and the memory as it must be."""

    def __init__(self, dut, seed=1, stall=0.2):
        self.dut = dut
        common = (dut.aclk, dut.aresetn, False)
        dut.aresetn.value = 0
        dut.swapped.value = 0
        dut.background.value, dut.stride.value = BACKGROUND, STRIDE
        dut.buffer_0.value, dut.buffer_1.value = BUFFERS
        self.master = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axi_ctrl"), *common)
        self.words = AxiStreamSource(AxiStreamBus.from_prefix(dut, "s_axis_codewords"), *common)
        self.initial = AxiStreamSource(AxiStreamBus.from_prefix(dut, "s_axis_initial"), *common)
        self.ram = AxiRamWrite(AxiWriteBus.from_prefix(dut, "m_axi"), *common, size=MEMORY)
        for part in (self.ram, self.words, self.master.write_if, self.master.read_if):
            part.log.setLevel(logging.WARNING)
        for n, name in enumerate(("aw", "w", "b")):
            channel = getattr(self.ram, f"{name}_channel")
            channel.set_pause_generator(pauses(stall, f"{seed}/{n}"))
        fill = np.random.default_rng(seed).integers(0, 256, MEMORY, np.uint8)
        self.ram.write(0, fill.tobytes())
        self.expected = fill
        self.back = 0
        self.device = Registers()
        self.engine = Engine(self.device)
        Clock(dut.aclk, 10, unit="ns").start()

    async def reset(self):
        self.dut.aresetn.value = 0
        await ClockCycles(self.dut.aclk, 3)
        self.dut.aresetn.value = 1
        self.back = 0
        self.engine = Engine(self.device)

    async def write(self, used=()):
        """Write what the driver has written; of materials, those that are used."""
        window = self.engine.registers.materials
        sent, self.device.written = self.device.written, []
        for offset, value in sent:
            entry = (offset - window.offset) // window.stride
            if offset < window.offset or entry in used:
                done = await self.master.write(offset, value.to_bytes(4, "little"))
                assert int(done.resp) == 0

    async def tables(self, frame):
        """Write a frame's tables and size."""
        self.engine.write_tables(frame.tables, frame.width, frame.height)
        material = CONFIG.material
        words = frame.codewords >> np.uint64(material.lsb) & np.uint64(material.mask)
        await self.write(set(words.tolist()))

    def send(self, codewords):
        self.words.send_nowait(AxiStreamFrame(np.ascontiguousarray(codewords).tobytes()))

    async def read(self, name):
        done = await self.master.read(self.engine.registers[name].offset, 4)
        return int.from_bytes(done.data, "little")

    async def ready(self):
        """Wait until a picture is whole."""
        for _ in range(PATIENCE):
            await FallingEdge(self.dut.aclk)
            if int(self.dut.swap_valid.value):
                assert int(self.dut.swap_index.value) == self.back
                return
        raise AssertionError("no picture")

    async def swap(self):
        self.dut.swapped.value = 1
        await FallingEdge(self.dut.aclk)
        self.dut.swapped.value = 0
        self.back ^= 1

    def place(self, line):
        return BUFFERS[self.back] + STRIDE * line

    def compare(self, picture):
        """All of the memory: the picture over the background, and nothing else."""
        height, width = picture.depth.shape
        rgb = rgb_levels(picture.to_rgb([(BACKGROUND >> 8 * n & 255) / 255 for n in range(3)]))
        for line in range(height):
            at = self.place(line)
            self.expected[at : at + 4 * width].reshape(-1, 4)[:, :3] = rgb[line]
            self.expected[at : at + 4 * width].reshape(-1, 4)[:, 3] = 0
        memory = np.frombuffer(self.ram.read(0, MEMORY), np.uint8)
        assert np.array_equal(memory, self.expected), np.flatnonzero(memory != self.expected)[:8]


def frames(count, elements=30):
    """Frames with the same tables, the second of them empty."""
    first, *others = (
        bus_words.clean(CONFIG, seed, elements, WIDTH, HEIGHT) for seed in range(count)
    )
    others = [dataclasses.replace(each, tables=first.tables) for each in others]
    others[0] = dataclasses.replace(others[0], codewords=first.codewords[-1:])
    return [first, *others]


@cocotb.test()
async def frames_behind_each_other(dut):
    """Golden's pictures by turns; the interrupt says that one is whole; then another size."""
    bench = Bench(dut)
    await bench.reset()
    drawn = frames(4)
    every = dataclasses.replace(
        drawn[0], codewords=np.concatenate([each.codewords for each in drawn])
    )
    bench.engine.set("IRQ_ENABLE", FRAME_DONE=1)
    await bench.tables(every)
    for each in drawn:
        bench.send(each.codewords)
    for number, each in enumerate(drawn, 1):
        assert int(dut.irq.value) == 0
        await bench.ready()
        bench.compare(golden.render(each))
        assert await bench.read("FRAMES") == number
        assert int(dut.irq.value) == 1
        bench.engine.set("IRQ_STATUS", FRAME_DONE=1)
        await bench.write()
        await ClockCycles(dut.aclk, 2 + 40 * number)
        await FallingEdge(dut.aclk)
        if number == len(drawn):  # while the last one waits, as the engine itself is idle
            other = bus_words.clean(CONFIG, 9, 40, 22, 30)
            await bench.tables(other)
            bench.send(other.codewords)
            await ClockCycles(dut.aclk, 20)
            await FallingEdge(dut.aclk)
        await bench.swap()
    await bench.ready()
    bench.compare(golden.render(other))
    assert await bench.read("ERROR") == 0
    assert int(dut.writer_error.value) == 0


@cocotb.test()
async def an_aborted_frame(dut):
    """It is whole, with background where no beat came, and the next one is right."""
    bench = Bench(dut, 2)
    await bench.reset()
    frame = bus_words.clean(CONFIG, 20, 45, WIDTH, HEIGHT)
    await bench.tables(frame)
    bench.send(frame.codewords)
    await bench.ready()
    bench.compare(golden.render(frame))
    await bench.swap()
    before = bench.expected.copy()
    bench.words.send_nowait(AxiStreamFrame(frame.codewords[:-8].tobytes()))
    bench.words.pause = False
    for _ in range(600):
        await FallingEdge(dut.aclk)
        memory = np.frombuffer(bench.ram.read(0, MEMORY), np.uint8)
        if not np.array_equal(memory, before):  # its first lines have left
            break
    bench.engine.set("CONTROL", ABORT=1)
    await bench.write()
    await bench.ready()
    whole = golden.render(frame)
    memory = np.frombuffer(bench.ram.read(0, MEMORY), np.uint8)
    drawn = [
        memory[bench.place(line) :][: 4 * WIDTH].reshape(-1, 4)[:, :3]
        @ (1, 256, 65536) != BACKGROUND
        for line in range(HEIGHT)
    ]  # fmt: skip
    part = np.array(drawn) & whole.drawn
    assert not (np.array(drawn) & ~whole.drawn).any()
    assert part.any()
    assert (part != whole.drawn).any()  # lines behind the abort are background
    whole.depth[~part], whole.colour[~part] = CONFIG.background_depth, 0
    bench.compare(whole)
    await bench.swap()
    bench.send(frame.codewords)
    await bench.ready()
    bench.compare(golden.render(frame))


@cocotb.test()
async def a_reset_in_mid_frame(dut):
    """The memory is drawn anew from buffer 0 on."""
    bench = Bench(dut, 3, stall=0.4)
    await bench.reset()
    frame = bus_words.clean(CONFIG, 30, 40, WIDTH, HEIGHT)
    await bench.tables(frame)
    bench.send(frame.codewords)
    await ClockCycles(dut.aclk, 900)
    await bench.reset()
    await bench.tables(frame)
    bench.expected = np.frombuffer(bench.ram.read(0, MEMORY), np.uint8).copy()
    bench.send(frame.codewords)
    await bench.ready()
    bench.compare(golden.render(frame))
