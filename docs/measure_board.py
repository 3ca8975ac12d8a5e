"""Simulate a whole board at 640 x 480, and look at every pixel of sixty refreshes.

Run as ``.venv/bin/python -m docs.measure_board [REFRESHES]`` after ``make test-board``, which
installs what it needs. A turntable of the built-in knot goes into the serial pins; what comes out
of the HDMI pins is decoded, and each refresh must be golden's picture of one frame, each frame in
its turn. Meanwhile the SDRAM is read and written by the screen, the engine and the player. It takes
some ten minutes of one processor.
"""

from __future__ import annotations

import itertools
import logging
import sys
import tempfile
import time
from pathlib import Path

from splatline.boards.board import Board
from splatline.boards.describe import describe
from splatline.boards.screen import SCREEN
from splatline.boards.simulated import BAUD, SimulatedSoC
from splatline.boards.uart_link import UartLink
from splatline.boards.verilog import system_files
from splatline.contract.presets import DEFAULT
from splatline.sim.cosim.board.board_device import SimulatedBoard, build_board
from splatline.sim.dvi.receiver import receive
from tests.support.board_frames import BACKGROUND, on_screen, turntable

FRAMES = 4
SIZE = (512, 512)
EVERY = 4
"""One point of the knot in so many is drawn, so that the upload is short."""

PART = 10
"""Refreshes of one record of the pins."""


def main() -> None:
    """Print a line for each record, and the figures of the run."""
    wanted = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    logging.disable(logging.INFO)
    frames = turntable(FRAMES, size=SIZE, every=EVERY, scale=0.8)
    words = [len(frame.codewords) for frame in frames]
    screen = (SCREEN["h_active"], SCREEN["v_active"])
    pictures = [on_screen(frame, screen) for frame in frames]
    soc = SimulatedSoC(DEFAULT, SCREEN)
    files = system_files(soc, DEFAULT)
    built = build_board({name: text for name, text in files.items() if not name.endswith(".lpf")})
    told = describe(soc)
    period = 1.0 / told["refresh_hz"]
    begin = time.process_time(), time.perf_counter()
    with (
        tempfile.TemporaryDirectory(prefix="splatline-") as scratch,
        SimulatedBoard(built, Path(scratch) / "pins", BAUD) as simulated,
    ):
        board = Board(UartLink(simulated), told, simulated.wait)
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
