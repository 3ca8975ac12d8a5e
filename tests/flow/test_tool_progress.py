"""What Yosys and nextpnr print, and the shares that are told of it."""

from splatline.flow.tool_progress import follow_nextpnr, follow_yosys
from splatline.flow.tools import run_yosys

NEXTPNR = """\
Info: Packing LUTs...
Info:     at iteration #5, type ALL: wirelen solved = 7613, spread = 38731, legal = 39260; time = 0.93s
Info:     at iteration #20, type ALL: wirelen solved = 12229, spread = 31122, legal = 33690; time = 1.40s
Info: Running simulated annealing placer for refinement.
Info: [  6075,   6706) |*****************************+
Info:    IterCnt |  w/ripup   wo/ripup |  w/r  wo/r |      arcs| batch(sec) total(sec)|
Info:       1000 |      268        731 |  268   731 |     12000|       7.83       7.83|
Info:       8000 |     2069       5930 |  292   708 |      3000|       7.38      47.17|
Info:      19092 |     4754      13690 |    2    79 |         0|       0.70     120.23|
"""  # noqa: E501  (as nextpnr prints them)

DESIGN = "module top(input clk, a, output reg q); always @(posedge clk) q <= ~a; endmodule"


def test_nextpnr_is_followed_from_its_placer_to_the_last_connection():
    told = []
    hear = follow_nextpnr(told.append)
    for line in NEXTPNR.splitlines(keepends=True):
        hear(line)
    assert told == [0.0625, 0.25, 0.5, 0.875, 1.0]


def test_yosys_tells_its_passes(tmp_path):
    (tmp_path / "top.v").write_text(DESIGN)
    told = []
    script = "read_verilog top.v; synth_xilinx -family xc2v -ise -nowidelut -flatten -top top"
    run_yosys(script, tmp_path, told.append)
    assert told == sorted(told)
    assert len(told) > 100
    assert 0.5 < told[-1] <= 1.0


def test_other_lines_of_yosys_say_nothing():
    told = []
    hear = follow_yosys(told.append)
    hear("Warning: 2.3. Executing is a word\n")
    hear("Removed 3 cells.\n")
    assert told == []
    hear("2.4.1. Executing OPT_EXPR pass (perform const folding).\n")
    assert len(told) == 1
