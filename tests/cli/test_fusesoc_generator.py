"""What FuseSoC's generator writes; `make fusesoc` runs FuseSoC itself, which is an extra."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

from splatline.cli import fusesoc_generator
from splatline.cli.commands.verilog_synth import verilog
from splatline.flow.tops import TOPS

ROOT = Path(__file__).parents[2]
CORE = yaml.safe_load((ROOT / "splatline.core").read_text().removeprefix("CAPI=2:"))


def generate(folder, **parameters):
    """Run the generator as FuseSoC does; return the files of its core."""
    given = folder / "input.yml"
    given.write_text(yaml.safe_dump({"parameters": parameters, "vlnv": "::splatline-x:0.1.0"}))
    script = ROOT / CORE["generators"]["splatline_verilog"]["command"]
    done = subprocess.run([sys.executable, script, given], cwd=folder, check=False)
    assert done.returncode == 0
    (path,) = folder.glob("*.core")
    core = yaml.safe_load(path.read_text().removeprefix("CAPI=2:"))
    assert core["name"] == "::splatline-x:0.1.0"
    assert core["targets"]["default"]["filesets"] == ["hardware"]
    files = {}
    for entry in core["filesets"]["hardware"]["files"]:
        files |= entry
    assert all((folder / name).is_file() for name in files)
    return files


def test_the_engine_comes_with_its_bench(tmp_path):
    files = generate(tmp_path, preset="paper", bench=True)
    assert {"splatline.v", "bench.v", "bench_sizes.vh", "raster.hex"} <= set(files)
    assert files["splatline.vlt"] == {"file_type": "vlt"}
    assert "lint_off" in (tmp_path / "splatline.vlt").read_text()
    assert files["bench_sizes.vh"]["is_include_file"]
    assert files["raster.hex"] == {"file_type": "user", "copyto": "raster.hex"}
    assert "module splatline(" in (tmp_path / "splatline.v").read_text()


def test_limits_of_an_ecp5_name_the_clock_of_the_top(tmp_path):
    for top, clock in {"pins": "clk", "axi": "aclk", "framebuffer": "aclk"}.items():
        folder = tmp_path / top
        folder.mkdir()
        fusesoc_generator._write_limits(folder, "dut", {"top": top, "ecp5_mhz": 80})
        limits = (folder / "dut.lpf").read_text()
        assert limits.splitlines()[-1] == f'FREQUENCY PORT "{clock}" 80 MHZ;'
        assert ("IOBUF" in limits) == (top == "pins")


def test_a_frame_buffer_may_have_simple_memories(tmp_path, monkeypatch):
    calls = []
    monkeypatch.setattr(subprocess, "run", lambda call, **_: calls.append(call))
    asked = {"preset": "paper", "top": "framebuffer", "memory": "simple", "name": "screen"}
    fusesoc_generator.generate(asked, "::x:0", tmp_path)
    (call,) = calls
    options = call[call.index("verilog") + 1 :]
    with verilog.make_context("verilog", options) as context:
        assert asked.items() <= {**context.params, "preset": context.params["preset"].name}.items()


def test_the_generator_documents_every_top_and_option():
    usage = CORE["generators"]["splatline_verilog"]["usage"]
    for text in (usage, fusesoc_generator.__doc__):
        assert all(each in text for each in (*TOPS, *fusesoc_generator.OPTIONS))


def test_lint_is_with_all_warnings():
    lints = [target for target in CORE["targets"].values() if target.get("flow") == "lint"]
    assert len(lints) == 2
    for target in lints:
        assert target["flow_options"] == {"tool": "verilator", "verilator_options": ["-Wall"]}


def test_parameters_that_are_refused_end_the_generator(tmp_path):
    with pytest.raises(subprocess.CalledProcessError):
        fusesoc_generator.generate({"preset": "no-such"}, "::x:0", tmp_path)


def test_the_core_is_of_this_version_and_its_targets_ask_for_what_there_is():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert CORE["name"] == f"::splatline:{version}"
    assert version in (ROOT / "Makefile").read_text().split("--target $$stage")[1].split("||")[0]
    for target in CORE["targets"].values():
        assert set(target.get("generate", ())) <= set(CORE["generate"])
    for asked in CORE["generate"].values():
        assert asked["generator"] in CORE["generators"]
