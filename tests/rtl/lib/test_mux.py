"""Wide gates on a carry chain, for every value of up to nine bits."""

import pytest
from amaranth.hdl import Module, Signal
from amaranth.sim import Simulator

from splatline.rtl.lib.mux import all_of, any_of


@pytest.mark.parametrize("width", range(1, 10))
def test_all_and_any_of_bits(width):
    m = Module()
    bits, every, some = Signal(width), Signal(), Signal()
    m.d.comb += [every.eq(all_of(bits)), some.eq(any_of(bits))]

    async def check(ctx):
        for value in range(1 << width):
            ctx.set(bits, value)
            await ctx.delay(1e-9)
            assert (ctx.get(every), ctx.get(some)) == (value + 1 == 1 << width, value != 0)

    simulator = Simulator(m)
    simulator.add_testbench(check)
    simulator.run()
