import re

import pytest

from splatline.contract.presets import LANES8, PAPER, PRESETS
from splatline.contract.variants import VARIANTS
from splatline.flow.narrow_verilog import generate_pins
from splatline.flow.timing.pnr import (
    CONSTRAINTS,
    RESOURCES,
    SHORT,
    placer,
    read_report,
    synthesis_script,
)
from splatline.flow.tools import ToolError


def step(kind, delay, cell, net=None):
    found = {"type": kind, "delay": delay, "to": {"cell": cell, "port": "A"}}
    return found if net is None else {**found, "net": net}


def report(**changes):
    path = [
        step("clk-to-q", 0.5, "engine.window.top_TRELLIS_FF_Q_3"),
        step("routing", 1.25, "engine.window.go_LUT4_Z", "engine.window.top[3]"),
        step("logic", 0.25, "engine.window.go_LUT4_Z"),
        step("routing", 1.0, "engine.ring.left_TRELLIS_FF_Q", "engine.window.go_LUT4_Z_A_CCU2C_S0"),
        step("setup", 0.0, "engine.ring.left_TRELLIS_FF_Q"),
    ]
    return {
        "fmax": {"$glbnet$clk": {"achieved": 125.0, "constraint": 100.0}},
        "utilization": {cell: {"used": 3, "available": 30} for cell in RESOURCES},
        "critical_paths": [
            {"from": "<async>", "to": "posedge $glbnet$clk", "path": []},
            {"from": "posedge $glbnet$clk", "to": "posedge $glbnet$clk", "path": path},
        ],
        **changes,
    }


def test_a_report_becomes_rate_slack_use_and_path():
    found = read_report(report())
    assert (found["fmax_mhz"], found["target_mhz"], found["slack_ns"]) == (125.0, 100.0, 2.0)
    assert found["utilisation"]["block RAMs"] == {"used": 3, "available": 30}
    assert (found["logic_ns"], found["routing_ns"]) == (0.75, 2.25)
    assert [row["name"] for row in found["critical_path"]] == [
        "engine.window.top", "engine.window.top[3]", "engine.window.go", "engine.window.go",
        "engine.ring.left",
    ]  # fmt: skip
    assert found["critical_path"][-1]["module"] == "engine.ring"


def test_a_missed_rate_has_negative_slack():
    missed = read_report(report(fmax={"clk": {"achieved": 80.0, "constraint": 100.0}}))
    assert missed["slack_ns"] == -2.5


@pytest.mark.parametrize("count", [0, 2])
def test_a_report_without_the_one_clock_is_refused(count):
    rate = {"achieved": 1.0, "constraint": 1.0}
    with pytest.raises(ToolError, match=f"{count} clocks"):
        read_report(report(fmax={str(n): rate for n in range(count)}))


def test_the_constraints_name_every_pin_and_no_other():
    _, description = generate_pins(PAPER, "top")
    pins = set()
    for port in description["ports"]:
        whole = port["width"] == 1
        pins |= {port["name"] if whole else f"{port['name']}[{n}]" for n in range(port["width"])}
    named = re.findall(r'^IOBUF PORT "([^"]+)" IO_TYPE=LVCMOS33;$', CONSTRAINTS.read_text(), re.M)
    assert len(named) == len(set(named))
    assert set(named) == pins


def test_the_vendor_s_constraints_fit_the_pins():
    text = (CONSTRAINTS.parent / "xc2v250_fg256.ucf").read_text()
    globs = re.findall(r'^NET "([^"]+)"\s+IOSTANDARD', text, re.M)
    _, description = generate_pins(PAPER, "top")
    for port in description["ports"]:
        assert any(port["name"].startswith(glob.rstrip("*")) for glob in globs), port["name"]


def test_only_draws_blocks_are_placed_for_short_wires_alone():
    short = [c.name for c in (*PRESETS.values(), *VARIANTS) if placer(c) == SHORT]
    assert short == ["swift", "swift-plane"]


def test_block_rams_of_pairs_come_from_a_library_that_promises_more(tmp_path):
    """Of Yosys' own, but for what nobody counts on; other engines have that as it is."""
    (synthesis,) = synthesis_script(PAPER, "synth", "top", tmp_path)[1:]
    assert synthesis == "synth -top top -json top.json"
    assert not list(tmp_path.iterdir())
    commands = synthesis_script(LANES8, "synth", "top", tmp_path)
    assert commands[1].endswith("-run :map_ram")
    assert commands[-1] == f"{synthesis} -run map_ram:"
    assert (tmp_path / "brams.txt").read_text().count("rdwr old; wrtrans all old;") == 1
