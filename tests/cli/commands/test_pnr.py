import json
import sys
import types

import pytest

from splatline.cli.commands.pnr import pnr
from splatline.contract.presets import DEFAULT
from splatline.flow.timing.ecp5 import DEVICES
from splatline.flow.tools import ToolError

REPORT = {
    "preset": "paper",
    "top": "pins",
    "device": "LFE5U-25F-6BG381",
    "seed": 1,
    "median_mhz": 111.05,
    "rates_mhz": {"1": 123.4, "2": 98.7},
    "fmax_mhz": 123.4,
    "target_mhz": 100.0,
    "slack_ns": 1.9,
    "utilisation": {"4-input LUTs": {"used": 2400, "available": 24288}},
    "logic_ns": 2.0,
    "routing_ns": 6.1,
    "critical_path": [
        {"type": "clk-to-q", "ns": 0.5, "module": "engine", "name": "engine.draining"},
        {"type": "routing", "ns": 6.1, "module": "engine", "name": "engine.draining"},
    ],
    "virtex2_estimate_mhz": 90.1,
    "virtex2_estimate": {"mhz": 90.1, "levels": 7, "source": "a data sheet"},
}


@pytest.fixture
def routing(monkeypatch):
    """Puts a place and route in place that takes no time."""
    asked = []

    def place_and_route(config, *, top, device, seed, tries, mhz, packed, script, progress):
        asked.append((config, top, device, seed, tries, mhz))
        progress(0.5)
        if packed is not None:
            packed.write_bytes(b"bits")
        if script is not None:
            script.write_text("setattr\n")
        if top == "pins":
            return REPORT
        return {**REPORT, "top": top, "virtex2_estimate_mhz": None, "virtex2_estimate": None}

    module = types.ModuleType("splatline.flow.timing.pnr")
    module.place_and_route = place_and_route
    monkeypatch.setitem(sys.modules, "splatline.flow.timing.pnr", module)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: True)
    return module, asked


def test_pnr_writes_the_report_and_the_bitstream_and_prints_the_path(run, folder, routing):
    result = run(
        "pnr", "--seed", 3, "--tries", 2, "--freq", 150, "--json", "a.json", "--bitstream", "a.bit",
        "--floorplan", "a.ys", "--device", "LFE5U-85F",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert routing[1] == [(DEFAULT, "pins", "LFE5U-85F", 3, 2, 150.0)]
    assert json.loads((folder / "a.json").read_text()) == REPORT
    assert (folder / "a.bit").read_bytes() == b"bits"
    assert (folder / "a.ys").read_text() == "setattr\n"
    for text in (
        "111.0 MHz of 2 seeds",
        "123.4 MHz",
        "2: 98.7",
        "1.90 ns",
        "2,400 of 24,288 (10%)",
        "an estimate",
        "90.1 MHz",
    ):
        assert text in result.stdout
    assert "engine.draining" in result.stdout


@pytest.mark.parametrize(("top", "name"), [("axi", "AXI"), ("framebuffer", "frame buffer")])
def test_tops_on_axi_have_no_estimate_of_a_virtex2(run, folder, routing, top, name):
    result = run("pnr", "--top", top)
    assert result.exit_code == 0, result.stderr
    assert routing[1][0][:2] == (DEFAULT, top)
    assert f"the {name} top, on LFE5U-25F" in result.stdout
    assert "estimate" not in result.stdout


@pytest.mark.parametrize(("command", "package"), [("pnr", "nextpnr_ecp5"), ("netlist", "yosys")])
def test_a_missing_tool_is_named_in_one_line(run, folder, routing, monkeypatch, command, package):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: package not in name or None)
    result = run(command)
    assert result.exit_code == 2
    assert result.stderr == (
        f"splatline: {command} needs yowasp_{package}: pip install '.[pnr]' in Splatline's folder\n"
    )
    assert not list(folder.iterdir())


@pytest.mark.parametrize(
    "arguments",
    [
        ("pnr", "--bitstream", "a.bin"),
        ("pnr", "--json", "absent/a.json"),
        ("pnr", "--seed", "-1"),
        ("pnr", "--freq", "0"),
        ("pnr", "--record", "--device", "LFE5U-85F"),
        ("netlist", "-o", "a.v"),
    ],
)
def test_what_cannot_be_done_is_refused_at_once(run, folder, routing, arguments):
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stderr.startswith("splatline: ")
    assert result.stderr.count("\n") == 1
    assert not routing[1]


def test_a_tool_that_fails_shows_its_log(run, folder, routing, monkeypatch):
    def fail(config, **options):
        raise ToolError("nextpnr failed:\nits log")

    monkeypatch.setattr(routing[0], "place_and_route", fail)
    result = run("pnr", "--json", "a.json")
    assert result.exit_code == 1
    assert result.stderr.endswith("splatline: nextpnr failed:\nits log\n")
    assert not list(folder.iterdir())


def test_netlist_writes_edif(run, folder, routing, monkeypatch):
    module = types.ModuleType("splatline.flow.netlist")
    module.pin_netlist = lambda config, progress: ("(edif splatline)\n", {"cells": {"a": {}}})
    monkeypatch.setitem(sys.modules, "splatline.flow.netlist", module)
    result = run("netlist")
    assert result.exit_code == 0, result.stderr
    assert (folder / "splatline_rgb24.edif").read_text() == "(edif splatline)\n"
    assert "1 cells" in result.stdout


def test_verilog_of_the_pins(run, folder):
    result = run("verilog", "--top", "pins", "-o", "top.v")
    assert result.exit_code == 0, result.stderr
    ports = {port["name"] for port in json.loads((folder / "top.json").read_text())["ports"]}
    assert {"words__payload", "initial__payload", "raster__payload"} <= ports


def test_record_keeps_the_clock(run, folder, routing, monkeypatch):
    monkeypatch.setattr("splatline.flow.timing.clocks.CLOCKS", folder / "clocks.json")
    assert run("pnr", "--tries", 2, "--record").exit_code == 0
    recorded = json.loads((folder / "clocks.json").read_text())
    assert recorded["paper"]["median_mhz"] == pytest.approx(111.0, abs=0.06)
    assert recorded["paper"]["seeds"] == [1, 2]
    assert run("pnr", "--top", "axi", "--record").exit_code == 0
    recorded = json.loads((folder / "clocks.json").read_text())
    command = "splatline pnr --preset paper --top axi --seed 1 --tries 2 --record"
    assert recorded["paper, axi"]["command"] == command
    assert (recorded["paper"]["low_mhz"], recorded["paper"]["high_mhz"]) == (98.7, 123.4)


def test_the_devices_are_those_that_have_sites():
    (option,) = (option for option in pnr.params if option.name == "device")
    assert list(option.type.choices) == [device.name[:9] for device in DEVICES]
