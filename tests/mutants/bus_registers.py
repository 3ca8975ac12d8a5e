"""Accesses to the registers of the AXI top: allowed, refused, and the interrupt."""

import dataclasses

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.raster_beats import to_beats
from splatline.contract.register_types import Access
from splatline.sim import golden
from tests.support import bus_words

from .bus_frames import SIZE, a_frame, prepare
from .bus_script import DECERR, FULL, OKAY, SLVERR, Script

__all__ = ["in_a_row", "interrupts", "refused", "registers"]


def registers(config: EngineConfig, rng, fresh: bool = True) -> Script:
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


def refused(config: EngineConfig, rng) -> Script:
    """Make every kind of access that is refused, with its bit of ERROR, and quiet ones."""
    script = Script(config)
    materials = script.map.materials
    script.write("IRQ_ENABLE", script.bits("IRQ_ENABLE", "ERROR"))
    for quiet in (0, 1):
        script.write("CONTROL", script.bits("CONTROL", "QUIET") * quiet)
        slverr, decerr = (OKAY, OKAY) if quiet else (SLVERR, DECERR)
        last = script.map.registers[-1].offset
        for address in (last + 4, last + 8, 0x80, 0x100, 0x200, 0x400, 0x800, 0x1000, 0x1FFC):
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
                    f.place.mask << f.place.lsb
                    for f in register.fields
                    if f.access is not Access.READ_ONLY
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


def interrupts(config: EngineConfig, rng) -> Script:
    """Raise and clear the interrupt by each cause, enabled and not."""
    script = Script(config)
    frame = a_frame(config, rng, 12)
    done, error = (script.bits("IRQ_ENABLE", name) for name in ("FRAME_DONE", "ERROR"))
    prepare(script, frame)
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


def in_a_row(config: EngineConfig, rng: np.random.Generator) -> Script:
    """Make accesses that do not wait for the answers to those before."""
    script = Script(config)
    column, line = (script.bits(name, "VALUE") for name in ("LAST_COLUMN", "LAST_LINE"))
    constants = {
        name: sum(field.reset << field.place.lsb for field in script.map[name].fields)
        for name in ("ID", "VERSION", "CONFIG_0", "CONFIG_1")
    }
    for _ in range(8):
        last = {}
        for _ in range(12):
            name, mask = (("LAST_COLUMN", column), ("LAST_LINE", line))[int(rng.integers(2))]
            last[name] = int(rng.integers(mask + 1))
            script.write(name, last[name], at_once=True)
            if rng.random() < 0.2:
                script.write("ID", int(rng.integers(1 << 32)), SLVERR, at_once=True)
            chosen = list(constants)[int(rng.integers(4))]
            script.read(chosen, constants[chosen], at_once=True)
            if rng.random() < 0.2:
                script.read(0x80, 0, FULL, DECERR, at_once=True)
        script.answered()
        for name, value in last.items():
            script.read(name, value)
    script.write("ERROR", FULL)
    script.read("ERROR", 0)
    return script
