"""Frames on the AXI top, with registers, and their counters."""

import dataclasses

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.raster_beats import to_beats
from splatline.sim import golden
from splatline.sim.cosim.standalone.register_writes import register_writes
from splatline.sim.cycles.cycles import count_cycles
from tests.support import bus_words
from tests.support.random_frames import random_raster

from .bus_script import FULL, Script
from .frames import (
    borders,
    corners,
    equal_depths,
    every_row,
    extremes,
    few_far_apart,
    wide_line,
)

__all__ = [
    "SIZE",
    "a_frame",
    "answer",
    "default_width",
    "frames",
    "kinds",
    "late_counters",
    "narrow",
    "prepare",
]

SIZE = (48, 40)
"""Width and height of the images, those of ``tests.rtl.bus.axi_cases``."""


def a_frame(config: EngineConfig, rng: np.random.Generator, count: int = 60, size=SIZE):
    """Return a frame without errors, sorted by line."""
    return bus_words.clean(config, int(rng.integers(1 << 30)), count, *size)


def prepare(script: Script, frame, start=None) -> None:
    """Write the tables and the size of a frame, and START."""
    for write in register_writes([frame])[0][:, 0].tolist():
        script.write(write >> 32, write & FULL)
    script.write("START", int(start is not None))


def answer(script: Script, frame, words, names, *, keep=None, drawn=None, start=None) -> None:
    """Send a packet; expect the picture of ``drawn``, and bits of ERROR."""
    script.packet("codewords", words, keep)
    whole = np.asarray(words if drawn is None else drawn, np.uint64)
    whole = np.concatenate([whole, np.array([bus_words.end(frame.config)], np.uint64)])
    picture = golden.render(dataclasses.replace(frame, codewords=whole), start)
    script.picture(to_beats(picture))
    script.settle()
    script.sent("codewords")
    script.wait(3)
    script.errors(*names)
    script.read("STATUS", 0)


def frames(
    config: EngineConfig, rng: np.random.Generator, *, counters: bool = True, model: bool = False
) -> Script:
    """Draw frames, every other one over a raster, and read the counters.

    ``model``: CYCLES is what the cycle model says, as nothing stalls.
    """
    script = Script(config)
    for number in range(3):
        frame = a_frame(config, rng, (60, 0, 120)[number], (SIZE, (9, 5), (37, 30))[number])
        start = random_raster(rng, frame.width, frame.height, 0.2, config) if number == 2 else None
        prepare(script, frame, start)
        if counters:
            script.write("CONTROL", script.bits("CONTROL", "CLEAR"))
            for name in ("FRAMES", "ELEMENTS", "CYCLES", "INPUT_STALLS", "OUTPUT_STALLS", "WORDS"):
                script.read(name, 0)
        if start is not None:
            script.packet("initial", to_beats(start))
        script.packet("codewords", frame.codewords)
        beats = to_beats(golden.render(frame, start))
        script.picture(beats)
        script.settle()
        script.read("IRQ_STATUS", 1, 1)
        script.write("IRQ_STATUS", FULL)
        script.read("IRQ_STATUS", 0)
        script.read("STATUS", 0)
        script.errors(clear=False)
        if counters:
            control = bus_words.decoded(frame.codewords, config)["control"]
            script.read("FRAMES", 1)
            script.read("ELEMENTS", int((~control).sum()))
            script.read("WORDS", len(beats) - 1)
            exact = model and start is None
            cycles = count_cycles(frame, after_reset=False) if exact else 0
            script.read("CYCLES", cycles, FULL if exact else FULL << 14 & FULL)
            script.read("INPUT_STALLS", 0, FULL << 13 & FULL)
            if number == 0:
                script.read("OUTPUT_STALLS", 0, stalls=True)
    return script


def late_counters(config: EngineConfig, rng: np.random.Generator, *, shy: bool) -> Script:
    """Draw a small frame from several values of the counters, up to where they wrap.

    ``shy``: each beat of the raster waits. Stalls are fewer than 128, and some.
    """
    script = Script(config)
    frame = a_frame(config, rng, 5)
    prepare(script, frame)
    beats = to_beats(golden.render(frame))
    control = bus_words.decoded(frame.codewords, config)["control"]
    counts = {"FRAMES": 1, "ELEMENTS": int((~control).sum()), "WORDS": len(beats) - 1}
    if not shy:
        counts |= {"CYCLES": count_cycles(frame, after_reset=False), "OUTPUT_STALLS": 0}
    some = ("INPUT_STALLS", "OUTPUT_STALLS") if shy else ("INPUT_STALLS",)
    for value in [FULL, *(FULL >> bit for bit in range(1, 25)), FULL // 3, FULL // 3 * 2]:
        script.poke(value)
        for name in sorted({*counts, *some}):
            script.read(name, value)
        script.packet("codewords", frame.codewords)
        script.picture(beats)
        script.settle()
        for name, count in counts.items():
            script.read(name, value + count & FULL)
        for name in some if value & 0xFF == 0xFF else ():
            script.read(name, value + 1 & FULL, FULL ^ 0x7F)
    return script


def kinds(config: EngineConfig, rng) -> Script:
    """Draw frames of other kinds and sizes with the tables of the first, and count in them."""
    script = Script(config)
    kinds = {
        "extremes": extremes(rng, config, 37, 41),
        "borders": borders(rng, config, 37, 41),
        "equal depths": equal_depths(rng, config, 37, 41),
        "corners": corners(rng, config, 300, 30),
        "wide": wide_line(rng, config),
        "every row": every_row(rng, config),
        "far apart": few_far_apart(rng, config),
    }
    tables = kinds["extremes"].tables
    for number, frame in enumerate(kinds.values()):
        frame = dataclasses.replace(frame, tables=tables)
        if number == 0:
            prepare(script, frame)
        script.write("LAST_COLUMN", frame.width - 1)
        script.write("LAST_LINE", frame.height - 1)
        script.write("CONTROL", script.bits("CONTROL", "CLEAR"))
        script.packet("codewords", frame.codewords)
        beats = to_beats(golden.render(frame))
        script.picture(beats)
        script.settle()
        control = bus_words.decoded(frame.codewords, config)["control"]
        script.read("ELEMENTS", int((~control).sum()))
        script.read("WORDS", len(beats) - 1)
        script.write("ERROR", FULL)
    return script


def narrow(config: EngineConfig) -> Script:
    """Write a width of one column, again and again."""
    script = Script(config)
    for _ in range(40):
        script.write("LAST_COLUMN", 0, at_once=True)
    return script


def default_width(config: EngineConfig, rng) -> Script:
    """Draw a frame as wide as one is after a reset, without writing its width."""
    script = Script(config)
    frame = a_frame(config, rng, size=(config.reset_size[0], SIZE[1]))
    for write in register_writes([frame])[0][:, 0].tolist():
        if write >> 32 != script.offset("LAST_COLUMN"):
            script.write(write >> 32, write & FULL)
    answer(script, frame, frame.codewords, [])
    return script
