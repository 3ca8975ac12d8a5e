import re

import pytest

from splatline.contract.presets import PAPER
from splatline.sim.cosim.faults.upsets import with_upsets
from tests.support.engines import verilog

MODULE = """module splatline(clk, d, q);
  input clk;
  input [3:0] d;
  output q;
  reg [3:0] held = 4'h0;
  reg one = 1'h0;
  reg [7:0] ram [15:0];
  always @(posedge clk)
    held <= d;
  always @(posedge clk)
    one <= q;
  always @(posedge clk) begin
    if (one)
      ram[held[3:0]] <= d;
  end
endmodule
"""


def test_every_register_and_memory_of_a_module_gets_an_upset():
    text, state = with_upsets(MODULE)
    assert [part[1:] for part in state] == [("held", 4, 1), ("one", 1, 1), ("ram", 8, 16)]
    assert "      1: one <= ~one;" in text
    place = "[splatline.upset_row][splatline.upset_bit]"
    assert f"      2: ram{place} <= ~ram{place};" in text
    assert text.startswith("module splatline(clk, d, q, upset, upset_register, upset_bit")


def test_what_is_no_register_is_refused():
    with pytest.raises(ValueError, match=r"splatline\.held is assigned, but is no register"):
        with_upsets(MODULE.replace("reg [3:0] held = 4'h0", "wire [3:0] held"))


def test_an_engine_s_state_is_all_that_its_clock_writes():
    """Counted another way: each clocked block assigns one register or memory."""
    text = verilog(PAPER)
    _, state = with_upsets(text)
    # A memory with two write ports is one, and a block a port.
    assert len(state) <= len(re.findall(r"always @\(posedge clk\)", text)) <= len(state) + 16
    lanes = [part for part in state if part.rows == 1 << PAPER.x_bits]
    assert len(lanes) == 4 * PAPER.pixels_per_word
    assert {part.bits for part in lanes} == {PAPER.depth_bits + PAPER.colour_bits}
