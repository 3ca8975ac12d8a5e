import json
import re
import sys
import types

import pytest
from PIL import Image

from splatline.contract.presets import DEFAULT
from splatline.flow.area import budgets
from splatline.flow.tools import ToolError

REPORT = {
    "preset": "paper",
    "top": "engine",
    "command": "synth_xilinx",
    "fits": True,
    "lut4": 2000,
    "ff": 900,
    "bram": 17,
    "mult": 6,
    "paper": {"lut4": 2150, "ff": 960, "bram": 17},
    "device": {"name": "XC2V250", "lut4": 3072, "ff": 3072, "bram": 24, "mult": 24},
    "smallest_devices": {"Virtex-II": "XC2V250", "Artix-7": None},
    "difference": {
        "lut4": {"absolute": -150, "percent": -7.0},
        "ff": {"absolute": -60, "percent": -6.2},
        "bram": {"absolute": 0, "percent": 0.0},
    },
    "budget": {"lut4": 2000, "ff": 900, "bram": 17, "mult": 6},
    "over_budget": {},
    "longest_path": {
        "levels": 17, "luts": 15, "carries": 13, "multipliers": 0,
        "start": "window.oldest[0]", "end": "clock enable of decoder.held[3]",
    },
    "modules": {"(top)": {"lut4": 2000, "ff": 900, "bram": 17, "mult": 6}},
    "groups": [
        {"name": "(top)", "instances": 1, "lut4": 1016, "ff": 788, "bram": 1, "mult": 6},
        {"name": "window.lane_0..7", "instances": 8, "lut4": 984, "ff": 112, "bram": 16, "mult": 0},
    ],
}  # fmt: skip


@pytest.fixture
def synthesis(monkeypatch):
    """Puts a synthesis in place that takes no time; what it returns can be changed."""
    report = dict(REPORT)
    asked = []
    module = types.ModuleType("splatline.flow.area.synth")
    module.synthesise = lambda config, *, top, progress: asked.append((config, top)) or report
    monkeypatch.setitem(sys.modules, "splatline.flow.area.synth", module)
    return report, asked


def test_verilog_comes_with_its_description(run, folder):
    result = run("verilog", "-o", "engine.v")
    assert result.exit_code == 0, result.stderr
    text = (folder / "engine.v").read_text()
    description = json.loads((folder / "engine.json").read_text())
    assert f"module {description['top']}(" in text
    assert description["config"]["name"] == "rgb24"
    assert {"clk", "rst"} <= {port["name"] for port in description["ports"]}
    assert sorted(path.name for path in folder.iterdir()) == ["engine.json", "engine.v"]


def test_the_verilog_on_axi_comes_with_its_registers(run, folder):
    result = run("verilog", "--top", "axi", "-o", "top.v")
    assert result.exit_code == 0, result.stderr
    text, description = (folder / "top.v").read_text(), (folder / "top.json").read_text()
    description = json.loads(description)
    for port in description["ports"]:
        width = f"[{port['width'] - 1}:0] " if port["width"] > 1 else ""
        assert f"  {port['direction']} {width}{port['name']};" in text
        assert port["meaning"]
    names = {port["name"] for port in description["ports"]}
    assert {"aclk", "aresetn", "irq", "s_axi_ctrl_awaddr", "m_axis_raster_tlast"} <= names
    assert description["registers"]["registers"][0]["name"] == "ID"
    assert description["latency"]["codeword_to_memory_cycles"] == 5


def test_the_verilog_on_axi_of_an_engine_with_planes_takes_words_of_16_bytes(run, folder):
    result = run("verilog", "--preset", "plane", "--top", "axi", "-o", "top.v")
    assert result.exit_code == 0, result.stderr
    description = json.loads((folder / "top.json").read_text())
    widths = {port["name"]: port["width"] for port in description["ports"]}
    assert (widths["s_axis_codewords_tdata"], widths["s_axis_codewords_tkeep"]) == (128, 16)
    assert (widths["m_axis_raster_tdata"], widths["s_axis_initial_tdata"]) == (256, 256)
    assert description["codeword"]["bits"] == 96


@pytest.mark.parametrize(
    ("options", "top"),
    [
        ("", "splatline_rgb24"),
        ("--preset paper-rom --top axi", "splatline_paper_rom_axi"),
        ("--preset paper --top pins", "splatline_paper_pins"),
        ("--engines 2", "splatline_rgb24_chain2"),
        ("--engines 2 --name painter", "painter"),
    ],
)
def test_all_modules_begin_with_the_name_of_the_top(run, folder, options, top):
    result = run("verilog", *options.split(), "-o", "engine.v")
    assert result.exit_code == 0, result.stderr
    assert json.loads((folder / "engine.json").read_text())["top"] == top
    names = re.findall(r"^module (\w+)\(", (folder / "engine.v").read_text(), re.MULTILINE)
    assert names[0] == top
    assert all(name.startswith(f"{top}_") for name in names[1:])


@pytest.mark.parametrize("name", ["module", "2nd", "a-b", "a b", "logic", ""])
def test_a_name_that_verilog_does_not_take_is_refused(run, folder, name):
    result = run("verilog", "--name", name, "-o", "engine.v")
    assert result.exit_code == 2
    assert result.stderr.startswith("splatline: ")
    assert result.stderr.count("\n") == 1
    assert not list(folder.iterdir())


@pytest.mark.parametrize("output", ["engine.vhd", "absent/engine.v", "engine.json"])
def test_verilog_that_cannot_be_written_is_refused_at_once(run, folder, output):
    result = run("verilog", "-o", output)
    assert result.exit_code == 2
    assert result.stderr.startswith("splatline: ")
    assert result.stderr.count("\n") == 1
    assert not list(folder.iterdir())


def test_the_rom_s_contents_go_into_files_that_the_verilog_reads(run, folder):
    result = run("verilog", "--preset", "paper-rom", "--readmemh", "rom", "-o", "engine.v")
    assert result.exit_code == 0, result.stderr
    text = (folder / "engine.v").read_text()
    for name, words in (("numbers", 6144), ("shapes", 293)):
        assert text.count(f'$readmemh("rom/{name}.hex", {name});') == 1
        assert f"{name}[0] =" not in text
        assert len((folder / "rom" / f"{name}.hex").read_text().split()) == words


def test_a_preset_without_a_rom_has_no_contents_to_write(run, folder):
    result = run("verilog", "--readmemh", "rom")
    assert result.exit_code == 2
    assert "rgb24 has no shape ROM" in result.stderr
    assert not list(folder.iterdir())


def test_synth_writes_the_report_and_prints_the_table(run, folder, synthesis):
    result = run("synth", "--json", "report.json")
    assert result.exit_code == 0, result.stderr
    assert synthesis[1] == [(DEFAULT, "engine")]
    assert json.loads((folder / "report.json").read_text()) == REPORT
    luts = next(line for line in result.stdout.splitlines() if "4-input LUTs" in line)
    for cell in ("2,000 (65%)", "2,150", "-150 (-7%)", "3,072"):
        assert cell in luts
    lanes = next(line for line in result.stdout.splitlines() if "window.lane_0..7" in line)
    assert [cell for cell in lanes.split() if cell.isdigit()] == ["8", "984", "112", "16", "0"]
    assert "17 levels (15 LUTs, 13 carries;" in result.stdout
    assert "to   clock enable of decoder.held[3]" in result.stdout


def test_synth_draws_what_each_module_takes(run, folder, synthesis):
    result = run("synth", "--plot", "modules.png")
    assert result.exit_code == 0, result.stderr
    with Image.open(folder / "modules.png") as picture:
        assert picture.format == "PNG"
        assert picture.width > 1000


def test_a_plot_of_another_format_is_refused(run, folder, synthesis):
    result = run("synth", "--plot", "modules.svg")
    assert result.exit_code == 2
    assert result.stderr.splitlines()[-1].startswith("splatline: modules.svg: the name must end in")
    assert not list(folder.iterdir())


def test_synth_fails_over_budget_until_the_counts_are_recorded(
    run, synthesis, tmp_path, monkeypatch
):
    book = tmp_path / "budgets.json"
    monkeypatch.setattr(budgets, "BUDGETS", book)
    synthesis[0].update(budget={"lut4": 1990}, over_budget={"lut4": 10})
    result = run("synth")
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1] == (
        "splatline: rgb24 is over its budget: 2,000 4-input LUTs, 10 more than recorded"
        " (--record accepts it)"
    )
    assert not book.exists()
    result = run("synth", "--record")
    assert result.exit_code == 0, result.stderr
    counts = {"lut4": 2000, "ff": 900, "bram": 17, "mult": 6}
    assert budgets.read_budgets() == {"rgb24": counts}
    result = run("synth", "--top", "pins", "--record")
    assert result.exit_code == 0, result.stderr
    assert budgets.read_budgets() == {"rgb24": counts, "rgb24, pins": counts}
    assert synthesis[1][-1] == (DEFAULT, "pins")


def test_synth_fails_where_the_engine_does_not_fit(run, synthesis):
    synthesis[0]["fits"] = False
    result = run("synth")
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1] == "splatline: the engine does not fit XC2V250"


def test_synth_without_yosys_says_what_to_install(run, folder, synthesis, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    result = run("synth", "--json", "report.json")
    assert result.exit_code == 2
    assert "'.[synth]'" in result.stderr.splitlines()[-1]
    assert not list(folder.iterdir())


def test_a_yosys_that_fails_shows_its_log_without_a_traceback(run, folder, synthesis, monkeypatch):
    def fail(config, *, top, progress):
        raise ToolError("Yosys failed:\nits log")

    monkeypatch.setattr(sys.modules["splatline.flow.area.synth"], "synthesise", fail)
    result = run("synth", "--json", "report.json")
    assert result.exit_code == 1
    assert result.stderr.endswith("splatline: Yosys failed:\nits log\n")
    assert not list(folder.iterdir())


def test_verilog_has_simple_memories_where_they_are_asked_for(run, folder):
    result = run("verilog", "--preset", "paper", "--memory", "simple")
    assert result.exit_code == 0, result.stderr
    description = json.loads((folder / "splatline_paper-simple.json").read_text())
    assert description["top"] == "splatline_paper_simple"
    assert description["config"]["memory"] == "simple"


@pytest.mark.parametrize("command", ["verilog", "synth"])
def test_an_engine_of_blocks_has_no_simple_memories(run, folder, command):
    result = run(command, "--preset", "swift", "--memory", "simple")
    assert result.exit_code == 2
    assert result.stderr.splitlines()[-1] == (
        "splatline: preset swift: memory must be dual with blocks, not 'simple'"
    )
    assert not list(folder.glob("*.v"))
