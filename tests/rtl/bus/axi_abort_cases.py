"""Frames that are ended from outside, whatever they wait for, and what must come of it."""

import numpy as np

from splatline.contract.raster_beats import from_beats
from splatline.host.device.device import DeviceTimeoutError
from splatline.host.device.driver import Driver, EngineError
from splatline.sim import golden
from tests.rtl.bus.axi_cases import HEIGHT, WIDTH, case, clean, initial_of, right, send, setup
from tests.support.bus_words import word_bytes

__all__ = ["ABORTS"]

ABORTS = {}

ROOM = 2
"""Beats in the registers of the raster's port, which leave in any case."""


def abort(device, *, dropping=()):
    """End the frame that is open; what still comes is drawn, inside the image and in order."""
    engine = Driver(device)
    assert engine.get("STATUS", "BUSY")
    engine.set("CONTROL", QUIET=1, ABORT=1)
    device.command("pause", "raster", False)
    beats = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
    from_beats(beats, WIDTH, HEIGHT, engine.config)  # inside the image and in order
    device.command("wait", 200)  # a word is dropped a cycle
    for bit in ("DROPPING", "DROPPING_INITIAL"):
        assert engine.get("STATUS", bit) == (bit in dropping)
    assert not engine.get("STATUS", "BUSY")
    assert "ABORTED" in engine.errors()
    engine.clear("ERROR")
    for stream in ("codewords", "initial"):
        device.command("pause", stream, False)
    device.command("wait", 2000)
    assert engine.errors() == []


@case(ABORTS)
def while_the_raster_waits(device):
    engine, frame = setup(device, 30)
    whole = engine.draw_beats(frame.codewords)
    engine.set("CONTROL", QUIET=1, CLEAR=1)
    device.command("pause", "raster", True)
    device.send(frame.codewords)
    device.command("wait", 200)
    abort(device)
    assert len(whole) > ROOM >= engine.get("WORDS")
    right(device)


@case(ABORTS)
def in_the_middle_of_the_code_words(device):
    engine, frame = setup(device, 31)
    device.send(frame.codewords)
    device.command("wait", 40)
    device.command("pause", "codewords", True)
    device.command("wait", 400)
    assert engine.get("ELEMENTS") > 0
    abort(device, dropping=["DROPPING"])
    right(device)


@case(ABORTS)
def with_an_initial_raster_that_never_comes(device):
    engine, frame = setup(device, 32)
    engine.set("START", LOAD=1)
    device.send(frame.codewords)
    device.command("wait", 400)
    abort(device)
    right(device)


@case(ABORTS)
def in_the_middle_of_an_initial_raster(device):
    engine, frame = setup(device, 33)
    engine.set("START", LOAD=1)
    start, beats = initial_of(frame, 6)
    device.send(frame.codewords, engine.widen(beats))
    device.command("wait", 60)
    device.command("pause", "initial", True)
    device.command("wait", 400)
    abort(device, dropping=["DROPPING_INITIAL"])
    engine, frame = setup(device, 33)
    assert engine.draw(frame.codewords, start).mismatches(golden.render(frame, start)) == 0
    right(device)


@case(ABORTS)
def while_a_beat_of_the_initial_raster_waits(device):
    """The window is full, and the guard holds the beat until it has been taken."""
    engine, frame = setup(device, 34)
    engine.set("START", LOAD=1)
    start, beats = initial_of(frame, 7)
    device.command("pause", "raster", True)
    device.send(frame.codewords, engine.widen(beats))
    device.command("wait", 1000)
    device.command("pause", "initial", True)
    abort(device, dropping=["DROPPING_INITIAL"])
    engine, frame = setup(device, 34)
    assert engine.draw(frame.codewords, start).mismatches(golden.render(frame, start)) == 0
    right(device)


@case(ABORTS)
def while_the_engine_clears_its_memory(device):
    """And the initial raster will not come."""
    device.command("reset")
    engine = Driver(device)
    frame = clean(engine.config, 37)
    engine.set("START", LOAD=1)
    device.send(frame.codewords)
    device.command("wait", 20)
    assert engine.get("WORDS") == 0
    device.command("pause", "codewords", True)
    assert engine.get("STATUS", "BUSY")
    engine.set("CONTROL", QUIET=1, ABORT=1)
    device.receive()
    device.command("pause", "codewords", False)
    device.command("wait", 500)
    assert engine.errors() == ["ABORTED"]
    engine.set("ERROR", ABORTED=1)
    right(device)


@case(ABORTS)
def before_the_engine_has_a_word(device):
    """All that came was dropped; the end is its first, and asks for an initial raster."""
    engine, frame = setup(device, 39)
    engine.set("START", LOAD=1)
    engine.set("CONTROL", QUIET=1, CLEAR=1)
    keep = np.ones((len(frame.codewords), word_bytes(engine.config)), np.uint8)
    keep[:60] = 0
    send(device, "codewords", frame.codewords, keep.tobytes())
    device.command("wait", 20)
    device.command("pause", "codewords", True)
    device.command("wait", 20)
    assert engine.get("CYCLES") == 0
    abort(device, dropping=["DROPPING"])
    right(device)


@case(ABORTS)
def in_any_of_its_first_cycles(device):
    """One that comes before the frame does nothing; then the frame waits for its initial raster."""
    engine, frame = setup(device, 38)
    aborted = []
    for cycles in range(-1, 12):
        engine.set("START", LOAD=1)
        if cycles < 0:
            engine.set("CONTROL", QUIET=1, ABORT=1)
        device.send(frame.codewords)
        if cycles > 0:
            device.command("wait", cycles)
        if cycles >= 0:
            engine.set("CONTROL", QUIET=1, ABORT=1)
        device.command("wait", 300)
        aborted.append(not engine.get("STATUS", "BUSY"))
        if not aborted[-1]:
            engine.set("CONTROL", QUIET=1, ABORT=1)
        beats = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
        from_beats(beats, WIDTH, HEIGHT, engine.config)
        device.command("wait", 200)
        assert engine.errors() == ["ABORTED"]
        engine.set("ERROR", ABORTED=1)
    assert len(set(aborted)) == 2, aborted
    right(device)


@case(ABORTS)
def in_any_of_its_last_cycles(device):
    """The frame is whole already, or ended; the next one is right in any case."""
    engine, frame = setup(device, 40, 12)
    engine.draw(frame.codewords)
    engine.set("CONTROL", QUIET=1, CLEAR=1)
    engine.draw(frame.codewords)
    last, aborted = engine.get("CYCLES"), []
    for cycles in reversed(range(last - 25, last + 10)):
        device.send(frame.codewords)
        device.command("wait", cycles)
        engine.set("CONTROL", QUIET=1, ABORT=1)
        device.receive()
        aborted.append(engine.errors() == ["ABORTED"])
        engine.clear("ERROR")
        assert not engine.get("STATUS", "ABORTING")
        assert engine.draw(frame.codewords).mismatches(golden.render(frame)) == 0
    assert aborted[-1] and not aborted[0]
    right(device)


@case(ABORTS)
def between_frames(device):
    engine, frame = setup(device, 34)
    engine.set("CONTROL", QUIET=1, ABORT=1)
    assert engine.errors() == []
    assert engine.draw(frame.codewords).mismatches(golden.render(frame)) == 0
    right(device)


@case(ABORTS)
def and_then_the_host_s_dma_is_reset(device):
    """The rest of the packet will never come: RESYNC takes the next word as a frame's first."""
    engine, frame = setup(device, 35)
    device.send(frame.codewords)
    device.command("wait", 40)
    device.command("pause", "codewords", True)
    device.command("wait", 400)
    engine.set("CONTROL", QUIET=1, ABORT=1)
    device.receive()
    assert engine.get("STATUS", "DROPPING")
    device.command("forget", "codewords")
    device.command("pause", "codewords", False)
    engine.set("CONTROL", QUIET=1, RESYNC=1)
    assert not engine.get("STATUS", "DROPPING")
    engine.set("ERROR", ABORTED=1)
    right(device)


@case(ABORTS)
def by_the_driver_that_has_waited_too_long(device):
    engine, frame = setup(device, 36)
    engine.set("START", LOAD=1)
    limit, device.limit = device.limit, 3000
    device.command("pause", "initial", True)
    try:
        start, _ = initial_of(frame, 7)
        engine.draw(frame.codewords, start)
        raise AssertionError("a frame was drawn whose initial raster never came")
    except EngineError as error:
        assert error.names == ("ABORTED",)
        assert isinstance(error.__cause__, DeviceTimeoutError)
    finally:
        device.limit = limit
        device.command("forget", "initial")
        device.command("pause", "initial", False)
    right(device)
