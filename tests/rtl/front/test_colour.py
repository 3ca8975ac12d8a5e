"""Colour evaluation, against the paper's equation 2 in integers."""

import random
from itertools import pairwise

import cocotb
import pytest
from amaranth.hdl import Module, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import Out, connect, flipped

from splatline.contract.presets import PAPER, SWIFT
from splatline.rtl.front.colour import ColourUnit
from splatline.rtl.layouts import ElementLayout, GeometryLayout
from splatline.sim.cosim import blocks
from splatline.sim.cosim.blocks import pack, unpack
from splatline.sim.cosim.streams import StreamBench
from tests.support.bench_config import CONFIG, OTHERS, run_bench


class Coloured(data.StructLayout):
    """An element with its colour."""

    def __init__(self, config):
        super().__init__({"geometry": GeometryLayout(config), "colour": config.colour_bits})


class Painter(wiring.Component):
    """A colour unit and what is behind it: the colour meets its element.

    Two stages, or four for a colour that takes as many: in the first, as in the tiler or the
    decoder, an element with ``mode`` set stays until it has gone on twice.
    """

    def __init__(self, config):
        self.config = config
        self.unit = ColourUnit(config)
        members = self.unit.signature.members
        super().__init__(
            {
                **{name: members[name] for name in ("i", "ambient", "material")},
                "o": Out(stream.Signature(Coloured(config))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.unit = unit = self.unit
        connect(m, flipped(self.i), unit.i)
        count = 3 if self.config.draws_blocks else 1
        valid, step = Signal(count), Signal()
        held = [Signal.like(unit.o.payload, name=f"held_{n}") for n in range(count)]
        m.d.comb += [
            unit.ambient.eq(self.ambient),
            unit.material.eq(self.material),
            self.o.valid.eq(valid[-1]),
            self.o.payload.geometry.eq(held[-1]),
            self.o.payload.colour.eq(unit.shade),
        ]
        there, twice = Signal(), Signal()
        at_hand = Signal.like(held[0])
        m.d.comb += [
            step.eq(~valid[-1] | self.o.ready),
            unit.moves.eq(step),
            unit.o.ready.eq(~there | (step & (twice | ~at_hand.mode))),
        ]
        with m.If(unit.o.ready):
            m.d.sync += [there.eq(unit.o.valid), at_hand.eq(unit.o.payload), twice.eq(0)]
        with m.Elif(step):
            m.d.sync += twice.eq(1)
        stages = [(at_hand, there), *zip(held, valid, strict=True)]
        with m.If(step):
            for before, after in pairwise(stages):
                m.d.sync += [now.eq(then) for now, then in zip(after, before, strict=True)]
        return m


ELEMENT, COLOURED = ElementLayout(CONFIG), Coloured(CONFIG)
PASSED = {"x": 300, "z": 77, "top": -3, "end": 1}
MATERIALS = CONFIG.register_base
LARGEST = (1 << CONFIG.coefficient_bits) - 1
BRIGHTEST = (1 << CONFIG.ambient_bits) - 1
INTENSITY = CONFIG.diffuse.mask


def expected_colour(ambient, material, diffuse, specular):
    """Equation 2."""
    bits = CONFIG.channel_bits
    colour = 0
    for c in range(3):
        total = ambient[c] + material[c] * diffuse + material[3 + c] * specular
        colour |= min(total >> CONFIG.colour_shift, (1 << bits) - 1) << bits * c
    return colour


async def write_materials(dut, bench, materials):
    for index, material in enumerate(materials):
        bits = sum(value << CONFIG.coefficient_bits * n for n, value in enumerate(material))
        write = 1 | index << 1 | bits << 1 + CONFIG.material_bits
        await bench.step(lambda write=write: setattr(dut.material, "value", write))
    dut.material.value = 0


async def check(dut, ambient, materials, elements, rates, seed):
    bench = StreamBench(dut, seed)
    dut.material.value = 0
    dut.ambient.value = sum(value << CONFIG.ambient_bits * c for c, value in enumerate(ambient))
    source = bench.source("i", [], rates[0])
    sink = bench.sink("o", rates[1])
    await bench.reset()
    await write_materials(dut, bench, materials)
    modes = [n // 3 % 2 for n in range(len(elements))]
    source.payloads = [
        pack(ELEMENT, material=m, diffuse=d, specular=s, mode=mode, **PASSED)
        for mode, (m, d, s) in zip(modes, elements, strict=True)
    ]
    coming = [
        (mode, element)
        for mode, element in zip(modes, elements, strict=True)
        for _ in range(1 + mode)
    ]
    cycles = await bench.run(lambda: len(sink.received) == len(coming), most_cycles=30_000)
    for (mode, (m, d, s)), bits in zip(coming, sink.received, strict=True):
        beat = unpack(COLOURED, bits)
        expected = expected_colour(ambient, materials[m], d, s)
        assert beat.colour == expected, (ambient, materials[m], d, s)
        assert beat.geometry.mode == mode
    passed = unpack(COLOURED, sink.received[-1]).geometry
    assert {name: getattr(passed, name) for name in PASSED} == PASSED
    return cycles, len(coming)


@cocotb.test()
async def random_materials(dut):
    """Random tables and intensities, at full rate and with stalls."""
    for seed, rates in enumerate([(1.0, 1.0), (0.6, 0.6), (1.0, 0.2)]):
        rng = random.Random(seed)
        ambient = [rng.randrange(BRIGHTEST // 2) for _ in range(3)]
        # Numbers of every length, so that not all colours are the brightest.
        materials = [
            [rng.getrandbits(rng.randrange(CONFIG.coefficient_bits + 1)) for _ in range(6)]
            for _ in range(MATERIALS)
        ]
        elements = [
            (rng.randrange(MATERIALS), rng.randint(0, INTENSITY), rng.randint(0, INTENSITY))
            for _ in range(1500)
        ]
        cycles, moves = await check(dut, ambient, materials, elements, rates, seed)
        if rates == (1.0, 1.0):
            assert cycles <= moves + 5, "one element a cycle"


@cocotb.test()
async def extremes(dut):
    """The largest sum saturates and never wraps; each corner of the ranges is right."""
    materials = [
        [LARGEST] * 6,
        [0] * 6,
        [LARGEST, 0, 1, 0, LARGEST, 1],
        [1 << n for n in range(6)],
    ]
    ends = (0, 1, INTENSITY - 1, INTENSITY)
    corners = [(m, d, s) for m in range(4) for d in ends for s in ends]
    unit = 1 << CONFIG.colour_shift
    for number, level in enumerate((0, 1, unit // 2, unit - 1, unit, BRIGHTEST // 2, BRIGHTEST)):
        ambient = [level, BRIGHTEST - level, level]
        await check(dut, ambient, materials, corners, (1.0, 1.0), number)


def test_colours_follow_equation_2(block_simulator):
    blocks.run_bench(Painter(PAPER), __file__, simulator_name=block_simulator)


@pytest.mark.parametrize("config", OTHERS, ids=lambda config: config.name)
def test_the_corners_of_every_preset(config):
    run_bench(config, Painter, __file__, test="extremes")


def test_a_table_that_is_written_and_read_through_both_ports():
    config = next(c for c in OTHERS if 6 * c.coefficient_bits > 36)
    run_bench(config, Painter, __file__, test="random_materials")


def test_a_table_that_is_read_in_every_cycle():
    """While the elements stall, a register holds what was read."""
    run_bench(SWIFT, Painter, __file__, test="random_materials")
