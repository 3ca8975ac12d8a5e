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

__all__ = ["MODELLED", "RGMII", "ULX3S", "SimulatedBoard", "build_board"]

HERE = Path(__file__).parent

MODELLED, ULX3S = "board_bench", "ulx3s_bench"
"""The benches."""

RGMII = ("+define+RGMII",)
"""Options of :func:`build_board` for a system whose link is Ethernet; ``MODELLED`` alone."""

PADS = ("+define+PAD_OUT=3.0", "+define+PAD_IN=2.0")
"""Delays of pins in the ULX3S bench, in ns, to the pin and from it. They are assumed. With the
chip's limits (tAC 5.4 ns, tOH 2.7 ns) LiteDRAM's PHY with its clock half a period behind takes the
right word for sums from 2.3 to 9.6 ns."""

RECORD_BITS, WORD_BYTES = 16, 8
"""Bits on the pins in a word of the record's file, and its bytes."""

TIMED = ("--timing", "-CFLAGS", "-std=c++20")
"""Verilator's options for delays, with which the bench makes its clocks."""

ANSWER_NS = 20_000_000
"""Longest time that the board may take for bytes on the serial link."""


def build_board(
    sources: Mapping[str, str], bench: str = MODELLED, options: Sequence[str] = ()
) -> Build:
    """Build the simulator of a board, or return its cached build.

    Parameters
    ----------
    sources
        Verilog texts by file name. One has the module ``board`` with the pins that the bench
        connects.
    bench
        ``MODELLED``: clocks and memory are the system's; ``ULX3S``: a ULX3S with its chips.
    options
        Further arguments of Verilator.
    """
    names = (f"{bench}.v", "primitives.v", *(["sdram_chip.v"] if bench == ULX3S else []))
    texts = {name: (HERE / name).read_text() for name in names}
    record = (HERE / "record_pins.vh").read_text()
    texts[f"{bench}.v"] = texts[f"{bench}.v"].replace('`include "record_pins.vh"', record)
    pads = PADS if bench == ULX3S else ()
    return simulator.build({**texts, **sources}, bench, options=[*TIMED, *pads, *options])


class SimulatedBoard(ServedSimulator):
    """A board in a simulator; use it in a ``with``, or call :meth:`close`.

    :meth:`write` and :meth:`read` are those of a serial port; Ethernet is
    :class:`splatline.sim.cosim.board.network.BoardNetwork`.

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

    def time(self) -> float:
        """Return how many seconds have passed on the board."""
        return self.command("time") * 1e-9

    def watch(self, seconds: float) -> npt.NDArray[np.uint8]:
        """Record the HDMI pins for some time; return them as :func:`unpack_pins` does."""
        self.command("record", True)
        self.wait(seconds)
        begin = self._recorded
        self._recorded += self.command("record", False) // RECORD_BITS * WORD_BYTES
        with self.pins.open("rb") as file:
            file.seek(begin)
            return unpack_pins(np.frombuffer(file.read(self._recorded - begin), np.uint8))
