import shutil
import subprocess
import sys

import pytest

from splatline.flow.plain_tools import write_tools

TEMPLATE = """\
proc read_files {} {
read_verilog {top.v}
}
yosys -import
set top top
read_files
hierarchy -top $top
write_json top.json
"""
"""As edalize writes it."""


def test_every_tool_says_its_version(tmp_path):
    write_tools(tmp_path)
    assert {"yosys", "nextpnr-ecp5", "ecppack", "verilator"} == {
        tool.name for tool in tmp_path.iterdir()
    }
    for name in ("yosys", "verilator"):
        done = subprocess.run([tmp_path / name, "--version"], capture_output=True, check=False)
        assert done.returncode == 0, done.stderr
    for name in ("nextpnr-ecp5", "ecppack"):
        program = (tmp_path / name).read_text().split()[2]
        assert shutil.which(program)
    assert (tmp_path / "yosys").read_text().startswith(f"#!{sys.executable}\n")


@pytest.mark.skipif(shutil.which("tclsh") is None, reason="no tclsh")
def test_yosys_runs_a_tcl_file(tmp_path):
    write_tools(tmp_path / "tools")
    (tmp_path / "top.v").write_text("module top(input a, output b); assign b = a; endmodule\n")
    (tmp_path / "synth.tcl").write_text(TEMPLATE)
    command = [tmp_path / "tools" / "yosys", "-q", "-p", "tcl synth.tcl"]
    subprocess.run(command, cwd=tmp_path, check=True)
    assert '"top"' in (tmp_path / "top.json").read_text()


def test_without_tclsh_a_line_says_what_to_install(tmp_path):
    write_tools(tmp_path)
    command = [tmp_path / "yosys", "-p", "tcl synth.tcl"]
    done = subprocess.run(command, env={"PATH": ""}, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.splitlines() == [
        "tclsh is missing, which edalize's script for Yosys needs; install tcl"
    ]
