import json

import pytest
from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from splatline.flow.area.synth import COMMAND
from splatline.flow.timing.virtex2_delays import SOURCE, estimate_timing, net_delay
from splatline.flow.tools import run_yosys
from splatline.flow.verilog import convert

OUTPUTS = {"FDRE": "Q", "FDSE": "Q", "MULT18X18": "P", "MULT18X18S": "P"}
OUTPUTS |= dict.fromkeys(("RAMB16_S18_S18", "RAMB16_S36_S36"), "DOA")


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
    # The second LUT stands before its register in one slice; a wire to pin I0 takes longer.
    expected = 0.568 + net_delay(1) + 0.286 + 0.439 + net_delay(2) + 0.286 + 0.439 + 0.370
    assert found["ns"] == pytest.approx(expected, abs=0.006)
    assert found["mhz"] == pytest.approx(1000 / expected, abs=0.05)
    assert found["levels"] == 2
    assert [step["type"] for step in found["path"]] == ["FDRE", "LUT2", "LUT2", "FDRE"]
    assert found["logic_ns"] + found["routing_ns"] == pytest.approx(found["ns"], abs=0.011)
    steps = sum(step["net_ns"] + step["cell_ns"] for step in found["path"])
    assert steps == pytest.approx(found["ns"], abs=0.05)


def test_carries_cost_no_wire_and_a_memory_s_enable_costs_more_than_its_data():
    cells = [
        ("FDRE", 1, {"C": 99, "D": "0"}),
        ("LUT2", 2, {"I3": 1, "I1": "1"}),
        ("MUXCY", 3, {"S": 2, "CI": "0", "DI": "0"}),
        ("MUXCY", 4, {"S": "1", "CI": 3, "DI": "0"}),
        ("XORCY", 5, {"LI": "1", "CI": 4}),
    ]
    before = 0.568 + net_delay(1) + 0.040 + 0.439 + 0.298 + 0.053 + 1.274 + net_delay(1)
    for pin, setup in [("ENA", 1.196), ("WEA", 0.718), ("ADDRA", 0.359), ("DIA", 0.359)]:
        netlist = module(*cells, ("RAMB16_S36_S36", 6, {"CLKA": 99, pin: 5}))
        assert estimate_timing(netlist)["ns"] == pytest.approx(before + setup, abs=0.006)


def test_a_carry_that_leaves_its_chain_takes_longer_than_along_it():
    netlist = module(
        ("FDRE", 1, {"C": 99, "D": "0"}),
        ("MUXCY", 2, {"S": "1", "CI": "0", "DI": 1}),
        ("FDRE", 3, {"C": 99, "D": "0", "CE": 2}),
    )
    found = estimate_timing(netlist)
    expected = 0.568 + net_delay(1) + 0.462 + 0.889 + net_delay(1) + 0.240
    assert found["ns"] == pytest.approx(expected, abs=0.006)
    # It is the carry's time, and neither the wire's nor the register's.
    assert [step["cell_ns"] for step in found["path"]] == [0.57, 1.35, 0.24]


def between(source, *way):
    """A register or memory, whose output goes to pin after pin, each of the cell before."""
    cells = [(source, 1, {"C": 99})]
    cells += [(kind, number, {pin: number - 1}) for number, (kind, pin) in enumerate(way, start=2)]
    return module(*cells)


WIRE = 0.517


@pytest.mark.parametrize(
    ("kind", "pin", "through"),
    [
        ("LUT4", "I1", WIRE + 0.209 + 0.439),
        ("MUXF5", "I0", WIRE + 0.436),
        ("MUXF5", "S", WIRE + 0.699),
        ("MUXF6", "S", WIRE + 0.570),
        ("XORCY", "LI", WIRE + 0.684),
        ("MUXCY", "S", WIRE + 0.298 + 0.889),
        ("INV", "I", 0.0),
    ],
)
def test_ways_through_a_cell(kind, pin, through):
    found = estimate_timing(between("FDRE", (kind, pin), ("FDRE", "CE")))
    assert found["ns"] == pytest.approx(0.568 + through + WIRE + 0.240, abs=0.006)


@pytest.mark.parametrize(
    ("kind", "pin", "setup"),
    [
        ("FDRE", "R", 0.280),
        ("FDSE", "S", 0.280),
        ("RAMB16_S18_S18", "SSRB", 1.65),
        ("RAM16X1S", "WE", 0.525),
        ("RAM16X1S", "A3", 0.667),
        ("MULT18X18S", "A", 3.890),
    ],
)
def test_ends_of_a_path(kind, pin, setup):
    found = estimate_timing(between("FDRE", (kind, pin)))
    assert found["ns"] == pytest.approx(0.568 + WIRE + setup, abs=0.006)


def test_a_block_ram_s_output_comes_late():
    found = estimate_timing(between("RAMB16_S36_S36", ("FDRE", "D")))
    assert found["ns"] == pytest.approx(2.65 + WIRE + 0.370, abs=0.006)


@pytest.mark.parametrize(
    ("kind", "pin", "wire"),
    [
        ("MUXCY", "S", 0.0), ("MUXCY", "DI", WIRE), ("XORCY", "LI", 0.0), ("MUXF5", "I0", 0.0),
        ("MUXF5", "S", WIRE), ("FDRE", "D", 0.0), ("FDRE", "CE", WIRE),
    ],
)  # fmt: skip
def test_wires_behind_a_lut_cost_nothing_within_its_slice(kind, pin, wire):
    netlist = between("FDRE", ("LUT2", "I0"), (kind, pin), ("FDRE", "CE"))
    last = estimate_timing(netlist)["path"][2]
    assert (last["type"], last["pin"], last["net_ns"]) == (kind, pin, round(wire, 2))


def test_a_lut_that_leads_to_two_registers_is_wired_to_them():
    netlist = module(
        ("FDRE", 1, {"C": 99, "D": "0"}),
        ("LUT2", 2, {"I0": 1}),
        ("FDRE", 3, {"C": 99, "D": 2}),
        ("FDRE", 4, {"C": 99, "D": 2}),
    )
    assert estimate_timing(netlist)["path"][-1]["net_ns"] == 0.70


def test_a_product_s_upper_bits_come_later():
    for place, through in [(7, 4.560), (17, 6.630), (27, 8.700), (35, 10.356)]:
        netlist = module(
            ("FDRE", 1, {"C": 99, "D": "0"}),
            ("MULT18X18", 2, {"A": 1}),
            ("FDRE", 3, {"C": 99, "D": 2}),
        )
        netlist["cells"]["cell_1"]["connections"]["P"] = ["0"] * place + [2]
        expected = 0.568 + net_delay(1) + through + net_delay(1) + 0.370
        assert estimate_timing(netlist)["ns"] == pytest.approx(expected, abs=0.006)


# Of ISE 10.1.03's XST for a 2v6000bf957-4: each cell's pin, what its output leads to, and the sum.
# github.com/lycarter/6.111-finalproj, lolzhang/finallabkit.syr:
DIGITS = (
    14.494,
    """
    FDE C 14, LUT3 I0 1, MUXF5 I1 33, LUT3 I0 3, LUT3 I0 3, LUT4 I3 1, MUXF5 I1 1, MUXF6 I0 2,
    LUT4 I2 1, MUXF5 I1 1, LUT4 I3 1, LUT3 I0 1, MUXF5 I1 2, LUT2 I1 1, MUXF5 I0 1, FDE D 0""",
)
# A product and the sum of it, in one of the others; P23 is what the product leaves by.
PRODUCT = 12.785, "FD C 14, MULT18X18 B 2 23, LUT2 I0 1, MUXCY S 1, XORCY CI 1, FD D 0"


@pytest.mark.parametrize(("total", "cells"), [DIGITS, PRODUCT])
def test_paths_come_out_as_xst_reported_them(total, cells):
    found = {}
    for number, line in enumerate(cells.split(",")):
        kind, pin, fan_out, *place = line.split()
        inputs = {pin: number} if number else {}
        out = OUTPUTS.get(kind, "Q" if kind.startswith("FD") else "O")
        found[f"cell_{number}"] = {
            "type": kind,
            "port_directions": {out: "output", **dict.fromkeys(inputs, "input")},
            "connections": {
                out: ["0"] * int(*place or "0") + [number + 1],
                **{name: [bit] for name, bit in inputs.items()},
            },
        }
        for other in range(int(fan_out) - 1):
            found[f"pad_{number}_{other}"] = {
                "type": "OBUF",
                "port_directions": {"I": "input"},
                "connections": {"I": [number + 1]},
            }
    netlist = {"cells": found, "netnames": {}}
    assert estimate_timing(netlist)["ns"] == pytest.approx(total, abs=0.011)


def test_wires_take_longer_the_more_they_lead_to():
    # As in XST's reports.
    seen = {1: 0.517, 2: 0.701, 7: 0.816, 16: 1.000, 22: 1.052, 98: 1.259, 370: 1.963}
    assert {n: net_delay(n) for n in seen} == pytest.approx(seen, abs=0.004)
    assert net_delay(0) == net_delay(1)
    assert net_delay(1000) > net_delay(479)
    assert "from memory" in SOURCE  # the block RAM's was not found


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
    run_yosys(script, tmp_path)
    found = estimate_timing(json.loads((tmp_path / "top.json").read_text())["modules"]["top"])
    # Of the LUT's two inputs I0 is the later.
    expected = 0.568 + net_delay(1) + 0.286 + 0.439 + 0.370
    assert found["ns"] == pytest.approx(expected, abs=0.006)


def test_a_memory_of_luts_is_read_at_once_and_written_at_the_edge():
    read = module(
        ("FDRE", 1, {"C": 99, "D": "0"}),
        ("LUT1", 2, {"I0": 1}),
        ("RAM16X1S", 3, {"A0": 2, "D": "0", "WE": "0", "WCLK": 99}),
        ("LUT1", 4, {"I0": 3}),
        ("FDRE", 5, {"C": 99, "CE": 4}),
    )
    expected = 0.568 + 4 * net_delay(1) + 2 * (0.286 + 0.439) + 0.938 + 0.240
    assert estimate_timing(read)["ns"] == pytest.approx(expected, abs=0.006)
    circle = module(("LUT1", 1, {"I0": 2}), ("RAM16X1S", 2, {"D": 1, "A0": "0", "WCLK": 99}))
    found = estimate_timing(circle)
    assert found["ns"] == pytest.approx(2.05 + 2 * net_delay(1) + 0.286 + 0.439 + 0.667, abs=0.006)
