"""What can be said of the Vivado example without Vivado."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from splatline.contract.presets import RGB24
from splatline.flow.axi_verilog import generate_axi

SCRIPT = Path(__file__).parents[2] / "examples" / "zynq" / "build.tcl"
TEXT = SCRIPT.read_text()
STUB = """
proc unknown args { puts [join $args]; return [join $args] }
set argv {xc7z020clg400-1 board}
source [lindex $argv0 0]
"""
"""Every command of Vivado prints itself."""


@pytest.fixture(scope="module")
def ports():
    """Width of each port of the AXI top."""
    return {port["name"]: port["width"] for port in generate_axi(RGB24, "x")[1]["ports"]}


def test_the_first_line_says_that_nobody_tried_it():
    assert TEXT.startswith("# UNTESTED: ")
    assert "UNTESTED" in (SCRIPT.parent / "README.md").read_text().splitlines()[0]


def test_every_port_that_is_connected_is_there(ports):
    named = set(re.findall(r"get_bd_pins splatline_0/(\w+)\]", TEXT))
    assert named == {"aclk", "aresetn", "irq"}
    assert named <= set(ports)
    buses = set(re.findall(r"get_bd_intf_pins splatline_0/(\w+)\]", TEXT))
    listed = set(re.search(r"ASSOCIATED_BUSIF (\S+)", TEXT)[1].split(":"))
    assert buses == listed - {"s_axis_initial"}
    there = {name.rpartition("_")[0] for name in ports} - {""}
    assert listed == there


def test_the_dma_is_as_wide_as_the_streams(ports):
    for parameter, port in {
        "c_m_axis_mm2s_tdata_width": "s_axis_codewords_tdata",
        "c_s_axis_s2mm_tdata_width": "m_axis_raster_tdata",
    }.items():
        assert int(re.search(rf"{parameter} (\d+)", TEXT)[1]) == ports[port]
    assert ports["s_axi_ctrl_awaddr"] == 14  # 16 KiB
    assert "-offset 0x43C00000 -range 16K [get_bd_addr_segs splatline_0" in TEXT


@pytest.mark.skipif(shutil.which("tclsh") is None, reason="no tclsh")
def test_tcl_parses_it(tmp_path):
    stub = tmp_path / "stub.tcl"
    stub.write_text(STUB.replace("[lindex $argv0 0]", str(SCRIPT)))
    done = subprocess.run(["tclsh", stub], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    commands = done.stdout.splitlines()
    assert "create_bd_design system" in commands
    assert commands[-1] == "wait_on_run impl_1"
    used = {line.split()[0] for line in commands}
    assert all(re.fullmatch(r"[a-z_]+", name) for name in used)
