"""The link over a serial port: LiteX's UARTBone."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

from .link import LinkError

__all__ = ["SerialPort", "UartLink", "open_serial"]

MOST_WORDS = 255
"""Words of a burst: its length is a byte."""

WRITE, READ = 0x01, 0x02
"""Commands: addresses of a burst go up by a word."""


class SerialPort(Protocol):
    """The used methods of pyserial's ``Serial``."""

    def write(self, data: bytes) -> int | None:
        """Send bytes."""

    def read(self, size: int) -> bytes:
        """Return so many bytes, or fewer if they do not come in time."""

    def reset_input_buffer(self) -> None:
        """Drop what was received."""


class UartLink:
    """Reads and writes words on a board's bus; a :class:`splatline.boards.link.Link`.

    A burst is the command, the number of words, the word address (32 bits) and the words, all with
    the highest byte first. Writes have no answer; the board takes a word in less time than the next
    one needs on the line. It forgets an incomplete burst after 0.1 s.

    Parameters
    ----------
    port
        An open serial port with a time limit for reads.
    """

    def __init__(self, port: SerialPort) -> None:
        self.port = port

    def read(self, address: int, count: int = 1) -> npt.NDArray[np.uint32]:
        """Return words from an address on, a multiple of 4: shape (count,), uint32."""
        self.port.reset_input_buffer()
        words = np.empty(count, np.uint32)
        for begin in range(0, count, MOST_WORDS):
            size = min(MOST_WORDS, count - begin)
            self.port.write(_head(READ, size, address + 4 * begin))
            data = self.port.read(4 * size)
            if len(data) != 4 * size:
                raise LinkError(
                    f"the board does not answer: {len(data)} of {4 * size} bytes came from"
                    f" {address + 4 * begin:#x}"
                )
            words[begin : begin + size] = np.frombuffer(data, ">u4")
        return words

    def write(self, address: int, words: npt.NDArray[np.uint32]) -> None:
        """Write words from an address on, a multiple of 4: shape (n,), uint32."""
        for begin in range(0, len(words), MOST_WORDS):
            part = words[begin : begin + MOST_WORDS]
            self.port.write(
                _head(WRITE, len(part), address + 4 * begin) + part.astype(">u4").tobytes()
            )


def _head(command: int, count: int, address: int) -> bytes:
    return bytes([command, count]) + (address // 4).to_bytes(4, "big")


def open_serial(name: str, baud: int) -> UartLink:
    """Open a serial port, such as ``/dev/ttyUSB0`` or a URL of pyserial.

    Raises
    ------
    LinkError
        If it cannot be opened.
    """
    import serial

    try:
        return UartLink(serial.serial_for_url(name, baud, timeout=1.0))
    except (OSError, ValueError) as error:
        raise LinkError(f"the serial port {name} cannot be opened: {error}") from error
