"""A UDP socket whose datagrams go to a simulated board as Ethernet frames.

Frames are packed and unpacked by Scapy, which is independent of this project and of LiteEth.
"""

from __future__ import annotations

from scapy.layers.inet import IP, UDP
from scapy.layers.l2 import ARP, Ether

from .board_device import SimulatedBoard

__all__ = ["BoardNetwork"]

HOST_MAC, HOST_IP = "02:00:00:00:00:01", "192.168.1.100"
"""Addresses of this end."""

BROADCAST = "ff:ff:ff:ff:ff:ff"

ANSWER_NS = 100_000
"""Longest time that the board may take for a frame."""

TRIES = 3
"""Questions for the board's MAC address: its PHY is not ready at once after a reset."""


class BoardNetwork:
    """A cable between a host and a board, with a UDP socket at the host's end.

    It asks for the board's MAC address by ARP, and answers such questions of the board.

    Parameters
    ----------
    board
        A simulated board with Ethernet.
    address
        The board's IP address.
    """

    def __init__(self, board: SimulatedBoard, address: str) -> None:
        self.board = board
        self.frames = 0  # sent to the board
        question = ARP(op="who-has", hwsrc=HOST_MAC, psrc=HOST_IP, pdst=address)
        for _ in range(TRIES):
            self._send(Ether(src=HOST_MAC, dst=BROADCAST) / question)
            answer = self._receive()
            if answer is not None and ARP in answer and answer[ARP].psrc == address:
                self.mac = answer[ARP].hwsrc
                return
        raise TimeoutError(f"no answer to the question for {address}")

    def sendto(self, data: bytes, peer: tuple[str, int], sent: int | None = None) -> int:
        """Send a datagram; ``sent``: bytes of its frame that leave before the cable is pulled."""
        address, port = peer
        packet = IP(src=HOST_IP, dst=address) / UDP(sport=port, dport=port) / data
        self._send(Ether(src=HOST_MAC, dst=self.mac) / packet, sent)
        return len(data)

    def recv(self, size: int) -> bytes:
        """Return the next datagram; raise ``TimeoutError`` if none comes."""
        while (frame := self._receive()) is not None:
            if ARP in frame and frame[ARP].op == 1 and frame[ARP].pdst == HOST_IP:
                told = ARP(
                    op="is-at", hwsrc=HOST_MAC, psrc=HOST_IP, hwdst=frame.src, pdst=frame[ARP].psrc
                )
                self._send(Ether(src=HOST_MAC, dst=frame.src) / told)
            elif UDP in frame and frame[IP].dst == HOST_IP:
                return bytes(frame[UDP].payload)[:size]
        raise TimeoutError("the board sends nothing")

    def close(self) -> None:
        """Close the socket: the board runs on."""

    def _send(self, frame: Ether, sent: int | None = None) -> None:
        self.frames += 1
        self.board.command("send_frame", bytes(frame), sent)

    def _receive(self) -> Ether | None:
        frame = self.board.command("receive_frame", ANSWER_NS)
        return Ether(frame) if frame else None
