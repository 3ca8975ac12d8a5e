"""Timing diagrams and tables of ports are made anew, and hold what the page says of them."""

import importlib
import json
import subprocess
import sys
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


def test_diagrams_are_made_anew(script):
    made = script.diagrams()
    assert {path.stem for path in (DOCS / "waves").iterdir()} == set(made)
    page = (DOCS / "integration.md").read_text()
    for name, source in made.items():
        assert json.loads((DOCS / f"waves/{name}.json").read_text()) == source, name
        assert (DOCS / f"waves/{name}.svg").read_text() == script.picture(source), name
        assert f"](waves/{name}.svg)" in page


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
