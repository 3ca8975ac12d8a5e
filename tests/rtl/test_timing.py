import json

import pytest
from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from splatline.rtl.netlist import RUN_YOSYS, run_tool
from splatline.rtl.synth import COMMAND
from splatline.rtl.timing import SOURCE, estimate_timing, net_delay
from splatline.rtl.verilog import convert

OUTPUTS = {"FDRE": "Q", "RAMB16_S36_S36": "DOA", "MULT18X18": "P"}


def module(*cells):
    """A netlist of (kind, output bit, {pin: input bit})."""
    found = {}
    for number, (kind, out, inputs) in enumerate(cells):
        pin = OUTPUTS.get(kind, "O")
        found[f"cell_{number}"] = {
            "type": kind,
            "port_directions": {pin: "output", **dict.fromkeys(inputs, "input")},
            "connections": {pin: [out], **{name: [bit] for name, bit in inputs.items()}},
        }
    return {"cells": found, "netnames": {}}


def test_a_path_worked_out_by_hand():
    """Out of a register, through a LUT that two others read, through one more, into a register."""
    netlist = module(
        ("FDRE", 1, {"C": 99, "D": 4}),
        ("LUT2", 2, {"I0": 1, "I1": "1"}),
        ("LUT2", 3, {"I0": 2, "I1": "1"}),
        ("LUT1", 5, {"I0": 2}),
        ("FDRE", 4, {"C": 99, "D": 3}),
    )
    found = estimate_timing(netlist)
    # The second LUT stands before its register in one slice.
    expected = 0.57 + net_delay(1) + 0.44 + net_delay(2) + 0.44 + 0.37
    assert found["ns"] == pytest.approx(expected, abs=0.005)
    assert found["mhz"] == pytest.approx(1000 / expected, abs=0.05)
    assert found["levels"] == 2
    assert [step["type"] for step in found["path"]] == ["FDRE", "LUT2", "LUT2", "FDRE"]
    assert found["logic_ns"] + found["routing_ns"] == pytest.approx(found["ns"], abs=0.011)
    steps = sum(step["net_ns"] + step["cell_ns"] for step in found["path"])
    assert steps == pytest.approx(found["ns"], abs=0.05)


def test_carries_cost_no_wire_and_a_memory_s_enable_costs_more_than_its_data():
    netlist = module(
        ("FDRE", 1, {"C": 99, "D": "0"}),
        ("LUT2", 2, {"I0": 1, "I1": "1"}),
        ("MUXCY", 3, {"S": 2, "CI": "0", "DI": "0"}),
        ("MUXCY", 4, {"S": "1", "CI": 3, "DI": "0"}),
        ("XORCY", 5, {"LI": "1", "CI": 4}),
        ("RAMB16_S36_S36", 6, {"CLKA": 99, "ENA": 5}),
    )
    expected = 0.57 + net_delay(1) + 0.44 + 0.30 + 0.053 + 1.27 + net_delay(1) + 1.20
    assert estimate_timing(netlist)["ns"] == pytest.approx(expected, abs=0.005)


def test_wires_take_longer_the_more_they_lead_to():
    assert [net_delay(n) for n in (1, 2, 16)] == pytest.approx([0.6, 0.8, 1.4])
    assert "memory" in SOURCE  # the data sheet was not at hand


def test_what_cannot_be_timed_is_refused():
    loop = module(("LUT1", 1, {"I0": 2}), ("LUT1", 2, {"I0": 1}), ("FDRE", 3, {"C": 9, "D": 1}))
    with pytest.raises(RuntimeError, match="combinational loop"):
        estimate_timing(loop)
    with pytest.raises(RuntimeError, match="no path from a register"):
        estimate_timing(module(("FDRE", 1, {"C": 9, "D": "0"})))
    with pytest.raises(RuntimeError, match="the cell DSP48"):
        estimate_timing(module(("FDRE", 1, {"C": 9, "D": 2}), ("DSP48", 2, {"A": 1})))


class Invert(wiring.Component):
    """A register whose complement the next one takes."""

    def __init__(self):
        super().__init__({"i": In(2), "o": Out(1)})

    def elaborate(self, platform):
        m = Module()
        first, second = Signal(2), Signal()
        m.d.sync += [first.eq(self.i), second.eq(first[0] ^ first[1]), self.o.eq(second)]
        return m


def test_a_component_through_yosys(tmp_path):
    (tmp_path / "top.v").write_text(convert(Invert(), "top"))
    script = f"read_verilog top.v; {COMMAND} -flatten -top top; write_json top.json"
    run_tool("Yosys", RUN_YOSYS, ["-q", "-p", script], tmp_path)
    found = estimate_timing(json.loads((tmp_path / "top.json").read_text())["modules"]["top"])
    assert found["ns"] == pytest.approx(0.57 + net_delay(1) + 0.44 + 0.37, abs=0.005)


def test_a_tool_that_fails_shows_its_log(tmp_path):
    with pytest.raises(RuntimeError, match=r"Yosys failed:\n(.|\n)*nowhere"):
        run_tool("Yosys", RUN_YOSYS, ["-q", "-p", "read_verilog nowhere.v"], tmp_path)


def test_a_memory_of_luts_is_read_at_once_and_written_at_the_edge():
    read = module(
        ("FDRE", 1, {"C": 99, "D": "0"}),
        ("RAM16X1S", 2, {"A0": 1, "D": "0", "WE": "0", "WCLK": 99}),
        ("LUT1", 3, {"I0": 2}),
        ("FDRE", 4, {"C": 99, "CE": 3}),
    )
    expected = 0.57 + net_delay(1) + 0.44 + net_delay(1) + 0.44 + net_delay(1) + 0.37
    assert estimate_timing(read)["ns"] == pytest.approx(expected, abs=0.005)
    circle = module(("LUT1", 1, {"I0": 2}), ("RAM16X1S", 2, {"D": 1, "A0": "0", "WCLK": 99}))
    found = estimate_timing(circle)
    assert found["ns"] == pytest.approx(1.4 + 2 * net_delay(1) + 0.44 + 0.6, abs=0.005)
