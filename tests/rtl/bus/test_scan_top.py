"""The scan chain reaches every port of the AXI top, and takes five pins."""

from amaranth.hdl import Module
from amaranth.lib.wiring import In
from amaranth.sim import Simulator

from splatline.contract.presets import PAPER
from splatline.rtl.bus.axi_top import AxiTop
from splatline.rtl.bus.scan_top import ScanTop
from splatline.rtl.engine import Engine


class Idle(Engine):
    """An engine that takes nothing."""

    def elaborate(self, platform):
        return Module()


async def tick(ctx, top):
    for level in (1, 0):
        ctx.set(top.clk, level)
        await ctx.delay(1e-9)


def test_every_port_is_in_the_chain_and_in_its_order():
    top = ScanTop(AxiTop(PAPER, Idle(PAPER)))
    ports = {name: member.flow for name, member in top.top.signature.members.items()}
    assert ports.pop("aclk") is ports.pop("aresetn") is In
    widths = {name: len(getattr(top.top, name)) for name in ports}
    outputs = [name for name in ports if ports[name] is not In]
    expected = {name: n % 2 for n, name in enumerate(ports) if ports[name] is In}
    seen = {}

    async def shift(ctx):
        ctx.set(top.rst, 1)
        for name in reversed(expected):
            for _ in range(widths[name]):
                ctx.set(top.scan_in, expected[name])
                await tick(ctx, top)
        seen.update({name: ctx.get(getattr(top.top, name)) for name in expected})
        ctx.set(top.capture, 1)
        await tick(ctx, top)
        ctx.set(top.capture, 0)
        await tick(ctx, top)
        held = sum(ctx.get(getattr(top.top, name)) << place for name, place in places.items())
        for place in range(sum(widths[name] for name in outputs)):
            assert ctx.get(top.scan_out) == held >> place & 1, place
            await tick(ctx, top)

    places, place = {}, 0
    for name in outputs:
        places[name] = place
        place += widths[name]
    simulator = Simulator(top)
    simulator.add_testbench(shift)
    simulator.run()
    for name, bit in expected.items():
        assert seen[name] == bit * (2 ** widths[name] - 1), name
