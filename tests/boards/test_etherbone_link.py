"""The link over Ethernet, against a device that loses packets."""

import socket
import threading

import numpy as np
import pytest

from splatline.boards import etherbone_link
from splatline.boards.etherbone_link import EtherboneLink, open_udp
from splatline.boards.link import LinkError

HOST, BOARD = "127.0.0.1", "127.0.0.2"


class Device(threading.Thread):
    """Etherbone behind a UDP socket; every so many packets one is lost.

    As LiteEth it answers to its own port number.
    """

    def __init__(self, lose=0):
        super().__init__(daemon=True)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind((BOARD, 0))
        self.port = self.socket.getsockname()[1]
        self.words, self.lose, self.count, self.longest = {}, lose, 0, 0
        self.start()

    def run(self):
        while True:
            packet, (address, _) = self.socket.recvfrom(2048)
            peer = address, self.port
            if packet == b"end":
                return
            self.count += 1
            if self.lose and self.count % self.lose == 0:
                continue
            assert packet[:2] == b"\x4e\x6f"
            if packet[2] & 1:  # a probe
                self.socket.sendto(packet[:2] + b"\x16\x44" + bytes(8), peer)
                continue
            self._record(packet[8:], peer)

    def _record(self, record, peer):
        writes, reads = record[2:4]
        words = [int.from_bytes(record[n : n + 4], "big") for n in range(4, len(record), 4)]
        self.longest = max(self.longest, len(words))
        assert len(words) == 1 + writes + reads  # never both: LiteEth mixes them up
        if writes:
            for n, value in enumerate(words[1:]):
                self.words[words[0] + 4 * n] = value
        else:
            values = [self.words.get(address, 0) for address in words[1:]]
            body = b"".join(value.to_bytes(4, "big") for value in (words[0], *values))
            self.socket.sendto(
                b"\x4e\x6f\x10\x44" + bytes(4) + bytes([0, 15, reads, 0]) + body, peer
            )


@pytest.fixture
def device(request):
    made = Device(getattr(request, "param", 0))
    yield made
    made.socket.sendto(b"end", (BOARD, made.port))
    made.join()
    made.socket.close()


@pytest.mark.parametrize("device", [0, 3, 5], indirect=True)
def test_words_come_back_though_packets_are_lost(device, monkeypatch):
    monkeypatch.setattr(etherbone_link, "SECONDS", 0.05)
    link = EtherboneLink(BOARD, device.port, open_udp(device.port, HOST))
    words = np.random.default_rng(1).integers(1 << 32, size=1000, dtype=np.uint32)
    link.write(0x4000_0000, words)
    link.write(0x40, words[:1])
    assert (link.read(0x4000_0000, 1000) == words).all()
    assert device.words[0x4000_0004] == words[1]
    assert device.longest <= 256  # what the board's buffer holds
    link.close()


def test_nobody_at_the_address_is_said(monkeypatch):
    monkeypatch.setattr(etherbone_link, "SECONDS", 0.02)
    with pytest.raises(LinkError, match=r"no board answers at 127\.0\.0\.2"):
        EtherboneLink(BOARD, 49_152, open_udp(49_152, HOST))


def test_a_port_that_is_taken_is_said():
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other,
        pytest.raises(LinkError, match=r"UDP port \d+ of this machine cannot be opened"),
    ):
        other.bind((HOST, 0))
        EtherboneLink(BOARD, other.getsockname()[1])
