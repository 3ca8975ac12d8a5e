"""Devices that misbehave: a named error in time, and then right or said to be lost."""

import contextlib
import errno
import os
import threading
import time

import numpy as np
import pytest

from splatline.contract.presets import PAPER
from splatline.contract.raster_beats import to_beats
from splatline.contract.register_map import register_map
from splatline.host.device.device import BusError, DeviceLostError, DeviceTimeoutError
from splatline.host.device.driver import Engine, EngineError
from splatline.host.device.xdma import XdmaDevice
from splatline.sim import golden
from tests.host.device.fake_board import FakeBoard
from tests.rtl.bus.axi_cases import HEIGHT, WIDTH, clean

LIMIT = 0.3
"""Seconds that a device has."""

MARGIN = 3.0
"""Seconds more, as this machine may be busy."""


class Scripted:
    """A device that draws with golden, unless its script says what ``receive`` does instead."""

    def __init__(self):
        self.map = register_map(PAPER)
        self.words = {
            register.offset: sum(field.reset << field.place.lsb for field in register.fields)
            for register in self.map.registers
        }
        self.script = []
        self.gone = False
        self.frame = clean(PAPER, 1)

    def read32(self, offset):
        return 0xFFFF_FFFF if self.gone else self.words.get(offset, 0)

    def write32(self, offset, value):
        register = next((one for one in self.map.registers if one.offset == offset), None)
        if register is not None and register.name not in ("ERROR", "IRQ_STATUS"):
            self.words[offset] = value

    def write_words(self, offset, words):
        for place, word in enumerate(words.tolist()):
            self.write32(offset + 4 * place, word)

    def send(self, codewords, initial=None):
        pass

    def receive(self):
        action = self.script.pop(0) if self.script else None
        if isinstance(action, BaseException):
            raise action
        beats = to_beats(golden.render(self.frame))
        return beats if action is None else action(beats)


@pytest.fixture
def scripted():
    device = Scripted()
    engine = Engine(device)
    engine.write_tables(device.frame.tables, WIDTH, HEIGHT)
    return device, engine


def is_right(device, engine):
    picture = engine.draw(device.frame.codewords)
    return picture.mismatches(golden.render(device.frame)) == 0


def unplugged(device):
    def receive(beats):
        device.gone = True
        return beats

    return receive


def test_a_frame_that_an_abort_ends_is_an_error_and_the_next_is_right(scripted):
    device, engine = scripted
    device.script = [DeviceTimeoutError("late"), lambda beats: beats[-1:]]
    with pytest.raises(EngineError, match="aborted: late") as raised:
        engine.draw(device.frame.codewords)
    assert raised.value.names == ("ABORTED",)
    assert is_right(device, engine)


@pytest.mark.parametrize(
    ("script", "error", "message"),
    [
        ([DeviceTimeoutError("late")] * 2, DeviceLostError, "an abort does not end the frame"),
        ([BusError("refused")], BusError, "refused"),
        ([DeviceLostError("pulled out")], DeviceLostError, "pulled out"),
        ([DeviceTimeoutError("late"), BusError("refused")], BusError, "refused"),
        ([KeyboardInterrupt("Ctrl-C")], KeyboardInterrupt, "Ctrl-C"),
    ],
    ids=["never ready", "bus error", "gone", "bus error in an abort", "interrupt"],
)
def test_a_device_that_fails_within_a_frame_is_lost_until_it_is_opened(
    scripted, script, error, message
):
    device, engine = scripted
    device.script = list(script)
    with pytest.raises(error, match=message):
        engine.draw(device.frame.codewords)
    for _ in range(2):  # although it would draw again
        with pytest.raises(DeviceLostError, match=r"lost before: .*; open it again"):
            engine.draw(device.frame.codewords)
    assert is_right(device, Engine(device))


def test_registers_that_read_as_ones_are_a_lost_device(scripted):
    device, engine = scripted
    device.script = [unplugged(device)]
    for call in (
        lambda: engine.draw(device.frame.codewords),
        engine.errors,
        lambda: engine.write_tables(device.frame.tables, WIDTH, HEIGHT),
        lambda: engine.draw(device.frame.codewords),
    ):
        with pytest.raises(DeviceLostError, match="gone: its register ERROR reads as 0xffffffff"):
            call()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda beats: beats[:-1], "none of .* beats is the end"),
        (lambda beats: beats[::-1], "ends the frame, but is not the last"),
        (lambda beats: np.repeat(beats, [2] + [1] * (len(beats) - 1), axis=0), "after word"),
        (lambda beats: beats | np.uint64(1) << np.uint64(63), "no picture"),
        (lambda beats: beats[:0], "none of 0 beats"),
    ],
    ids=["no end", "backwards", "a beat twice", "stuck bits", "nothing"],
)
def test_beats_that_are_no_picture_are_an_error_and_the_next_frame_is_right(
    scripted, change, message
):
    device, engine = scripted
    device.script = [change]
    with pytest.raises(EngineError, match=f"sent no picture: .*{message}|{message}"):
        engine.draw(device.frame.codewords)
    assert is_right(device, engine)


class DeafBoard(FakeBoard):
    """Takes no code words, but for those of its own end."""

    def serve(self):
        while not self.closing:
            time.sleep(0.01)

    def close(self):
        """End: no word wakes it, for which the pipe may have no room."""
        self.closing = True
        self.thread.join()
        for pipe in self.pipes.values():
            os.close(pipe)


@pytest.fixture
def deaf(tmp_path):
    board = DeafBoard(tmp_path, PAPER)
    yield board
    board.close()


def within_time(begin, limits=1):
    assert time.monotonic() - begin < limits * LIMIT + MARGIN


def test_a_board_that_is_never_ready_is_lost_in_time(deaf):
    frame = clean(PAPER, 3, 20_000)  # more than the pipe holds
    with XdmaDevice(deaf.card, timeout=LIMIT) as device:
        engine = Engine(device)
        begin = time.monotonic()
        with pytest.raises(DeviceLostError, match="does not answer: no end beat after"):
            engine.draw(frame.codewords)
        within_time(begin, 2)


def test_packets_that_are_not_taken_after_the_end_beat_are_noticed(deaf):
    frame = clean(PAPER, 3, 20_000)
    end = to_beats(golden.render(frame))[-1:]
    os.write(deaf.pipes["_c2h_0"], end.tobytes())
    with XdmaDevice(deaf.card, timeout=LIMIT) as device:
        begin = time.monotonic()
        device.send(frame.codewords)
        with pytest.raises(DeviceLostError, match="its packets were not taken"):
            device.receive()
        within_time(begin)


@pytest.mark.parametrize("pause", [0.0, 0.02], ids=["fast", "slowly"])
def test_beats_without_end_are_given_up(deaf, pause):
    beats = np.ones((1 if pause else 500, 2), np.uint64).tobytes()
    stop = threading.Event()

    def pour():
        with contextlib.suppress(OSError):  # once the pipe is closed
            while not stop.is_set():
                os.write(deaf.pipes["_c2h_0"], beats)
                time.sleep(pause)

    thread = threading.Thread(target=pour, daemon=True)
    with XdmaDevice(deaf.card, timeout=LIMIT if pause else 60.0) as device:
        begin = time.monotonic()
        thread.start()
        error, message = (
            (DeviceTimeoutError, "no end beat") if pause else (DeviceLostError, "more beats than")
        )
        with pytest.raises(error, match=message):
            device.receive()
        if pause:
            within_time(begin)
        stop.set()


@pytest.mark.parametrize(
    ("call", "number", "error"),
    [
        ("read", errno.EIO, DeviceLostError),
        ("read", errno.ENODEV, DeviceLostError),
        ("read", errno.ETIMEDOUT, DeviceTimeoutError),
        ("write", errno.EIO, DeviceLostError),
        ("write", errno.ENODEV, DeviceLostError),
    ],
)
def test_what_the_kernel_says_is_named_at_once(deaf, monkeypatch, call, number, error):
    frame = clean(PAPER, 3)
    os.write(deaf.pipes["_c2h_0"], bytes(8))  # half a beat: the file can be read
    with XdmaDevice(deaf.card, timeout=60.0) as device:

        def fail(*_):
            raise OSError(number, os.strerror(number))

        monkeypatch.setattr(os, call, fail)
        begin = time.monotonic()
        device.send(frame.codewords)
        with pytest.raises(error, match=os.strerror(number)):
            device.receive()
        assert time.monotonic() - begin < MARGIN
        monkeypatch.undo()
