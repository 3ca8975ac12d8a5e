"""The example SoC of ``examples/litex`` in Verilator, from the pins of its UART."""

import importlib.util
import json
import logging
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("litex", reason="pip install '.[board-test]'")

from litex.soc.integration.builder import Builder

from splatline.boards.uart_link import UartLink
from splatline.sim.cosim import simulator
from splatline.sim.cosim.board.board_device import TIMED, SimulatedBoard

FOLDER = Path(__file__).parents[2] / "examples" / "litex"
BAUD = 6_250_000
BENCH = """
`timescale 1ns / 1ps
module uart_bench (
    input rst, input serial_rx, output serial_tx, input record, output [31:0] bits
);
  reg clk = 0;
  always #20 clk = ~clk;
  assign bits = 0;
  radiona_ulx3s soc (.clk25(clk), .rst(rst), .serial_rx(serial_rx), .serial_tx(serial_tx));
endmodule
"""
"""The SoC with its clock, and the ports that the bench of boards wants."""

pytestmark = pytest.mark.board


def example(name):
    """Return a module of the example, which is no package."""
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    """The SoC's description, and its simulator."""
    logging.disable(logging.INFO)
    folder = tmp_path_factory.mktemp("soc")
    soc = example("picture_soc").PictureSoC(baud=BAUD)
    told = folder / "soc.json"
    builder = Builder(soc, output_dir=folder, csr_json=told, compile_software=False)
    builder.build(run=False)
    sources = {file.name: file.read_text() for file in (folder / "gateware").glob("*.v")}
    assert sorted(sources) == ["radiona_ulx3s.v", "splatline.v"]
    built = simulator.build({"bench.v": BENCH, **sources}, "uart_bench", options=TIMED)
    return json.loads(told.read_text()), built


@pytest.fixture
def link(system, tmp_path):
    with SimulatedBoard(system[1], tmp_path / "pins", BAUD) as simulated:
        yield UartLink(simulated)


def test_its_pictures_are_goldens(system, link, capsys):
    assert example("draw_picture").main(link, system[0]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 2
    assert all(line.endswith(", 0 unlike golden") for line in lines)


def test_a_word_that_is_lost_is_noticed(system, link, capsys, monkeypatch):
    draw = example("draw_picture")
    whole = draw.SocDevice.send

    def lose(self, words, initial):
        whole(self, np.delete(words, len(words) // 2), initial)

    monkeypatch.setattr(draw.SocDevice, "send", lose)
    assert draw.main(link, system[0]) == 1
    assert ", 0 unlike golden" not in capsys.readouterr().out
