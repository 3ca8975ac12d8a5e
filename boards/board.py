"""The driver of a board: starts its memory, uploads frames, plays them on the screen."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.contract.frame import Frame, check_codewords
from splatline.contract.presets import get_preset
from splatline.host.device.driver import Driver

from .link import Link

__all__ = ["Board"]

PIXEL_BYTES = 4
"""Bytes of a pixel in memory."""

BUFFER_ALIGNMENT = 4096
"""Buffers begin at multiples of so many bytes."""

LOOKS = 20
"""Refreshes in which a frame must end that is drawn."""

TRIES = 5
"""Times that a register is written before the board counts as broken."""

PULSES = ("sdram_dfii_pi0_command_issue",)
"""Registers that do something when they are written, and read as 0."""

CHUNK = 255 * 16
"""32-bit words between two calls of ``progress``."""


class _Registers:
    """An engine's registers behind a link."""

    def __init__(self, link: Link, base: int) -> None:
        self.link, self.base = link, base

    def read32(self, offset: int) -> int:
        """Return a register."""
        return int(self.link.read(self.base + offset)[0])

    def write32(self, offset: int, value: int) -> None:
        """Write a register."""
        self.write_words(offset, np.array([value], np.uint32))

    def write_words(self, offset: int, words: npt.NDArray[np.uint32]) -> None:
        """Write registers that follow each other."""
        self.link.write(self.base + offset, words)


class Board:
    """A board with an engine, or a simulation of one.

    >>> board = Board(open_serial("/dev/ttyUSB0", 3_000_000), description)
    ... board.start()
    ... board.upload(frames)
    ... board.play()

    Parameters
    ----------
    link
        The link to it.
    description
        That of its system (:func:`splatline.boards.describe.describe`), which lies beside its
        bitstream.
    wait
        Waits for so many seconds; a simulation lets its own time pass.
    """

    def __init__(
        self,
        link: Link,
        description: dict[str, Any],
        wait: Callable[[float], None] = time.sleep,
    ) -> None:
        self.link, self.told, self.wait = link, description, wait
        self.config = get_preset(description["preset"])
        self.engine: Driver | None = None

    def get(self, name: str) -> int:
        """Return one of LiteX's registers."""
        return int(self.link.read(self.told["registers"][name])[0])

    def set(self, name: str, value: int) -> None:
        """Write one of LiteX's registers; again if it does not keep the value.

        A link may lose what it sends, but for :data:`PULSES` each of them can be read.

        Raises
        ------
        InputError
            If it never does.
        """
        for _ in range(TRIES):
            self.link.write(self.told["registers"][name], np.array([value], np.uint32))
            if name in PULSES or self.get(name) == value:
                return
        raise InputError(f"the board's register {name} does not keep what is written")

    def start(self) -> None:
        """Check the link and the engine, and start the SDRAM. The screen shows background.

        Raises
        ------
        InputError
            If the board does not answer, has another bitstream, or its SDRAM does not work.
        """
        for value in (0x5A5A_C3C3, 0x1234_5678):
            self.set("ctrl_scratch", value)
        engine = Driver(_Registers(self.link, self.told["engine"]))
        if engine.config != self.config:
            raise InputError(
                f"the board has preset {engine.config.name}, and its description says"
                f" {self.config.name}"
            )
        self.stop()
        self._start_sdram()
        self.engine = engine

    def _start_sdram(self) -> None:
        """Send LiteDRAM's sequence of commands to the chips, and test a few words."""
        self.set("sdram_dfii_control", 0x0E)  # the host has the chips; clock enable is high
        for kind, address, bank, value, cycles in self.told["sdram_init"]:
            self.set("sdram_dfii_pi0_address", address)
            self.set("sdram_dfii_pi0_baddress", bank)
            if kind == "control":
                self.set("sdram_dfii_control", value)
            else:
                self.set("sdram_dfii_pi0_command", value)
                self.set("sdram_dfii_pi0_command_issue", 1)
            if cycles:
                self.wait(cycles / self.told["clk_freq"])
        self.set("sdram_dfii_control", 0x01)  # the controller has them
        size = self.told["main_ram_bytes"]
        places = [0, *(1 << n for n in range(2, (size - 1).bit_length()))]
        values = np.random.default_rng(1).integers(1 << 32, size=len(places), dtype=np.uint32)
        for place, value in zip(places, values, strict=True):
            self.link.write(self.told["main_ram"] + place, value[None])
        got = [int(self.link.read(self.told["main_ram"] + place)[0]) for place in places]
        wrong = [p for p, g, v in zip(places, got, values.tolist(), strict=True) if g != v]
        if wrong:
            raise InputError(f"the board's SDRAM does not keep what is written at {wrong[0]:#x}")

    def stop(self) -> None:
        """End after the frame that is drawn; its picture stays on the screen.

        Raises
        ------
        InputError
            If the frame does not end.
        """
        self.set("player_enable", 0)
        for _ in range(LOOKS):
            if not self.get("player_busy"):
                return
            self.wait(1 / self.told["refresh_hz"])
        raise InputError("the board's engine does not end its frame; reset the board")

    def upload(
        self,
        frames: Sequence[Frame],
        background: tuple[int, int, int] = (0, 0, 0),
        progress: Callable[[float], None] | None = None,
    ) -> None:
        """Send frames to the board's SDRAM, and the tables to its engine.

        Parameters
        ----------
        frames
            Frames of one size, with the same tables, for the board's preset.
        background
            Red, green and blue, 0..255.
        progress
            Called with the share that is sent.

        Raises
        ------
        InputError
            If they do not fit together, or not into the board.
        """
        if self.engine is None:
            self.start()
        assert self.engine is not None
        first = self._check(frames)
        self.stop()
        self.set("scanout_enable", 0)
        self.engine.write_tables(first.tables, first.width, first.height)
        self._place_picture(first.width, first.height, background)
        words = [np.ascontiguousarray(f.codewords, "<u8").view(np.uint32).ravel() for f in frames]
        place = self._first_free(first.width, first.height)
        total, sent = sum(len(part) for part in words), 0
        entries = np.zeros((len(frames), 2), np.uint32)
        for number, part in enumerate(words):
            entries[number] = place, len(part)
            for begin in range(0, len(part), CHUNK):
                chunk = part[begin : begin + CHUNK]
                self.link.write(self.told["main_ram"] + place + 4 * begin, chunk)
                sent += len(chunk)
                if progress is not None:
                    progress(sent / total)
            place += 4 * len(part)
        self.link.write(self.told["frame_list"], entries.ravel())
        self.set("player_frames", len(frames))
        self.set("scanout_enable", 1)

    def play(self, *, loop: bool = True, hold: int = 0) -> None:
        """Show the frames that were uploaded, from the first one on.

        Parameters
        ----------
        loop
            Begin again after the last one.
        hold
            Refreshes that pass after a picture is shown before the next one is begun: 0 gives a
            frame a refresh, 1 every other refresh, if the engine is as fast.
        """
        self.stop()
        self.set("player_loop", int(loop))
        self.set("player_hold", hold)
        self.set("player_enable", 1)

    def counters(self) -> dict[str, int]:
        """Return refreshes, swaps, underruns and frames played, each since the board's reset."""
        names = {
            "refreshes": "scanout_refreshes", "swaps": "scanout_swaps",
            "underruns": "scanout_underruns", "played": "player_played",
            "writer_error": "engine_writer_error",
        }  # fmt: skip
        return {name: self.get(register) for name, register in names.items()}

    def _check(self, frames: Sequence[Frame]) -> Frame:
        """Raise ``InputError`` unless frames fit together and into the board; return the first."""
        if not frames:
            raise InputError("there is no frame to play")
        most = self.told["most_frames"]
        if len(frames) > most:
            raise InputError(f"the board's list holds {most} frames, not {len(frames)}")
        first = frames[0]
        for number, frame in enumerate(frames, 1):
            if frame.config != self.config:
                raise InputError(
                    f"frame {number} is for preset {frame.config.name}, and the board has"
                    f" {self.config.name}"
                )
            check_codewords(frame.codewords, self.config)
            if (frame.width, frame.height) != (first.width, first.height):
                raise InputError(f"frame {number} has another size than the first")
            if any(
                (getattr(frame.tables, name) != getattr(first.tables, name)).any()
                for name in ("ambient", "diffuse", "specular")
            ):
                raise InputError(f"frame {number} has other tables than the first")
        words = sum(frame.codewords.nbytes for frame in frames)
        room = self.told["main_ram_bytes"] - self._first_free(first.width, first.height)
        if words > room:
            raise InputError(f"the frames have {words} bytes, and the board has room for {room}")
        return first

    def _buffer_bytes(self, width: int, height: int) -> int:
        return -(-PIXEL_BYTES * width * height // BUFFER_ALIGNMENT) * BUFFER_ALIGNMENT

    def _first_free(self, width: int, height: int) -> int:
        """Return where code words begin: behind both buffers."""
        return 2 * self._buffer_bytes(width, height)

    def _place_picture(self, width: int, height: int, background: tuple[int, int, int]) -> None:
        """Set the buffers, and put the picture in the screen's middle, cut off evenly."""
        columns, lines = (
            min(size, most) for size, most in zip((width, height), self.told["screen"], strict=True)
        )
        cut_left, cut_top = (width - columns) // 2, (height - lines) // 2
        red, green, blue = background
        for name, value in {
            "left": (self.told["screen"][0] - columns) // 2,
            "top": (self.told["screen"][1] - lines) // 2,
            "columns": columns,
            "lines": lines,
            "stride": PIXEL_BYTES * width,
            "offset": PIXEL_BYTES * (cut_top * width + cut_left),
            "buffer_0": 0,
            "buffer_1": self._buffer_bytes(width, height),
            "background": red | green << 8 | blue << 16,
        }.items():
            self.set(f"scanout_{name}", value)
