"""Simulate a whole board at 640 x 480, and look at every pixel of sixty refreshes.

Run as ``.venv/bin/python -m docs.measure_board [ulx3s|colorlight] [REFRESHES]`` after
``make test-board``, which installs what it needs. A turntable of the built-in knot goes into the
serial pins or those of RGMII; what comes out of the HDMI pins is decoded, and each refresh must be
golden's picture of one frame, each frame in its turn. Meanwhile the SDRAM is read and written by
the screen, the engine and the player. It takes some ten minutes of one processor.
"""

from __future__ import annotations

import contextlib
import itertools
import logging
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from splatline.boards.board import Board
from splatline.boards.colorlight import ADDRESS, PORT
from splatline.boards.describe import describe
from splatline.boards.etherbone_link import EtherboneLink
from splatline.boards.link import Link
from splatline.boards.screen import SCREEN
from splatline.boards.simulated import BAUD, BOARDS, SimulatedSoC
from splatline.boards.uart_link import UartLink
from splatline.boards.verilog import system_files
from splatline.contract.presets import DEFAULT
from splatline.sim.cosim.board.board_device import RGMII, SimulatedBoard, build_board
from splatline.sim.cosim.board.network import BoardNetwork
from splatline.sim.dvi.receiver import receive
from tests.support.board_frames import BACKGROUND, on_screen, turntable

FRAMES = 4
SIZE = (512, 512)
EVERY = 4
"""One point of the knot in so many is drawn, so that the upload is short."""

PART = 10
"""Refreshes of one record of the pins."""


@contextlib.contextmanager
def simulated_board(board: str) -> Iterator[tuple[SimulatedBoard, Link, dict]]:
    """Build a board and start its simulator; yield it, its link and its description."""
    soc = SimulatedSoC(DEFAULT, SCREEN, board=board)
    files = system_files(soc)
    del files["board.lpf"]
    ethernet = board == "colorlight"
    built = build_board(files, options=RGMII if ethernet else ())
    told = describe(soc)
    half = 0.5e9 / told["clk_freq"]  # ns
    with (
        tempfile.TemporaryDirectory(prefix="splatline-") as scratch,
        SimulatedBoard(
            built, Path(scratch) / "pins", BAUD, plusargs=[f"+sys_half={half:.3f}"]
        ) as simulated,
    ):
        if ethernet:
            yield simulated, EtherboneLink(ADDRESS, PORT, BoardNetwork(simulated, ADDRESS)), told
        else:
            yield simulated, UartLink(simulated), told


def main() -> None:
    """Print a line for each record, and the figures of the run."""
    chosen = sys.argv[1] if len(sys.argv) > 1 else BOARDS[0]
    wanted = int(sys.argv[2]) if len(sys.argv) > 2 else 60
    logging.disable(logging.INFO)
    frames = turntable(FRAMES, size=SIZE, every=EVERY, scale=0.8)
    words = [len(frame.codewords) for frame in frames]
    screen = (SCREEN["h_active"], SCREEN["v_active"])
    pictures = [on_screen(frame, screen) for frame in frames]
    begin = time.process_time(), time.perf_counter()
    with simulated_board(chosen) as (simulated, link, told):
        period = 1.0 / told["refresh_hz"]
        board = Board(link, told, simulated.wait)
        board.start()
        board.upload(frames, BACKGROUND)
        print(
            f"{words} code words uploaded after {time.perf_counter() - begin[1]:.0f} s", flush=True
        )
        board.play()
        simulated.wait(2 * period)
        whole = steps = unlike = 0
        while whole < wanted:
            seen = receive(simulated.watch((PART + 1.02) * period))
            shown = [
                next((n for n, picture in enumerate(pictures) if (refresh == picture).all()), -1)
                for refresh in seen.pictures
            ]
            whole += len(shown)
            unlike += shown.count(-1)
            steps += sum((a + 1) % FRAMES == b for a, b in itertools.pairwise(shown))
            print(f"refreshes {whole}: {shown}, skew {seen.skew}", flush=True)
        counters = board.counters()
        assert board.engine is not None
        engine = board.engine.counters()
    print(f"refreshes that are no picture of golden: {unlike} of {whole}")
    print(f"refreshes with the frame after that of the refresh before: {steps}")
    print(f"the board's counters: {counters}")
    print(f"the engine's counters: {engine}")
    print(f"wall time: {time.perf_counter() - begin[1]:.0f} s")


if __name__ == "__main__":
    main()
