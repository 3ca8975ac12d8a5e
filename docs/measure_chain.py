"""Measure the resources of a chain's mergers and fifos, and their clock rate.

Prints LUTs, flip-flops and block RAMs of a merger and of a fifo on the Virtex-II. Prints the clock
rate of a merger with its fifos, routed on the ECP5 of ``splatline pnr``. Takes some minutes.

    .venv/bin/python docs/measure_chain.py
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

from amaranth.hdl import Module
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.flow.area.synth import count_component
from splatline.flow.timing.ecp5 import DEVICES
from splatline.flow.timing.pnr import CONSTRAINTS, OPTIONS, SYNTHESIS, read_report
from splatline.flow.tools import run_nextpnr, run_yosys
from splatline.flow.verilog import convert
from splatline.rtl.bus.narrow_top import BEAT_PIECE, Gatherer, Splitter
from splatline.rtl.chain.chain import QUEUE
from splatline.rtl.chain.merger import Merger
from splatline.rtl.layouts import RasterLayout
from splatline.rtl.lib.fifo import Fifo

SEEDS = (1, 2, 3, 4)


class Link(wiring.Component):
    """A merger with the fifos before it; its streams come in pieces, as on the narrow top."""

    def __init__(self, config: EngineConfig):
        self.config = config
        piece = stream.Signature(BEAT_PIECE)
        super().__init__({"before": In(piece), "own": In(piece), "o": Out(piece)})

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        bits = RasterLayout(self.config).size
        m.submodules.merger = merger = Merger(self.config)
        m.submodules.splitter = splitter = Splitter(bits, BEAT_PIECE)

        def link(source, sink):
            m.d.comb += [
                sink.payload.eq(source.payload),
                sink.valid.eq(source.valid),
                source.ready.eq(sink.ready),
            ]

        for name in ("before", "own"):
            gatherer, queue = Gatherer(bits, BEAT_PIECE), Fifo(self.config, QUEUE)
            m.submodules[f"{name}_gatherer"], m.submodules[f"{name}_queue"] = gatherer, queue
            link(getattr(self, name), gatherer.i)
            link(gatherer.o, queue.i)
            link(queue.o, getattr(merger, name))
        link(merger.o, splitter.i)
        link(splitter.o, self.o)
        return m


def route(component: wiring.Component) -> dict[int, float]:
    """Return the routed clock rate in MHz, by seed of the placer."""
    rates = {}
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "top.v").write_text(convert(component, "top"))
        (folder / "top.lpf").write_text(CONSTRAINTS.read_text())
        # ABC9 of this version of Yosys stops without a message for some lengths of the fifos.
        script = f"read_verilog top.v; {SYNTHESIS} -noabc9 -top top -json top.json"
        run_yosys(script, folder)
        for seed in SEEDS:
            files = ["--json", "top.json", "--lpf", "top.lpf", "--report", "report.json"]
            options = [DEVICES[0].option, *OPTIONS, "--seed", str(seed), "--timing-allow-fail"]
            run_nextpnr([*options, *files], folder)
            rates[seed] = read_report(json.loads((folder / "report.json").read_text()))["fmax_mhz"]
    return rates


def main() -> None:
    """Print resources and clock rates."""
    for name, component in (("merger", Merger(PAPER)), ("queue", Fifo(PAPER, QUEUE))):
        counts = count_component(component)
        print(name, ", ".join(f"{kind} {count:,}" for kind, count in counts.items()), flush=True)
    rates = route(Link(PAPER))
    print("routed on the ECP5, MHz by seed:", ", ".join(f"{n}: {r:.1f}" for n, r in rates.items()))


if __name__ == "__main__":
    main()
