# amaranth: UnusedElaboratable=no
"""The frame writer against the pixels of the PNG, by the bench beside it."""

import numpy as np
import pytest
from amaranth.hdl import Cat, Fragment, Module, Signal
from amaranth.sim import Simulator

from splatline.contract.presets import LANES8, PAPER, PLANE, RGB24, SWIFT
from splatline.contract.raster import Raster
from splatline.contract.variants import VARIANTS
from splatline.plots.figure import rgb_levels
from splatline.rtl.framebuffer.colour_bytes import colour_bytes, level_byte
from splatline.rtl.framebuffer.frame_writer import FrameWriter
from tests.rtl.framebuffer import writer_bench
from tests.support.bench_config import run_bench

WORD2 = next(config for config in VARIANTS if config.name == "word2")


@pytest.mark.parametrize(
    ("config", "data_bits"),
    [(PAPER, 64), (RGB24, 32), (PLANE, 128), (SWIFT, 128)],
    ids=lambda value: getattr(value, "name", value),
)
def test_memory_holds_the_pixels_of_the_png(config, data_bits):
    def writer(config):
        return FrameWriter(
            config, data_bits, burst=writer_bench.BURST, outstanding=writer_bench.OUTSTANDING
        )

    run_bench(config, writer, writer_bench.__file__)


@pytest.mark.parametrize("bits", range(1, 9))
def test_a_level_s_byte_is_that_of_the_png(bits):
    config = PAPER.replace(channel_bits=bits)
    levels = np.arange(config.channel_max + 1, dtype=np.uint8)
    raster = Raster(np.zeros((1, len(levels)), np.uint16), np.stack([levels] * 3, 1)[None], config)
    assert rgb_levels(raster.to_rgb())[0, :, 0].tolist() == [
        level_byte(level, bits) for level in range(len(levels))
    ]


@pytest.mark.parametrize("bits", [3, 6])
def test_the_gates_give_the_same_bytes(bits):
    config = PAPER.replace(channel_bits=bits)
    m, colour, rgb = Module(), Signal(config.colour_bits), Signal(24)
    m.d.comb += rgb.eq(Cat(colour_bytes(colour, config)))

    async def bench(context):
        for level in range(1 << bits):
            other = config.channel_max - level
            context.set(colour, level | other << bits | level << 2 * bits)
            expected = [level_byte(each, bits) for each in (level, other, level)]
            assert context.get(rgb).to_bytes(3, "little") == bytes(expected)

    simulator = Simulator(m)
    simulator.add_testbench(bench)
    simulator.run()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"data_bits": 48}, "32, 64 or 128 bits, not 48"),
        ({"config": WORD2, "data_bits": 128}, "4 pixels a word, and a beat of 'word2' has 2"),
        ({"burst": 48}, "2, 4, .. 256 beats, not 48"),
    ],
)
def test_what_cannot_be_built_is_told(options, message):
    with pytest.raises(ValueError, match=message):
        FrameWriter(**options)


def test_a_word_has_at_most_a_beat_s_pixels():
    for config, data_bits in ((LANES8, 128), (WORD2, 64)):
        Fragment.get(FrameWriter(config, data_bits), None)
