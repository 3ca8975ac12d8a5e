"""Simulates the AXI top: its registers, and its streams.

Each function returns the rows of a frame, as :func:`port_traces.trace` does.
"""

from functools import cache

from port_traces import Constants, Feed, axi_feed, axi_sink, trace
from port_words import CLEARED, CONFIG, LINES, beat_label, elements, initial_beats

from splatline.contract.register_map import register_map
from splatline.rtl.bus.axi_top import AxiTop

__all__ = ["axi_initial_rows", "axi_rows", "packet", "register_feeds"]


def packet(words):
    """Return the words of a packet with TLAST: 1 with the last one."""
    return [(label, word, int(n == len(words) - 1)) for n, (label, word) in enumerate(words)]


def register_feeds(top, values):
    """Return feeds that write registers, by name, one after the other."""
    registers = register_map(CONFIG)
    aw, w = (
        [getattr(top, f"s_axi_ctrl_{name}{wire}") for wire in ("valid", "ready", payload)]
        for name, payload in (("aw", "addr"), ("w", "data"))
    )
    offsets = [registers[name].offset for name in values]
    return [
        Feed("aw", *aw, [(f"{offset:#x}", offset) for offset in offsets],
             when=lambda rows: len(rows) > 2),
        Feed("w", *w, [(str(value), value) for value in values.values()],
             when=lambda rows: len(rows) > 2),
        Constants([
            (top.s_axi_ctrl_wstrb, 15), (top.s_axi_ctrl_bready, 1), (top.s_axi_ctrl_rready, 1),
            (top.s_axis_codewords_tkeep, ~0), (top.s_axis_initial_tkeep, ~0),
        ]),
    ]  # fmt: skip


@cache
def axi_rows():
    """Return a frame on AXI: a register is written and read, a packet goes in, one comes out."""
    top = AxiTop(CONFIG)
    done = register_map(CONFIG)["FRAMES"].offset
    read = [getattr(top, f"s_axi_ctrl_ar{wire}") for wire in ("valid", "ready", "addr")]
    parts = [
        *register_feeds(top, {"IRQ_ENABLE": 1}),
        Feed("ar", *read, [(f"{done:#x}", done)], when=lambda rows: len(rows) > 7),
        axi_feed(top, "s_axis_codewords", packet(elements(0)), when=lambda rows: len(rows) > 10),
        axi_sink(top, "m_axis_raster", beat_label, waits=lambda cycle: cycle % 4 == 1),
    ]
    watch = {name: getattr(top, name) for name in (
        "aresetn", "s_axi_ctrl_awvalid", "s_axi_ctrl_awready", "s_axi_ctrl_wvalid",
        "s_axi_ctrl_wready", "s_axi_ctrl_bvalid", "s_axi_ctrl_bready", "s_axi_ctrl_arvalid",
        "s_axi_ctrl_arready", "s_axi_ctrl_rvalid", "s_axi_ctrl_rready",
        "s_axis_codewords_tvalid", "s_axis_codewords_tready", "s_axis_codewords_tlast",
        "m_axis_raster_tvalid", "m_axis_raster_tready", "m_axis_raster_tlast", "irq")}  # fmt: skip
    return trace(top, parts, watch, CONFIG.clear_cycles + 250, clock=top.aclk, reset=top.aresetn)


@cache
def axi_initial_rows():
    """Return the start of a frame on AXI that begins with a raster."""
    top = AxiTop(CONFIG)
    parts = [
        *register_feeds(top, {"LAST_COLUMN": 15, "LAST_LINE": LINES - 1, "START": 1}),
        axi_feed(top, "s_axis_initial", packet(initial_beats()),
                 when=lambda rows: len(rows) >= CLEARED),
        axi_feed(top, "s_axis_codewords", packet(elements(0)),
                 when=lambda rows: len(rows) >= CLEARED + 6),
        axi_sink(top, "m_axis_raster", beat_label),
    ]  # fmt: skip
    watch = {
        f"{bus}_{wire}": getattr(top, f"{bus}_{wire}")
        for bus in ("s_axis_codewords", "s_axis_initial")
        for wire in ("tvalid", "tready", "tlast")
    }
    return trace(top, parts, watch, CONFIG.clear_cycles + 100, clock=top.aclk, reset=top.aresetn)
