"""A system's Verilog."""

import logging
import re

import pytest

from splatline.contract.presets import RGB24

pytest.importorskip("litex", reason="pip install '.[board-test]'")

from splatline.boards.catalog import make_system
from splatline.boards.describe import describe
from splatline.boards.processor import processor_options
from splatline.boards.simulated import SMALL, SimulatedSoC
from splatline.boards.verilog import system_files

MODULES = {"serv": ("serv_rf_top", "serv_rf_top.v"), "vexriscv": ("VexRiscv", "VexRiscv_Min.v")}
"""A processor's module, and its file."""


def test_it_says_nothing_of_when_and_where_it_was_made():
    logging.disable(logging.INFO)
    text = system_files(SimulatedSoC(RGB24, SMALL))["board.v"]
    assert not re.findall(r"[0-9]{4}-[0-9]{2}-[0-9]{2}|sha1|[0-9]{2}:[0-9]{2}:[0-9]{2}", text)


@pytest.mark.parametrize("cpu", ["serv", "vexriscv"])
def test_a_processor_and_its_program_are_in_it(cpu):
    pytest.importorskip(f"pythondata_cpu_{cpu}")
    soc = make_system("ulx3s", RGB24, cpu, program=b"\x13\x00\x00\x00\x6f")
    files = system_files(soc)
    top, source = {
        "serv": ("serv_rf_top", "serv_rf_top.v"),
        "vexriscv": ("VexRiscv", "VexRiscv_Min.v"),
    }[cpu]
    assert len(re.findall(rf"^(?:\) )?{top}\b.*\($", files["board.v"], re.MULTILINE)) >= 1
    assert re.search(rf"^module {top}\b", files[source], re.MULTILINE)
    assert files["board_rom.init"].split() == ["00000013", "0000006f"]
    told = describe(soc)
    assert told["engine"] == 0xF002_0000
    assert min(told["registers"].values()) >= 0x8000_0000


def test_without_a_processor_there_is_none():
    files = system_files(make_system("ulx3s", RGB24))
    assert sorted(files) == ["board.lpf", "board.v", "splatline.v"]


def test_a_program_that_is_too_long_is_refused():
    with pytest.raises(ValueError, match="the ROM has 8192"):
        processor_options("serv", bytes(8193))
