"""A simulated board: its pins in a simulator process of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from splatline.sim.cosim import simulator
from splatline.sim.cosim.served import ServedSimulator
from splatline.sim.cosim.simulator import Build
from splatline.sim.dvi.receiver import unpack_pins

__all__ = ["SimulatedBoard", "build_board"]

HERE = Path(__file__).parent

RECORD_BITS, WORD_BYTES = 16, 8
"""Bits on the pins in a word of the record's file, and its bytes."""

TIMED = ("--timing", "-CFLAGS", "-std=c++20")
"""Verilator's options for delays, with which the bench makes its clocks."""

ANSWER_NS = 20_000_000
"""Longest time that the board may take for bytes on the serial link."""


def build_board(sources: Mapping[str, str], options: Sequence[str] = ()) -> Build:
    """Build the simulator of a board, or return its cached build.

    Parameters
    ----------
    sources
        Verilog texts by file name. One has the module ``board`` with the pins that
        ``board_bench.v`` connects.
    options
        Further arguments of Verilator.
    """
    bench = {name: (HERE / name).read_text() for name in ("board_bench.v", "primitives.v")}
    return simulator.build({**bench, **sources}, "board_bench", options=[*TIMED, *options])


class SimulatedBoard(ServedSimulator):
    """A board in a simulator; use it in a ``with``, or call :meth:`close`.

    :meth:`write` and :meth:`read` are those of a serial port.

    Parameters
    ----------
    built
        Result of :func:`build_board`.
    pins
        File for the record of the HDMI pins.
    baud
        Bits a second of the serial link.
    plusargs
        Arguments for the Verilog.
    """

    def __init__(
        self, built: Build, pins: Path, baud: int = 12_500_000, plusargs: Sequence[str] = ()
    ) -> None:
        self.pins = pins
        self._recorded = 0
        super().__init__(
            built,
            f"{__package__}.board_bench",
            plusargs=[f"+pins={pins}", *plusargs],
            environment={"SPLATLINE_BAUD": str(baud)},
        )

    def write(self, data: bytes) -> int:
        """Send bytes over the serial link."""
        self.command("write", bytes(data))
        return len(data)

    def read(self, size: int) -> bytes:
        """Return so many bytes from the serial link, or fewer if they do not come in time."""
        return bytes(self.command("read", size, ANSWER_NS))

    def reset_input_buffer(self) -> None:
        """Drop what was received: nothing is left over here."""

    def reset(self) -> None:
        """Press the reset button."""
        self.command("reset")

    def wait(self, seconds: float) -> None:
        """Let time pass on the board."""
        self.command("wait", round(seconds * 1e9))

    def watch(self, seconds: float) -> npt.NDArray[np.uint8]:
        """Record the HDMI pins for some time; return them as :func:`unpack_pins` does."""
        self.command("record", True)
        self.wait(seconds)
        begin = self._recorded
        self._recorded += self.command("record", False) // RECORD_BITS * WORD_BYTES
        with self.pins.open("rb") as file:
            file.seek(begin)
            return unpack_pins(np.frombuffer(file.read(self._recorded - begin), np.uint8))
