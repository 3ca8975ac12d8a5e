"""Timing diagrams and tables of ports are made anew, and hold what the page says of them."""

import importlib
import json
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from amaranth.sim import Simulator

from splatline.contract.presets import PAPER
from splatline.rtl.engine import Engine

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def script():
    """The script that draws, which is no package's module."""
    sys.path.insert(0, str(DOCS))
    try:
        return importlib.import_module("draw_waves")
    finally:
        sys.path.remove(str(DOCS))


@pytest.mark.thorough
def test_diagrams_are_made_anew(script):
    made = script.diagrams()
    assert {path.stem for path in (DOCS / "waves").iterdir()} == set(made)
    page = (DOCS / "integration.md").read_text()
    for name, source in made.items():
        assert json.loads((DOCS / f"waves/{name}.json").read_text()) == source, name
        assert (DOCS / f"waves/{name}.svg").read_text() == script.picture(source), name
        assert f"](waves/{name}.svg)" in page


@pytest.fixture(scope="module")
def screen(script):
    """The module with the frame buffer, its memory and its display."""
    return sys.modules[script.framebuffer_rows.__module__]


def latency(page, what):
    """Return the cycles of a row of the page's table of latencies."""
    (row,) = [line for line in page.splitlines() if line.startswith(f"| {what} |")]
    return int(row.split("|")[3])


def test_latencies_on_axi_are_as_the_page_says(script):
    rows = script.axi_rows()
    page = (DOCS / "integration.md").read_text()

    def first(name):
        return next(cycle for cycle, row in enumerate(rows) if row[name])

    end = script.top_taken(rows, "m_axis_raster")[-1]
    assert rows[end]["m_axis_raster_tlast"]
    assert first("irq") - end == latency(page, "the end beat leaves on AXI")
    written = first("s_axi_ctrl_bvalid") - first("s_axi_ctrl_awvalid")
    assert written == latency(page, "a register is written (address and data taken)")
    read = first("s_axi_ctrl_rvalid") - first("s_axi_ctrl_arvalid")
    assert read == latency(page, "a register's read address is taken")


def test_latencies_of_the_frame_buffer_are_as_the_page_says(script, screen):
    rows = screen.framebuffer_rows()
    page = (DOCS / "integration.md").read_text()
    frame = [screen.LINES * n for n in (0, 1)]
    responses = script.top_taken(rows, "m_axi_bresp")
    whole, word = responses[frame[1] - 1], screen.BURST - 1

    def cycles(name, value=1, after=0):
        return [c for c, row in enumerate(rows) if row[name] == value and c >= after]

    beats, words = cycles("beat"), cycles("word")
    told = {
        "the frame writer takes a frame's first beat": words[0] - beats[0],
        "a burst's last bus word enters the FIFO": cycles("m_axi_awvalid")[0] - words[word],
        "the same bus word": cycles("m_axi_wvalid")[0] - words[word],
        "a frame's last response is taken": cycles("swap_valid")[0] - whole,
        "the same response": cycles("irq")[0] - whole,
        "`swapped` is 1": cycles("swap_valid", 0, whole + 3)[0] - cycles("swapped")[0],
        "a response is an error": cycles("writer_error")[0] - responses[frame[1]],
    }
    assert told == {what: latency(page, what) for what in told}
    (swapped,) = cycles("swapped")
    assert cycles("beat", after=whole)[0] == swapped + latency(page, "`swapped` is 1")


def test_the_frame_buffer_writes_a_bus_word_a_cycle_and_takes_two_cycles_for_each_line(screen):
    rows = screen.framebuffer_rows()
    words = [cycle for cycle, row in enumerate(rows) if row["word"]]
    lines = [words[at : at + screen.BURST] for at in range(0, 4 * screen.BURST, screen.BURST)]
    for line, after in pairwise(lines):
        assert line == [*range(line[0], line[0] + screen.BURST)]
        assert after[0] == line[-1] + 3
    inside = False
    for row in rows:
        assert row["m_axi_wvalid"] or not inside, "a burst waits for its data"
        inside = row["m_axi_wvalid"] and not (row["m_axi_w.taken"] and row["m_axi_wlast"])


def test_the_frame_buffer_is_written_where_the_settings_say(script, screen):
    """Although they are 0 outside of the cycles in which the page says to hold them."""
    rows = screen.framebuffer_rows()
    taken = script.top_taken(rows, "m_axi_awaddr")
    places = [int(rows[cycle]["m_axi_awaddr"], 16) for cycle in taken]
    lines = [base + screen.STRIDE * line for base in screen.BUFFERS for line in range(screen.LINES)]
    assert len(places) > screen.LINES
    assert places == lines[: len(places)]
    held = [row["settings"] for row in rows]
    assert set(held) == {None, "frame 1", "frame 2"}


def test_a_table_write_of_a_chain_waits_for_all_engines(script):
    rows = script.chain_rows()
    ends = [script.top_taken(rows, f"codewords_{n}")[-1] for n in range(2)]
    write = script.top_taken(rows, "tables")[-1]
    assert ends[1] < ends[0] < write
    assert not any(row["tables.ready"] for row in rows[ends[1] : write])
    assert not any(row["codewords_1.ready"] for row in rows[ends[1] + 1 : write + 1])


def test_an_offered_table_write_holds_a_first_code_word_back_in_the_same_cycle():
    engine = Engine(PAPER)
    simulator = Simulator(engine)
    simulator.add_clock(10e-9)

    async def bench(ctx):
        await ctx.tick()
        assert ctx.get(engine.codewords.ready) == 1
        ctx.set(engine.tables.valid, 1)
        assert ctx.get(engine.codewords.ready) == 0

    simulator.add_testbench(bench)
    simulator.run()


def test_a_narrow_word_takes_a_cycle_more_than_it_has_pieces(script):
    taken = script.top_taken(script.narrow_rows(), "words")
    assert [after - before for before, after in zip(taken, taken[4:], strict=False)] == [5] * (
        len(taken) - 4
    )


def test_the_tables_of_bits_are_made_anew(tmp_path):
    made = tmp_path / "streams.md"
    subprocess.run([sys.executable, DOCS / "tabulate_streams.py", made], check=True)
    assert made.read_text() == (DOCS / "streams.md").read_text()
