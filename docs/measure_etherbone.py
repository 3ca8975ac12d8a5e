"""Measure how fast code words go into a Colorlight's SDRAM over Etherbone, in simulation.

Run as ``.venv/bin/python -m docs.measure_etherbone`` after ``make test-board``, which installs what
it needs. Packets go in at the pins of RGMII, and the host takes no time: a real one adds its own to
each packet, and the cable's. Meanwhile the screen reads the SDRAM. It takes a minute or two.
"""

from __future__ import annotations

import logging
import tempfile
from pathlib import Path

import numpy as np

from splatline.boards.board import Board
from splatline.boards.colorlight import ADDRESS, PORT
from splatline.boards.describe import describe
from splatline.boards.etherbone_link import MOST_WORDS, EtherboneLink
from splatline.boards.simulated import SMALL, SimulatedSoC
from splatline.boards.verilog import system_files
from splatline.contract.presets import DEFAULT
from splatline.sim.cosim.board.board_device import RGMII, SimulatedBoard, build_board
from splatline.sim.cosim.board.network import BoardNetwork

PACKETS = 50


def main() -> None:
    """Print the rate of writes, each of which is read back in part."""
    logging.disable(logging.INFO)
    soc = SimulatedSoC(DEFAULT, SMALL, board="colorlight")
    files = system_files(soc)
    built = build_board({name: text for name, text in files.items() if name != "board.lpf"},
                        options=RGMII)  # fmt: skip
    told = describe(soc)
    half = 0.5e9 / told["clk_freq"]  # ns
    with (
        tempfile.TemporaryDirectory(prefix="splatline-") as scratch,
        SimulatedBoard(built, Path(scratch) / "pins", plusargs=[f"+sys_half={half:.3f}"]) as board,
    ):
        link = EtherboneLink(ADDRESS, PORT, BoardNetwork(board, ADDRESS))
        Board(link, told, board.wait).start()
        words = np.random.default_rng(1).integers(1 << 32, size=PACKETS * MOST_WORDS)
        place = told["main_ram"] + 0x10_0000
        before = board.time()
        link.write(place, words.astype(np.uint32))
        taken = board.time() - before
        assert (link.read(place, len(words)) == words).all()
    print(f"{PACKETS} packets of {4 * MOST_WORDS} bytes: {1e6 * taken / PACKETS:.1f} us each,"
          f" {4e-6 * len(words) / taken:.1f} MB/s")  # fmt: skip


if __name__ == "__main__":
    main()
