"""Draw the timing diagrams of the ports: ``docs/waves/NAME.json`` (WaveJSON) and ``NAME.svg``.

Run as ``.venv/bin/python docs/draw_waves.py [FOLDER]``. Every level and every word is from a
simulation of preset ``paper`` in Amaranth's simulator; WaveDrom draws them.
"""

import json
import sys
from pathlib import Path

import yowasp_wavedrom
from port_traces import (
    CONFIG,
    Feed,
    axi_feed,
    axi_sink,
    beat_label,
    elements,
    stream_feed,
    stream_sink,
    table_writes,
    trace,
)

from splatline.contract.register_map import register_map
from splatline.rtl.bus.axi_top import AxiTop
from splatline.rtl.bus.narrow_top import PinTop
from splatline.rtl.engine import Engine

WORD_PIECE = 16
"""Bits of a piece on the narrow top's port of words."""

CLEARED = CONFIG.clear_cycles + 5
"""A cycle after the window is cleared."""


def engine_rows(start):
    """Return a frame that is offered from a cycle on, and a table write that waits for its end."""
    top = Engine(CONFIG)
    writes = [*table_writes(), ("next frame's", table_writes()[-1][1])]
    parts = [
        stream_feed(top, "tables", writes,
                    when=lambda rows: len(top_taken(rows, "tables")) < 4
                    or len(top_taken(rows, "codewords")) > 2),
        stream_feed(top, "codewords", elements(3),
                    when=lambda rows: len(rows) >= start),
        stream_sink(top, "raster", beat_label, waits=lambda cycle: cycle % 5 in (1, 2)),
    ]  # fmt: skip
    return trace(top, parts, signals(top, "tables", "codewords", "raster") | {
        "in_frame": top.in_frame}, CONFIG.clear_cycles + 200)  # fmt: skip


def initial_rows():
    """Return the start of a frame that begins with a raster."""
    top = Engine(CONFIG)
    beats = [beat(line, word) for line in range(3) for word in range(2)]
    beats.append(("end", 1 << CONFIG.raster_end.lsb))
    parts = [
        stream_feed(top, "tables", table_writes(load=1)),
        stream_feed(top, "codewords", elements(1),
                    when=lambda rows: len(rows) >= CLEARED),
        stream_feed(top, "initial", beats, when=lambda rows: len(rows) > 5),
        stream_sink(top, "raster", beat_label),
    ]  # fmt: skip
    ports = signals(top, "codewords", "initial", "raster")
    return trace(top, parts, ports, CONFIG.clear_cycles + 200)


def narrow_rows():
    """Return a frame on the narrow top."""
    top = PinTop(CONFIG)
    words = []
    for table, given in ((1, table_writes()), (0, elements(0))):
        for label, word in given:
            for piece in range(4):
                data = word >> WORD_PIECE * piece & (1 << WORD_PIECE) - 1
                words.append((str(piece) if piece else label, data | table << WORD_PIECE))
    parts = [
        stream_feed(top, "words", words),
        stream_sink(top, "raster", lambda piece: f"{piece:x}"),
    ]
    ports = signals(top, "words", "raster") | {"words.table": top.words.payload.table}
    return trace(top, parts, ports, CONFIG.clear_cycles + 300)


def axi_rows():
    """Return a frame on AXI: a register is written and read, a packet goes in, one comes out."""
    top = AxiTop(CONFIG)
    registers = register_map(CONFIG)
    enable, done = registers["IRQ_ENABLE"].offset, registers["FRAMES"].offset
    codewords = elements(0)
    packet = [(label, word, int(label == "end")) for label, word in codewords]
    address = {
        name: {wire: getattr(top, f"s_axi_ctrl_{name}{wire}") for wire in ("valid", "ready")}
        for name in ("aw", "w", "b", "ar", "r")
    }
    parts = [
        Feed("aw", *address["aw"].values(), top.s_axi_ctrl_awaddr, [(f"{enable:#x}", enable)],
             when=lambda rows: len(rows) > 2),
        Feed("w", *address["w"].values(), top.s_axi_ctrl_wdata, [("1", 1)],
             when=lambda rows: len(rows) > 2),
        Feed("ar", *address["ar"].values(), top.s_axi_ctrl_araddr, [(f"{done:#x}", done)],
             when=lambda rows: len(rows) > 7),
        axi_feed(top, "s_axis_codewords", packet, when=lambda rows: len(rows) > 10),
        axi_sink(top, "m_axis_raster", beat_label, waits=lambda cycle: cycle % 4 == 1),
    ]  # fmt: skip
    constant = [
        (top.s_axi_ctrl_wstrb, 15), (top.s_axi_ctrl_bready, 1), (top.s_axi_ctrl_rready, 1),
        (top.s_axis_codewords_tkeep, 255),
    ]  # fmt: skip
    parts.append(Constants(constant))
    watch = {name: getattr(top, name) for name in (
        "aresetn", "s_axi_ctrl_awvalid", "s_axi_ctrl_awready", "s_axi_ctrl_wvalid",
        "s_axi_ctrl_wready", "s_axi_ctrl_bvalid", "s_axi_ctrl_bready", "s_axi_ctrl_arvalid",
        "s_axi_ctrl_arready", "s_axi_ctrl_rvalid", "s_axi_ctrl_rready",
        "s_axis_codewords_tvalid", "s_axis_codewords_tready", "s_axis_codewords_tlast",
        "m_axis_raster_tvalid", "m_axis_raster_tready", "m_axis_raster_tlast", "irq")}  # fmt: skip
    return trace(top, parts, watch, CONFIG.clear_cycles + 250, clock=top.aclk, reset=top.aresetn)


class Constants:
    """Inputs that do not change."""

    def __init__(self, values):
        self.values = values

    def drive(self, ctx, rows):
        """Set them."""
        for signal, value in self.values:
            ctx.set(signal, value)

    def record(self, ctx):
        """Return nothing."""
        return {}


def beat(line, word):
    """Return a beat of drawn pixels with its label."""
    value = line << CONFIG.raster_line.lsb | word << CONFIG.raster_word.lsb
    for pixel in range(CONFIG.raster_pixels):
        value |= 50 << CONFIG.raster_depth(pixel).lsb
    return f"{line}:{word}", value


def signals(top, *names):
    """Return valid and ready of streams by name."""
    return {
        f"{name}.{wire}": getattr(getattr(top, name), wire)
        for name in names
        for wire in ("valid", "ready")
    }


def top_taken(rows, name):
    """Return the cycles in which a word of a stream is taken."""
    return [cycle for cycle, row in enumerate(rows) if row[f"{name}.taken"]]


def wave(rows, name, cycles):
    """Return a lane of WaveJSON; None among the cycles is a gap."""
    text, data, last = "", [], object()
    for cycle in cycles:
        if cycle is None:
            text += "|"
            continue
        value = rows[cycle].get(name)
        taken_before = cycle and rows[cycle - 1].get(f"{name}.taken")
        if value == last and not (isinstance(value, str) and taken_before):
            text += "."
        elif isinstance(value, str):
            text += "="
            data.append(value)
        else:
            text += "x" if value is None else str(value)
        last = value
    return {"name": name, "wave": text, **({"data": data} if data else {})}


def diagram(rows, title, lanes, *spans):
    """Return WaveJSON of some lanes in some spans of cycles, each (first, last) with both."""
    cycles = []
    for first, last in spans:
        cycles += [*([None] if cycles else []), *range(first, last + 1)]
    clock = "p" + "".join("|" if cycle is None else "." for cycle in cycles[1:])
    drawn = [wave(rows, lane, cycles) if lane else {} for lane in lanes[1:]]
    return {
        "signal": [{"name": lanes[0], "wave": clock}, *drawn],
        "head": {"text": title},
        "config": {"hscale": 1},
    }


def stream(*names):
    """Return the lanes of streams of the engine."""
    return [lane for name in names for lane in (name, f"{name}.valid", f"{name}.ready", "")][:-1]


def diagrams():
    """Return WaveJSON by name."""
    engine, early = engine_rows(CLEARED), engine_rows(8)
    initial, narrow, axi = initial_rows(), narrow_rows(), axi_rows()
    words, beats = top_taken(engine, "codewords"), top_taken(engine, "raster")
    late = top_taken(engine, "tables")[-1]
    held = top_taken(early, "codewords")[-3]
    loads, first = top_taken(initial, "initial"), top_taken(initial, "codewords")[0]
    pieces, out = top_taken(narrow, "words"), top_taken(narrow, "raster")
    packet, picture = top_taken(axi, "s_axis_codewords"), top_taken(axi, "m_axis_raster")
    rises = next(cycle for cycle, row in enumerate(axi) if row["irq"])
    control = [lane for name in ("aw", "w", "b", "ar", "r") for lane in (
        *([name] if name in ("aw", "w", "ar") else []),
        f"s_axi_ctrl_{name}valid", f"s_axi_ctrl_{name}ready", "")]  # fmt: skip
    return {
        "reset": diagram(early, "Reset, tables, and code words that wait for the cleared window",
                         ["clk", "rst", "", *stream("tables", "codewords"), "in_frame"],
                         (0, 14), (held - 2, held + 3)),
        "codewords": diagram(engine, "Code words; a table write of the next frame waits",
                             ["clk", *stream("codewords", "tables"), "in_frame"],
                             (words[0] - 1, words[-1] + 2), (late - 2, late + 1)),
        "raster": diagram(engine, "Raster: line:word of each beat, with back-pressure",
                          ["clk", *stream("raster")], (beats[0] - 2, beats[0] + 10),
                          (beats[-1] - 4, beats[-1] + 2)),
        "initial": diagram(initial, "Initial raster: taken while its lines are in the window",
                           ["clk", *stream("initial", "codewords")],
                           (6, 9), (first - 1, max(loads[-1], first) + 2)),
        "narrow": diagram(narrow, "Narrow top: table writes in four pieces, a beat in five",
                          ["clk", "rst", "words", "words.table", "words.valid", "words.ready", "",
                           *stream("raster")],
                          (0, pieces[7] + 2), (out[0] - 2, out[0] + 8)),
        "axi_control": diagram(axi, "AXI4-Lite: IRQ_ENABLE is written, FRAMES is read",
                               ["aclk", "aresetn", "", *control[:-1]], (0, 14)),
        "axi_streams": diagram(axi, "AXI4-Stream: code words, their picture, the interrupt",
                               ["aclk", "s_axis_codewords", "s_axis_codewords_tvalid",
                                "s_axis_codewords_tready", "s_axis_codewords_tlast", "",
                                "m_axis_raster", "m_axis_raster_tvalid", "m_axis_raster_tready",
                                "m_axis_raster_tlast", "", "irq"],
                               (packet[0] - 1, packet[0] + 2), (packet[-1] - 3, packet[-1] + 2),
                               (picture[0] - 2, picture[0] + 4), (picture[-1] - 3, rises + 1)),
    }  # fmt: skip


def picture(source):
    """Return the SVG of a diagram, on white, so that it is legible on a dark page."""
    root, more = yowasp_wavedrom.render(source).split(">", 1)
    return f'{root}><rect width="100%" height="100%" fill="#fff"/>{more}\n'


def main(folder):
    """Write the diagrams."""
    folder.mkdir(exist_ok=True)
    for name, source in diagrams().items():
        (folder / f"{name}.json").write_text(json.dumps(source, indent=1) + "\n")
        (folder / f"{name}.svg").write_text(picture(source))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent / "waves"))
