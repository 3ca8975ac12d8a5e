import json
import random

from splatline.flow.timing.ecp5 import DEVICES
from splatline.flow.timing.floorplan import floorplan, floorplan_script
from splatline.flow.tools import run_yosys

SMALL = DEVICES[0]


def cells(lines, columns, memories):
    """Return names of block RAMs as Yosys gives them, in no order, with a table among them."""
    names = ["top.engine.colour.table_.ram.0.0"] + [
        f"top.engine.window.lane_{i}_{j}.ram.0.{k}"
        for i in range(lines)
        for j in range(columns)
        for k in range(memories)
    ]
    random.Random(1).shuffle(names)
    return names


def test_lanes_of_a_column_are_neighbours_in_one_row():
    sites = floorplan(cells(4, 4, 1), SMALL)
    assert len(sites) == 16  # the table is left to the placer
    first = [sites[f"top.engine.window.lane_{i}_0.ram.0.0"] for i in range(4)]
    assert first == ["X4/Y25/EBR0", "X6/Y25/EBR1", "X8/Y25/EBR2", "X10/Y25/EBR3"]
    assert sites["top.engine.window.lane_3_3.ram.0.0"] == "X39/Y25/EBR3"


def test_what_a_row_does_not_hold_lies_in_two():
    sites = floorplan(cells(4, 4, 2), SMALL)
    assert len(set(sites.values())) == len(sites) == 32
    assert sites["top.engine.window.lane_0_0.ram.0.1"] == "X6/Y25/EBR1"
    rows = {
        j: {sites[name].split("/")[1] for name in sites if f"_{j}.ram" in name} for j in range(4)
    }
    assert rows == {0: {"Y25"}, 1: {"Y25"}, 2: {"Y37"}, 3: {"Y37"}}


def test_an_engine_of_a_hundred_block_rams_fits_the_device_that_has_them():
    sites = floorplan(cells(4, 8, 3), DEVICES[1])
    assert len(set(sites.values())) == 96


def test_blocks_lie_about_what_all_their_lanes_send_to():
    lanes = [f"top.window.row_{i}.{half}_{j}.0.0" for half in ("even", "odd") for i in range(8)
             for j in range(8)]  # fmt: skip
    fifo = [f"top.window.readout.queue.fifo.storage.0.{n}" for n in range(16)]
    table = [f"top.colour.table_.ram.0.{n}" for n in range(2)]
    sites = floorplan([*fifo, "top.words.fifo.storage.0.0", *lanes, *table], DEVICES[2])
    assert len(set(sites.values())) == len(sites) == 128 + 18  # another fifo is left to the placer
    middle, below, above, _ = (f"Y{row}" for row in DEVICES[2].rows)
    rows = [
        {sites[name].split("/")[1] for name in lanes if name.endswith(f"_{j}.0.0")}
        for j in range(8)
    ]
    assert rows == [{above}] * 3 + [{middle}] * 2 + [{below}] * 3
    x = {name: int(sites[name].split("/")[0][1:]) for name in sites}
    own = [x[name] for name in (*fifo, *table)]
    assert {sites[name].split("/")[1] for name in (*fifo, *table)} == {middle}
    assert max(x[name] for name in lanes if name.endswith("_3.0.0")) < min(own)
    assert min(x[name] for name in lanes if name.endswith("_4.0.0")) > max(own)
    assert [x[name] for name in fifo] == sorted(x[name] for name in fifo)


def test_without_lanes_there_is_nothing_to_place():
    assert floorplan(["table_.ram.0.0", "lane_row_3.ram.0.0"], SMALL) == {}


def test_the_script_finds_a_cell_by_the_end_of_its_name():
    script = floorplan_script({"mine.window.lane_0_1.ram.0.0": "X4/Y25/EBR0"}, SMALL)
    about, line = script.splitlines()
    assert about.startswith("# ")
    assert "LFE5U-25F" in about
    assert line == 'setattr -set BEL "X4/Y25/EBR0" c:*lane_0_1.ram.0.0'
    script = floorplan_script({"mine.colour.table_.ram.0.1": "X4/Y25/EBR0"}, SMALL)
    assert script.endswith(" c:*colour.table_.ram.0.1\n")


def test_yosys_runs_the_script(tmp_path):
    (tmp_path / "top.v").write_text(
        "module top(input clk); (* keep *) DP16KD \\mine.lane_0_1.ram.0.0 (.CLKA(clk)); endmodule\n"
    )
    (tmp_path / "lanes.ys").write_text(floorplan_script({"lane_0_1.ram.0.0": "X4/Y25/EBR0"}, SMALL))
    commands = ("read_verilog top.v", "script lanes.ys", "write_json top.json")
    run_yosys("; ".join(["read_verilog -lib +/lattice/cells_bb_ecp5.v", *commands]), tmp_path)
    cells = json.loads((tmp_path / "top.json").read_text())["modules"]["top"]["cells"]
    assert cells["mine.lane_0_1.ram.0.0"]["attributes"]["BEL"] == "X4/Y25/EBR0"
