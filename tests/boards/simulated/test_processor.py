"""A processor on a simulated board: its program runs, and reaches the engine's registers."""

import logging
import struct

import pytest

from splatline.boards.describe import describe
from splatline.boards.processor import PROCESSORS
from splatline.boards.simulated import BAUD, SMALL, SimulatedSoC
from splatline.boards.uart_link import UartLink
from splatline.boards.verilog import system_files
from splatline.contract.presets import RGB24
from splatline.contract.register_map import register_map
from splatline.sim.cosim.board.board_device import SimulatedBoard, build_board

pytestmark = pytest.mark.board

SECONDS = 50e-6
"""Time for a few instructions, of which serv takes some forty cycles for each."""


def program(source, target):
    """Return RISC-V code that copies a word from one address to another, and then waits."""

    def address(place, register):
        return (place + 0x800 & 0xFFFF_F000) | register << 7 | 0x37  # lui

    def low(place):
        return (place & 0xFFF ^ 0x800) - 0x800

    load = (low(source) & 0xFFF) << 20 | 12 << 15 | 2 << 12 | 11 << 7 | 0x03
    offset = low(target) & 0xFFF
    store = offset >> 5 << 25 | 11 << 20 | 10 << 15 | 2 << 12 | (offset & 31) << 7 | 0x23
    code = [address(source, 12), load, address(target, 10), store, 0x0000_006F]
    return struct.pack(f"<{len(code)}I", *code)


@pytest.mark.parametrize("cpu", PROCESSORS)
def test_a_program_copies_a_register_of_the_engine_to_one_of_the_board(cpu, tmp_path):
    pytest.importorskip(f"pythondata_cpu_{cpu}", reason="pip install '.[board-cpu]'")
    logging.disable(logging.INFO)
    idle = system(tmp_path, cpu)[0]
    identity = idle["engine"] + register_map(RGB24)["ID"].offset
    scratch = idle["registers"]["ctrl_scratch"]
    words = {}
    for name, code in (("idle", {}), ("copy", {"program": program(identity, scratch)})):
        told, files = system(tmp_path, cpu, **code)
        with SimulatedBoard(build_board(files), tmp_path / name, BAUD) as simulated:
            simulated.wait(SECONDS)
            (words[name],) = UartLink(simulated).read(told["registers"]["ctrl_scratch"], 1)
    assert words == {"idle": 0x1234_5678, "copy": 0x5350_4C54}


def system(folder, cpu, **code):
    """Return a system's description, and the files of its simulator."""
    soc = SimulatedSoC(RGB24, SMALL, cpu=cpu, **code)
    files = system_files(soc)
    del files["board.lpf"]
    for name in [name for name in files if not name.endswith(".v")]:
        (folder / name).write_text(files.pop(name))  # contents of a memory
        files["board.v"] = files["board.v"].replace(f'"{name}"', f'"{folder / name}"')
    return describe(soc), files
