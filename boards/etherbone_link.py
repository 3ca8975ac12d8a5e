"""The link over Ethernet: LiteEth's Etherbone, 32-bit words in UDP packets."""

from __future__ import annotations

import contextlib
import socket
from typing import Protocol

import numpy as np
import numpy.typing as npt

from .link import LinkError
from .memory_map import MAIN_RAM

__all__ = ["Datagrams", "EtherboneLink", "open_udp"]

MOST_WORDS = 240
"""Words of a packet: the board's buffer holds 256 with its addresses."""

HEAD = bytes([0x4E, 0x6F, 0x10, 0x44, 0, 0, 0, 0])
"""Magic number, version 1, addresses and words of 4 bytes."""

PROBE = bytes([0x4E, 0x6F, 0x11, 0x44, 0, 0, 0, 0]) + bytes(4)
"""A packet that every Etherbone device answers."""

PROBED = 0x02
"""Bit of the third byte of the answer."""

ALL_BYTES = 0x0F

TRIES = 5
"""Times that a packet is sent before the board counts as silent."""

SECONDS = 0.3
"""Longest time for an answer."""

RAM_END = 2 * MAIN_RAM
"""No SDRAM is larger. Registers are below it, or above in a system with a processor."""

SCRATCH = 4
"""Address of a register that can be read without effect, in a system without a processor."""


class Datagrams(Protocol):
    """The used methods of a UDP socket with a time limit."""

    def sendto(self, data: bytes, peer: tuple[str, int], /) -> int:
        """Send a datagram."""

    def recv(self, size: int, /) -> bytes:
        """Return a datagram; raise ``TimeoutError`` if none comes in time."""

    def close(self) -> None:
        """Close it."""


def open_udp(port: int, local: str = "") -> socket.socket:
    """Open this machine's end of the link.

    LiteEth answers to the board's own port number, whatever port the question came from.

    Parameters
    ----------
    port
        UDP port of the board, and so of this machine.
    local
        IP address of the interface; without it all of them listen.

    Raises
    ------
    LinkError
        If the port is taken.
    """
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    opened.settimeout(SECONDS)
    try:
        opened.bind((local, port))
    except OSError as error:
        opened.close()
        raise LinkError(f"UDP port {port} of this machine cannot be opened: {error}") from error
    return opened


class EtherboneLink:
    """Reads and writes words on a board's bus; a :class:`splatline.boards.link.Link`.

    UDP may lose packets. A read whose answer is lost is sent again. After each packet of writes one
    word is read, so that the board is never sent more than it can hold: in SDRAM the last one
    written, which tells that the packet came, or else it is sent again.

    Parameters
    ----------
    address, port
        The board's IP address and UDP port.
    udp
        This machine's end; without it it is opened by :func:`open_udp`. A simulation has its own.
    scratch
        Address of the board's register ``ctrl_scratch``.

    Raises
    ------
    LinkError
        If the board does not answer, or the port is taken.
    """

    def __init__(
        self,
        address: str,
        port: int = 1234,
        udp: Datagrams | None = None,
        scratch: int = SCRATCH,
    ) -> None:
        self.peer = (address, port)
        self.socket = open_udp(port) if udp is None else udp
        self.scratch = scratch
        self.number = 0
        try:
            self._probe()
        except LinkError:
            self.close()
            raise

    def _probe(self) -> None:
        """Wait for the board's answer to a probe."""
        try:
            for _ in range(TRIES):
                self.socket.sendto(PROBE, self.peer)
                with contextlib.suppress(TimeoutError):
                    answer = self.socket.recv(2048)
                    if answer[:2] == HEAD[:2] and answer[2] & PROBED:
                        return
        except OSError as error:
            raise LinkError(f"the board at {self.peer[0]} cannot be reached: {error}") from error
        raise LinkError(f"no board answers at {self.peer[0]}, UDP port {self.peer[1]}")

    def close(self) -> None:
        """Close the socket."""
        self.socket.close()

    def read(self, address: int, count: int = 1) -> npt.NDArray[np.uint32]:
        """Return words from an address on, a multiple of 4: shape (count,), uint32."""
        words = np.empty(count, np.uint32)
        for begin in range(0, count, MOST_WORDS):
            size = min(MOST_WORDS, count - begin)
            words[begin : begin + size] = self._read(address + 4 * begin, size)
        return words

    def write(self, address: int, words: npt.NDArray[np.uint32]) -> None:
        """Write words from an address on, a multiple of 4: shape (n,), uint32."""
        for begin in range(0, len(words), MOST_WORDS):
            part = words[begin : begin + MOST_WORDS]
            self._write(address + 4 * begin, part)

    def _write(self, address: int, words: npt.NDArray[np.uint32]) -> None:
        record = bytes([0, ALL_BYTES, len(words), 0]) + address.to_bytes(4, "big")
        packet = HEAD + record + words.astype(">u4").tobytes()
        last = address + 4 * (len(words) - 1)
        for _ in range(TRIES):
            self.socket.sendto(packet, self.peer)
            if not MAIN_RAM <= address < RAM_END:
                self._read(self.scratch, 1)
                return
            if self._read(last, 1)[0] == words[-1]:
                return
        raise LinkError(f"the board at {self.peer[0]} does not keep what is written at {last:#x}")

    def _read(self, address: int, count: int) -> npt.NDArray[np.uint32]:
        addresses = np.arange(address, address + 4 * count, 4, np.int64).astype(">u4").tobytes()
        for _ in range(TRIES):
            self.number = (self.number + 1) % (1 << 32)
            record = bytes([0, ALL_BYTES, 0, count]) + self.number.to_bytes(4, "big")
            self.socket.sendto(HEAD + record + addresses, self.peer)
            answer = self._answer(count)
            if answer is not None:
                return answer
        raise LinkError(f"the board at {self.peer[0]} does not answer")

    def _answer(self, count: int) -> npt.NDArray[np.uint32] | None:
        """Return the words of the answer to the read of this number; None: it did not come."""
        begin = len(HEAD) + 8
        while True:
            try:
                packet = self.socket.recv(2048)
            except TimeoutError:
                return None
            if (
                packet[:2] == HEAD[:2]
                and len(packet) >= begin + 4 * count
                and int.from_bytes(packet[begin - 4 : begin], "big") == self.number
            ):
                return np.frombuffer(packet, ">u4", count, begin).astype(np.uint32)
