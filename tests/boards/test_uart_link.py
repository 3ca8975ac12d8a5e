"""The serial link, against a device written from LiteX's description of UARTBone."""

import numpy as np
import pytest

from splatline.boards.link import LinkError
from splatline.boards.uart_link import UartLink, open_serial


class Device:
    """The other end of the port: executes bursts byte by byte."""

    def __init__(self):
        self.words, self.received, self.answers = {}, bytearray(), bytearray()

    def write(self, data):
        self.received += data
        while self._burst():
            pass
        return len(data)

    def _burst(self):
        if len(self.received) < 6:
            return False
        command, count = self.received[:2]
        address = int.from_bytes(self.received[2:6], "big")
        size = 6 + (4 * count if command == 1 else 0)
        if len(self.received) < size:
            return False
        for n in range(count):
            if command == 1:
                value = bytes(self.received[6 + 4 * n : 10 + 4 * n])
                self.words[address + n] = int.from_bytes(value, "big")
            else:
                self.answers += self.words.get(address + n, 0).to_bytes(4, "big")
        del self.received[:size]
        return True

    def read(self, size):
        data = bytes(self.answers[:size])
        del self.answers[:size]
        return data

    def reset_input_buffer(self):
        self.answers.clear()


def test_words_come_back_from_their_addresses():
    device = Device()
    link = UartLink(device)
    words = np.random.default_rng(1).integers(1 << 32, size=1000, dtype=np.uint32)
    link.write(0x4000_0010, words)
    assert device.words[0x1000_0004] == words[0]
    assert (link.read(0x4000_0010, 1000) == words).all()


def test_what_was_left_of_an_answer_is_dropped():
    device = Device()
    device.answers += b"left"
    assert UartLink(device).read(0).tolist() == [0]


def test_a_silent_board_and_a_missing_port_are_said():
    class Silent(Device):
        def read(self, size):
            return b"\1"

    with pytest.raises(LinkError, match="does not answer: 1 of 4 bytes"):
        UartLink(Silent()).read(0)
    pytest.importorskip("serial")
    with pytest.raises(LinkError, match="/dev/none cannot be opened"):
        open_serial("/dev/none", 115200)
