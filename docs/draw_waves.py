"""Draw the timing diagrams of the ports: ``docs/waves/NAME.json`` (WaveJSON) and ``NAME.svg``.

Run as ``.venv/bin/python docs/draw_waves.py [FOLDER]``. Every level and every word is from a
simulation of preset ``paper`` in Amaranth's simulator (``stream_rows.py``,
``bus_rows.py``, ``framebuffer_rows.py``); WaveDrom draws them.
"""

import json
import sys
from pathlib import Path

import yowasp_wavedrom
from bus_rows import axi_initial_rows, axi_rows
from framebuffer_rows import framebuffer_rows
from port_traces import top_taken
from port_words import CLEARED, LINES
from stream_rows import chain_rows, engine_rows, initial_rows, narrow_initial_rows, narrow_rows


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


def bus(name, *wires):
    """Return the lanes of a bus: its word, and some of its wires."""
    return [name, *(f"{name}{wire}" for wire in wires)]


def engine_diagrams():
    """Return WaveJSON by name: the ports of an engine and of a chain."""
    engine, early = engine_rows(CLEARED), engine_rows(8)
    initial, chain = initial_rows(), chain_rows()
    words, beats = top_taken(engine, "codewords"), top_taken(engine, "raster")
    late = top_taken(engine, "tables")[-1]
    held = top_taken(early, "codewords")[-3]
    loads, first = top_taken(initial, "initial"), top_taken(initial, "codewords")[0]
    parts = [top_taken(chain, f"codewords_{n}") for n in range(2)]
    begun, joined = top_taken(chain, "initial"), top_taken(chain, "raster")
    between = top_taken(chain, "tables")[-1]
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
        "chain": diagram(chain, "Two engines: a stream of code words each; tables wait for both",
                         ["clk", *stream("codewords_0", "codewords_1", "tables")],
                         (parts[0][0] - 1, parts[1][-1] + 2),
                         (parts[0][-1] - 2, parts[0][-1] + 1), (between - 2, between + 1)),
        "chain_raster": diagram(chain, "Two engines: one initial raster, one raster",
                                ["clk", *stream("initial", "raster")],
                                (begun[0] - 1, begun[-1] + 1), (joined[0] - 1, joined[0] + 4),
                                (joined[-1] - 3, joined[-1] + 1)),
    }  # fmt: skip


def narrow_diagrams():
    """Return WaveJSON by name: the ports of the narrow top."""
    narrow, initial = narrow_rows(), narrow_initial_rows()
    pieces, out = top_taken(narrow, "words"), top_taken(narrow, "raster")
    first, loads = top_taken(initial, "words")[16], top_taken(initial, "initial")
    words = ["words", "words.table", "words.valid", "words.ready", ""]
    return {
        "narrow": diagram(narrow, "Narrow top: table writes in four pieces, a beat in five",
                          ["clk", "rst", *words, *stream("raster")],
                          (0, pieces[7] + 2), (out[0] - 2, out[0] + 8)),
        "narrow_initial": diagram(initial, "Narrow top: an initial beat in five pieces",
                                  ["clk", *words, *stream("initial")],
                                  (loads[0] - 2, loads[4] + 2), (first - 1, loads[10] + 1)),
    }  # fmt: skip


def axi_diagrams():
    """Return WaveJSON by name: the ports of the AXI top."""
    axi, initial = axi_rows(), axi_initial_rows()
    packet, picture = top_taken(axi, "s_axis_codewords"), top_taken(axi, "m_axis_raster")
    rises = next(cycle for cycle, row in enumerate(axi) if row["irq"])
    loads = top_taken(initial, "s_axis_initial")
    control = [lane for name in ("aw", "w", "b", "ar", "r") for lane in (
        *([name] if name in ("aw", "w", "ar") else []),
        f"s_axi_ctrl_{name}valid", f"s_axi_ctrl_{name}ready", "")]  # fmt: skip
    wires = "_tvalid", "_tready", "_tlast"
    codewords = bus("s_axis_codewords", *wires)
    return {
        "axi_control": diagram(axi, "AXI4-Lite: IRQ_ENABLE is written, FRAMES is read",
                               ["aclk", "aresetn", "", *control[:-1]], (0, 14)),
        "axi_streams": diagram(axi, "AXI4-Stream: code words, their picture, the interrupt",
                               ["aclk", *codewords, "", *bus("m_axis_raster", *wires), "", "irq"],
                               (packet[0] - 1, packet[0] + 2), (packet[-1] - 3, packet[-1] + 2),
                               (picture[0] - 2, picture[0] + 4), (picture[-1] - 3, rises + 1)),
        "axi_initial": diagram(initial, "AXI4-Stream: the initial raster of a frame",
                               ["aclk", *bus("s_axis_initial", *wires), "", *codewords],
                               (loads[0] - 1, loads[-1] + 2)),
    }  # fmt: skip


def framebuffer_diagrams():
    """Return WaveJSON by name: what the frame buffer top has beside the AXI top's ports."""
    rows = framebuffer_rows()
    addresses, answers = top_taken(rows, "m_axi_awaddr"), top_taken(rows, "m_axi_bresp")
    wrong = next(cycle for cycle, row in enumerate(rows) if row["m_axi_bresp"] == "2")
    shown = next(cycle for cycle, row in enumerate(rows) if row["swapped"])
    again = next(cycle for cycle in range(shown, len(rows)) if rows[cycle]["m_axi_awvalid"])
    whole = answers[LINES - 1]
    sent = top_taken(rows, "s_axis_codewords")[-1]
    return {
        "framebuffer_write": diagram(rows, "AXI4: a burst, its response; a response with an error",
                                     ["aclk", "m_axi_awaddr", "m_axi_awlen", "m_axi_awvalid",
                                      "m_axi_awready", "",
                                      *bus("m_axi_w", "valid", "ready", "last"), "",
                                      "m_axi_bresp", "m_axi_bvalid", "m_axi_bready", "",
                                      "writer_error"],
                                     (addresses[0] - 3, answers[0] + 1), (wrong - 1, wrong + 2)),
        "framebuffer_swap": diagram(rows, "A swap: the picture waits until the display takes it",
                                    ["aclk", *bus("s_axis_codewords", "_tvalid", "_tready"), "",
                                     "settings", "", "m_axi_bvalid", "swap_valid", "swap_index",
                                     "swapped", "irq", "", "m_axi_awaddr", "m_axi_awvalid",
                                     "m_axi_awready"],
                                    (whole - 1, sent + 1), (shown - 1, shown + 2),
                                    (again - 1, again + 3)),
    }  # fmt: skip


def diagrams():
    """Return WaveJSON by name."""
    return {**engine_diagrams(), **narrow_diagrams(), **axi_diagrams(), **framebuffer_diagrams()}


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
