"""The register file: causes of errors, cycle by cycle."""

import pytest
from amaranth.sim import Simulator

from splatline.contract.presets import PAPER
from splatline.contract.register_map import register_map
from splatline.rtl.bus.axi_registers import RegisterFile

REGISTERS = {register.name: register.offset for register in register_map(PAPER).registers}


async def write(ctx, bus, offset, value):
    """Write a register; its answer is taken."""
    ctx.set(bus.awaddr, offset)
    ctx.set(bus.wdata, value)
    ctx.set(bus.wstrb, 0xF)
    channels = [(bus.awvalid, bus.awready), (bus.wvalid, bus.wready)]
    for valid, _ in channels:
        ctx.set(valid, 1)
    while channels:
        left = [channel for channel in channels if not ctx.get(channel[1])]
        await ctx.tick()
        for valid, _ in channels:
            ctx.set(valid, any(valid is other for other, _ in left))
        channels = left
    while not ctx.get(bus.bvalid):
        await ctx.tick()
    await ctx.tick()


@pytest.mark.parametrize("again", [False, True])
def test_a_cause_in_the_cycle_of_its_clearing_leaves_the_bit_set(again):
    file = RegisterFile(register_map(PAPER))
    cause, bit = file.events.error_line_past, file.values.error_line_past

    async def bench(ctx):
        ctx.set(file.bus.bready, 1)
        for _ in range(2):  # twice is as once
            ctx.set(cause, 1)
            await ctx.tick()
            ctx.set(cause, 0)
            await ctx.tick()
            assert ctx.get(bit) == 1
        ctx.set(cause, again)
        await write(ctx, file.bus, REGISTERS["ERROR"], 0xFFFF_FFFF)
        ctx.set(cause, 0)
        await ctx.tick()
        assert ctx.get(bit) == again
        await write(ctx, file.bus, REGISTERS["ERROR"], 0xFFFF_FFFF)
        assert ctx.get(bit) == 0

    simulator = Simulator(file)
    simulator.add_clock(1e-8)
    simulator.add_testbench(bench)
    simulator.run()
