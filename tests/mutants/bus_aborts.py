"""Frames on the AXI top that are open: writes, holds and aborts in the middle."""

import dataclasses

from splatline.contract.config import EngineConfig
from splatline.contract.raster_beats import to_beats
from splatline.sim import golden
from splatline.sim.cosim.standalone.register_writes import register_writes
from tests.support import bus_words
from tests.support.random_frames import random_raster

from .bus_frames import SIZE, a_frame, answer, prepare
from .bus_script import FULL, SLVERR, Script

__all__ = ["aborts", "open_frame"]


def open_frame(config: EngineConfig, rng) -> Script:
    """Write tables while a frame is open, and hold a frame back."""
    script = Script(config)
    frame = a_frame(config, rng)
    prepare(script, frame)
    words, at = frame.codewords, 25
    script.picture(to_beats(golden.render(frame)))
    script.packet("codewords", words[:at], last=False)
    script.sent("codewords")
    script.wait(6)
    script.read("STATUS", script.bits("STATUS", "BUSY"))
    for name in ("LAST_COLUMN", "LAST_LINE", "START", "AMBIENT_RED"):
        script.write(name, 1, SLVERR)
        script.errors("BUS_BUSY")
    for n in range(script.map.materials.words):
        script.write(script.map.materials.offset + 4 * n, 1, SLVERR)
        script.errors("BUS_BUSY")
    script.packet("codewords", words[at:])
    script.settle()
    script.read("STATUS", 0)
    hold = script.bits("CONTROL", "HOLD")
    script.write("CONTROL", hold)
    script.packet("codewords", words)
    script.waits["codewords"] = 0
    script.wait(6)
    script.read("STATUS", 0)
    other = a_frame(config, rng)
    writes = register_writes([dataclasses.replace(frame, tables=other.tables)])[0][:, 0].tolist()
    for write in writes:
        script.write(write >> 32, write & FULL)
    script.read("STATUS", 0)
    script.picture(to_beats(golden.render(dataclasses.replace(frame, tables=other.tables))))
    script.write("CONTROL", 0)
    script.settle()
    script.errors(clear=False)
    return script


def aborts(config: EngineConfig, rng) -> Script:
    """Abort frames of which no beat has left; the rest of their packets is dropped."""
    script = Script(config)
    frame = a_frame(config, rng)
    few = [bus_words.block(config, x) for x in (0, 9, 20)]
    nothing = to_beats(golden.render(frame))[-1:]
    abort = script.bits("CONTROL", "ABORT")
    prepare(script, frame)
    script.write("CONTROL", abort)  # of no frame
    script.read("STATUS", 0)
    script.errors()
    for ending in ("rest", "resync"):
        script.packet("codewords", few, last=False)
        script.sent("codewords")
        script.wait(6)
        script.read("STATUS", script.bits("STATUS", "BUSY"))
        script.picture(nothing)
        script.write("CONTROL", abort)
        script.settle()
        script.wait(2)
        script.read("STATUS", script.bits("STATUS", "DROPPING"))
        script.errors("ABORTED")
        if ending == "rest":
            script.packet("codewords", frame.codewords)
            script.sent("codewords")
            script.wait(3)
        else:
            script.write("CONTROL", script.bits("CONTROL", "RESYNC"))
        script.read("STATUS", 0)
        answer(script, frame, frame.codewords, [])
    start = random_raster(rng, *SIZE, 0.1, config)
    script.write("START", 1)  # a raster that does not come whole
    script.packet("initial", to_beats(start)[:5], last=False)
    script.packet("codewords", [*few, bus_words.end(config)])
    script.sent("codewords", "initial")
    script.wait(6)
    script.picture(nothing)
    script.write("CONTROL", abort)
    script.settle()
    script.wait(4)
    script.read("STATUS", script.bits("STATUS", "DROPPING_INITIAL"))
    script.errors("ABORTED")
    script.packet("initial", to_beats(start)[5:])
    script.sent("initial")
    script.wait(3)
    script.read("STATUS", 0)
    script.packet("initial", to_beats(start))
    answer(script, frame, frame.codewords, [], start=start)
    script.write("START", 0)
    answer(script, frame, frame.codewords, [])
    return script
