"""The fast bench of an AXI top: registers, frames, odd packets, aborts, interrupts, resets."""

import dataclasses

import numpy as np

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.raster_beats import to_beats
from splatline.contract.register_types import Access
from splatline.sim import golden
from splatline.sim.cosim.standalone.register_writes import register_writes
from splatline.sim.cycles.cycles import count_cycles
from tests.rtl.bus.axi_cases import expected_errors
from tests.support import bus_words
from tests.support.random_frames import random_raster, word

from .bus_script import DECERR, FULL, OKAY, SLVERR, Script
from .frames import (
    any_control, any_empty_row, borders, corners, equal_depths, every_row, extremes, few_far_apart,
    wide_line,
)  # fmt: skip
from .program import SHY, Act

__all__ = ["axi_acts"]

SIZE = (48, 40)
"""Width and height of the images, those of ``tests.rtl.bus.axi_cases``."""

FREE = ({}, {})
STALLED = ({"aw": 90, "w": 120, "b": 100, "ar": 140, "r": 90, "codewords": 160, "initial": 120, "raster": 110}, {})
BURSTS = ({"aw": 128, "w": 128, "codewords": 128, "raster": 100, "b": 60}, {"aw": 5, "w": 7, "codewords": 20, "raster": 40})
WAITS = ({name: SHY for name in ("b", "r", "raster")}, {})
STALLS = (FREE, STALLED, BURSTS, WAITS)


def axi_acts(config: EngineConfig, seed: int = 1) -> list[Act]:
    """Return the acts of an AXI top's fast bench; the first begins with a reset."""
    rng = np.random.default_rng(seed)
    acts = [_registers(config, rng).act("registers after reset", STALLED, reset_edges=1)]
    acts += [_frames(config, rng, stalls).act("frames", stalls) for stalls in STALLS]
    acts += [_kinds(config, rng).act("frames of every kind", stalls) for stalls in (FREE, BURSTS, WAITS)]
    acts.append(_registers(config, rng, fresh=False).act("registers"))
    acts += [_refused(config, rng).act("refused accesses", stalls) for stalls in (FREE, STALLED)]
    acts += [_odd_packets(config, rng).act("odd packets", stalls) for stalls in STALLS]
    acts += [_any_packets(config, rng).act("any packets", stalls) for stalls in STALLS]
    acts.append(_control_words(config, rng).act("control words"))
    acts += [_odd_rasters(config, rng).act("odd initial rasters", stalls) for stalls in STALLS]
    acts += [_open_frame(config, rng).act("an open frame", stalls) for stalls in (FREE, STALLED)]
    acts += [_aborts(config, rng).act("aborted frames", stalls) for stalls in (FREE, STALLED)]
    acts += [_interrupts(config, rng).act("interrupts", stalls) for stalls in (FREE, STALLED)]
    for number, cut in enumerate((900, 1300, 1700, 2100)):
        edges = int(number > 0)
        script = _frames(config, rng, FREE, counters=False)
        acts.append(script.act("reset", STALLS[number % 4], cut=cut, reset_edges=edges, seed=number))
    acts.append(_registers(config, rng).act("registers after a reset", reset_edges=2))
    acts.append(_frames(config, rng, FREE).act("frames after a reset", FREE))
    return acts


def _frame(config: EngineConfig, rng: np.random.Generator, count: int = 60, size=SIZE):
    """Return a frame without errors, sorted by line."""
    return bus_words.clean(config, int(rng.integers(1 << 30)), count, *size)


def _prepare(script: Script, frame, start=None) -> None:
    """Write the tables and the size of a frame, and START."""
    for write in register_writes([frame])[0][:, 0].tolist():
        script.write(write >> 32, write & FULL)
    script.write("START", int(start is not None))


def _registers(config: EngineConfig, rng, fresh: bool = True) -> Script:
    """Read every register, and write those that can be written, a bit at a time."""
    script = Script(config)
    for register in script.map.registers:
        value = sum(
            field.reset << field.place.lsb for field in register.fields if field.access.readable
        )
        live = sum(f.place.mask << f.place.lsb for f in register.fields if f.live)
        if register.readable and (fresh or not live):
            counts = register.name in ("FRAMES", "ELEMENTS", "CYCLES")
            mask = FULL if fresh or not counts else 0
            if fresh or all(f.access is Access.READ_ONLY for f in register.fields):
                script.read(register.offset + int(rng.integers(4)), value, mask)
    for register in script.map.registers:
        stored = [f for f in register.fields if f.access is Access.READ_WRITE]
        mask = sum(f.place.mask << f.place.lsb for f in stored)
        for bit in range(32):
            if mask >> bit & 1:
                quiet = register.name == "CONTROL" and bit < 2
                for value in (1 << bit, mask ^ 1 << bit):
                    script.write(register.offset, value)
                    script.read(register.offset, value, FULL if not quiet else mask)
        if mask:
            script.write(register.offset, 0)
            script.read(register.offset, 0)
    script.read("IRQ_STATUS", 0, script.bits("IRQ_STATUS", "ERROR"), level=0)
    return script


def _refused(config: EngineConfig, rng) -> Script:
    """Make every kind of access that is refused, with its bit of ERROR, and quiet ones."""
    script = Script(config)
    materials = script.map.materials
    script.write("IRQ_ENABLE", script.bits("IRQ_ENABLE", "ERROR"))
    for quiet in (0, 1):
        script.write("CONTROL", script.bits("CONTROL", "QUIET") * quiet)
        slverr, decerr = (OKAY, OKAY) if quiet else (SLVERR, DECERR)
        last = script.map.registers[-1].offset
        for address in (last + 4, last + 8, 0x80, 0x100, 0x200, 0x400, 0x800, 0x1000, 0x1ffc):
            script.read(address, 0, FULL, decerr)
            script.errors("BUS_ADDRESS")
            script.write(address, 0, decerr)
            script.errors("BUS_ADDRESS")
        for register in script.map.registers:
            if not register.readable:
                script.read(register.offset, 0, FULL, slverr, level=2)
                script.errors("BUS_ACCESS")
            elif all(field.access is Access.READ_ONLY for field in register.fields):
                script.write(register.offset, 0, slverr)
                script.errors("BUS_ACCESS")
            elif register.name not in ("ERROR", "IRQ_STATUS"):
                accepted = sum(
                    f.place.mask << f.place.lsb for f in register.fields if f.access is not Access.READ_ONLY
                )
                for bit in (*range(32),):
                    if not accepted >> bit & 1 and (bit < 20 or rng.random() < 0.3):
                        script.write(register.offset, 1 << bit, slverr)
                        script.errors("BUS_VALUE")
            if register.readable and any(f.access is Access.READ_WRITE for f in register.fields):
                for strobe in (0, 7, 11, 13, 14, 8):
                    script.write(register.offset, 0, slverr, strobe)
                    script.errors("BUS_STROBE")
        script.read(materials.offset, 0, FULL, slverr)
        script.read("ERROR", script.bits("ERROR", "BUS_ACCESS"), level=1)
        script.write("ERROR", FULL ^ script.bits("ERROR", "BUS_ACCESS"))
        script.errors("BUS_ACCESS")
        script.read("IRQ_STATUS", 0, script.bits("IRQ_STATUS", "ERROR"), level=0)
    script.write("CONTROL", 0)
    script.write("IRQ_ENABLE", 0)
    return script


def _frames(config: EngineConfig, rng, stalls, counters: bool = True) -> Script:
    """Draw frames, every other one over a raster, and read the counters."""
    script = Script(config)
    for number in range(3):
        frame = _frame(config, rng, (60, 0, 120)[number], (SIZE, (9, 5), (37, 30))[number])
        start = random_raster(rng, frame.width, frame.height, 0.2, config) if number == 2 else None
        _prepare(script, frame, start)
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
            exact = stalls is FREE and start is None
            cycles = count_cycles(frame, after_reset=False) if exact else 0
            script.read("CYCLES", cycles, FULL if exact else FULL << 14 & FULL)
            script.read("INPUT_STALLS", 0, FULL << 13 & FULL)
            if number == 0:
                script.read("OUTPUT_STALLS", 0, stalls=True)
    return script


def _kinds(config: EngineConfig, rng) -> Script:
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
            _prepare(script, frame)
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


def _answer(script: Script, frame, words, names, *, keep=None, drawn=None, start=None) -> None:
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


def _odd_packets(config: EngineConfig, rng) -> Script:
    """Send packets with each error of its own."""
    script = Script(config)
    frame = _frame(config, rng)
    words = frame.codewords
    width, height = SIZE
    _prepare(script, frame)
    block, advance = bus_words.block(config, 9), bus_words.advance
    _answer(script, frame, [*words[:20], bus_words.block(config, width), *words[20:]], ["X_OUTSIDE"])
    _answer(script, frame, [bus_words.block(config, width - 1), *words], [])
    _answer(script, frame, [bus_words.block(config, config.x.mask), *words], ["X_OUTSIDE"])
    for bit in range(6, config.x_bits):
        outside = bus_words.block(config, 1 << bit)
        _answer(script, frame, [block, outside, words[-1]], ["X_OUTSIDE"])
    for bit in range(6, config.x_bits):
        _answer(script, frame, [block, advance(config, 1 << bit), words[-1]], ["LINE_PAST"])
    for size in ((16, 16), (400, 16), (200, 300)):
        script.write("LAST_COLUMN", size[0] - 1)
        script.write("LAST_LINE", size[1] - 1)
        small = dataclasses.replace(frame, width=size[0], height=size[1])
        for x, step in ((size[0] - 1, size[1] + 3), (size[0], size[1] + 4)):
            sent = [bus_words.block(config, x), advance(config, step), words[-1]]
            wrong = ["X_OUTSIDE", "LINE_PAST"] if x == size[0] else []
            _answer(script, small, sent, wrong)
    script.write("LAST_COLUMN", width - 1)
    script.write("LAST_LINE", height - 1)
    _answer(script, frame, [block, advance(config, height + 3), block, words[-1]], [])
    _answer(script, frame, [block, advance(config, height + 4), block, words[-1]], ["LINE_PAST"])
    _answer(script, frame, [*[advance(config, config.x.mask)] * 9, *words], ["LINE_PAST"])
    _answer(script, frame, words[:-1], ["FRAME_ENDED_EARLY"])
    _answer(script, frame, [*words, *words[:9], *words], ["END_WITHOUT_LAST"], drawn=words)
    _answer(script, frame, words, [])
    size = bus_words.word_bytes(config)
    for byte in range(size):
        keep = np.ones((len(words), size), np.uint8)
        keep[byte:-1:6, byte] = 0
        if byte == 5:
            keep[10:14] = 0
        _answer(script, frame, words, ["PARTIAL_WORD"], keep=keep, drawn=words[keep.all(axis=1)])
    keep = np.zeros((3, size), np.uint8)
    _answer(script, frame, words[:3], ["FRAME_ENDED_EARLY", "PARTIAL_WORD"], keep=keep, drawn=[])
    keep = np.ones((len(words), size), np.uint8)
    keep[-1, 4] = 0
    _answer(script, frame, words, ["FRAME_ENDED_EARLY", "PARTIAL_WORD"], keep=keep)
    _answer(script, frame, words[-1:], [])
    _answer(script, frame, words, [])
    return script


def _any_packets(config: EngineConfig, rng) -> Script:
    """Send packets of any words, sizes, ends and lengths."""
    script = Script(config)
    frame = _frame(config, rng)
    _prepare(script, frame)
    for _ in range(5):
        words = bus_words.any_words(rng, int(rng.integers(1, 60)), *SIZE, config)
        words[rng.random(len(words)) < rng.choice([0.0, 0.05, 0.5])] = bus_words.end(config)
        present = rng.integers(0, 2, (len(words), bus_words.word_bytes(config)))
        keep = np.where(rng.random((len(words), 1)) < 0.1, present, 1).astype(np.uint8)
        kept = words[keep.all(axis=1)]
        ends = bus_words.decoded(kept, config)["end"].astype(bool)
        taken = kept[: int(np.argmax(ends)) + 1] if ends.any() else kept
        names = expected_errors(words, keep, config)
        _answer(script, frame, words, names, keep=keep, drawn=taken)
    return script


def _control_words(config: EngineConfig, rng) -> Script:
    """Send words that are just no control words, and every kind of end word; count elements."""
    script = Script(config)
    frame = _frame(config, rng)
    _prepare(script, frame)
    script.write("CONTROL", script.bits("CONTROL", "CLEAR"))
    elements = 0
    row_of = [(row, first, last) for row in range(4) for first in range(8) for last in range(8)]
    for begin in range(0, len(row_of), 32):
        words = []
        for row, first, last in row_of[begin : begin + 32]:
            rows = [any_empty_row(rng) for _ in range(4)]
            rows[row] = first, last
            if first > last:
                words.append(any_control(rng, config, end=False))
            # An odd intensity: a control word with it ends the frame.
            depth = int(rng.integers(config.background_depth))
            words.append(word(rows, 5 * row, depth, mode=int(first <= last), diffuse=1, config=config))
            elements += 1
        words.append(any_control(rng, config, end=True))
        _answer(script, frame, np.array(words, np.uint64), [])
        script.read("ELEMENTS", elements)
    return script


def _odd_rasters(config: EngineConfig, rng) -> Script:
    """Send initial rasters that end early or late, or lack a byte, or that no frame asked for."""
    script = Script(config)
    frame = _frame(config, rng)
    start = random_raster(rng, *SIZE, 0.1, config)
    other = to_beats(random_raster(rng, *SIZE, 0.05, config))
    beats = to_beats(start)
    _prepare(script, frame)
    script.packet("initial", beats)
    _answer(script, frame, frame.codewords, [])
    script.write("START", 1)
    _answer(script, frame, frame.codewords, [], start=start)
    script.packet("initial", beats[:-1])
    _answer(script, frame, frame.codewords, ["INITIAL_ENDED_EARLY"], start=start)
    script.packet("initial", np.concatenate([beats, other]))
    script.packet("codewords", frame.codewords)
    script.picture(to_beats(golden.render(frame, start)))
    script.settle()
    script.sent("initial")
    script.wait(2)
    script.errors("INITIAL_WITHOUT_LAST")
    size = raster_stream_bytes(config)
    keep = np.ones((len(beats) + 1, size), np.uint8)
    keep[3, int(rng.integers(size))] = 0
    extra = np.insert(beats, 3, other[0], axis=0)
    script.packet("initial", extra, keep)
    _answer(script, frame, frame.codewords, ["INITIAL_PARTIAL"], start=start)
    script.packet("initial", beats)
    _answer(script, frame, frame.codewords, [], start=start)
    script.write("START", 0)
    return script


def _open_frame(config: EngineConfig, rng) -> Script:
    """Write tables while a frame is open, and hold a frame back."""
    script = Script(config)
    frame = _frame(config, rng)
    _prepare(script, frame)
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
    other = _frame(config, rng)
    writes = register_writes([dataclasses.replace(frame, tables=other.tables)])[0][:, 0].tolist()
    for write in writes:
        script.write(write >> 32, write & FULL)
    script.read("STATUS", 0)
    script.picture(to_beats(golden.render(dataclasses.replace(frame, tables=other.tables))))
    script.write("CONTROL", 0)
    script.settle()
    script.errors(clear=False)
    return script


def _aborts(config: EngineConfig, rng) -> Script:
    """Abort frames of which no beat has left; the rest of their packets is dropped."""
    script = Script(config)
    frame = _frame(config, rng)
    few = [bus_words.block(config, x) for x in (0, 9, 20)]
    nothing = to_beats(golden.render(frame))[-1:]
    abort = script.bits("CONTROL", "ABORT")
    _prepare(script, frame)
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
        _answer(script, frame, frame.codewords, [])
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
    _answer(script, frame, frame.codewords, [], start=start)
    script.write("START", 0)
    _answer(script, frame, frame.codewords, [])
    return script


def _interrupts(config: EngineConfig, rng) -> Script:
    """Raise and clear the interrupt by each cause, enabled and not."""
    script = Script(config)
    frame = _frame(config, rng, 12)
    done, error = (script.bits("IRQ_ENABLE", name) for name in ("FRAME_DONE", "ERROR"))
    _prepare(script, frame)
    script.write("IRQ_STATUS", FULL)
    script.write("ERROR", FULL)
    wrong = [bus_words.block(config, SIZE[0]), *frame.codewords]
    for enabled in (0, done, error, done | error):
        script.write("IRQ_ENABLE", enabled)
        script.read("IRQ_ENABLE", enabled, level=0)
        for words, error_set in ((frame.codewords, 0), (wrong, error)):
            script.packet("codewords", words)
            whole = dataclasses.replace(frame, codewords=np.array(words, np.uint64))
            script.picture(to_beats(golden.render(whole)))
            script.settle()
            script.wait(2)
            level = int(bool(enabled & (done | error_set)))
            script.read("IRQ_STATUS", done | error_set, level=level)
            script.write("IRQ_STATUS", done)
            script.wait(1)
            script.read("IRQ_STATUS", error_set, level=int(bool(enabled & error_set)))
            script.write("ERROR", FULL)
            script.wait(1)
            script.read("IRQ_STATUS", 0, level=0)
    script.write("IRQ_ENABLE", 0)
    return script
