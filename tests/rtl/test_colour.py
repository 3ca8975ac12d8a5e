"""Colour evaluation, against the paper's equation 2 in integers."""

import random

import cocotb

from splatline.rtl.colour import ColourUnit
from splatline.rtl.format import PAPER
from splatline.rtl.layouts import ColouredLayout, ElementLayout
from splatline.sim.cosim.blocks import pack, run_bench
from splatline.sim.cosim.streams import StreamBench

ELEMENT, COLOURED = ElementLayout(PAPER), ColouredLayout(PAPER)
PASSED = {"mode": 1, "x": 300, "z": 77, "top": -3, "end": 1}


def expected_colour(ambient, material, diffuse, specular):
    kd, ks = material[:3], material[3:]
    levels = [min((ambient[c] + kd[c] * diffuse + ks[c] * specular) >> 10, 7) for c in range(3)]
    return levels[0] | levels[1] << 3 | levels[2] << 6


async def write_materials(dut, bench, materials):
    for index, material in enumerate(materials):
        bits = sum(value << 6 * n for n, value in enumerate(material))
        write = 1 | index << 1 | bits << 8
        await bench.step(lambda write=write: setattr(dut.material, "value", write))
    dut.material.value = 0


async def check(dut, ambient, materials, elements, rates, seed):
    bench = StreamBench(dut, seed)
    dut.material.value = 0
    dut.ambient.value = sum(value << 14 * c for c, value in enumerate(ambient))
    source = bench.source("i", [], rates[0])
    sink = bench.sink("o", rates[1])
    await bench.reset()
    await write_materials(dut, bench, materials)
    source.payloads = [
        pack(ELEMENT, material=m, diffuse=d, specular=s, **PASSED) for m, d, s in elements
    ]
    cycles = await bench.run(lambda: len(sink.received) == len(elements), most_cycles=30_000)
    for (m, d, s), bits in zip(elements, sink.received, strict=True):
        expected = expected_colour(ambient, materials[m], d, s)
        assert COLOURED.from_bits(bits).colour == expected, (ambient, materials[m], d, s)
    passed = COLOURED.from_bits(sink.received[-1])
    assert {name: passed[name] for name in PASSED} == PASSED
    return cycles


@cocotb.test()
async def random_materials(dut):
    """Random tables and intensities, at full rate and with stalls."""
    for seed, rates in enumerate([(1.0, 1.0), (0.6, 0.6), (1.0, 0.2)]):
        rng = random.Random(seed)
        ambient = [rng.randrange(1 << 13) for _ in range(3)]
        materials = [[rng.randrange(64) for _ in range(6)] for _ in range(128)]
        elements = [
            (rng.randrange(128), rng.randrange(128), rng.randrange(128)) for _ in range(1500)
        ]
        cycles = await check(dut, ambient, materials, elements, rates, seed)
        if rates == (1.0, 1.0):
            assert cycles <= len(elements) + 5, "one element a cycle"


@cocotb.test()
async def extremes(dut):
    """The largest sum saturates and never wraps; each corner of the ranges is right."""
    materials = [[63] * 6, [0] * 6, [63, 0, 1, 0, 63, 1], [1, 2, 4, 8, 16, 32]]
    corners = [(m, d, s) for m in range(4) for d in (0, 1, 126, 127) for s in (0, 1, 126, 127)]
    for number, level in enumerate((0, 1, 512, 1023, 1024, 8191, 16383)):
        ambient = [level, 16383 - level, level]
        await check(dut, ambient, materials, corners, (1.0, 1.0), number)


def test_colours_follow_equation_2(simulator_name):
    run_bench(ColourUnit(PAPER), __file__, simulator_name=simulator_name)
