"""What is written to and read from an engine's registers, and what must come of it."""

import dataclasses

import numpy as np

from splatline.contract.raster_beats import from_beats
from splatline.host.device.driver import Driver
from splatline.sim import golden
from tests.rtl.bus.axi_cases import HEIGHT, WIDTH, case, initial_of, right, send, setup
from tests.support.bus_words import block, end

__all__ = ["BUS"]

OKAY, SLVERR, DECERR = 0, 2, 3
BUS = {}


def refused(device, response, name, offset, data=None):
    """A read, or a write of bytes, is refused, and the bit says so; nothing else is told."""
    engine = Driver(device)
    engine.set("CONTROL")  # not quiet
    for answer in (response, OKAY):
        if data is None:
            assert device.command("read", offset) == (0, answer)
        else:
            assert device.command("write", offset, data) == answer
        assert engine.errors() == [name]
        engine.set("ERROR", **{name: 1})
        assert engine.errors() == []
        engine.set("CONTROL", QUIET=1)  # answered OKAY, and told all the same


def bytes_of(value):
    return value.to_bytes(4, "little")


@case(BUS)
def nothing_at_an_address(device):
    registers = Driver(device).registers
    beyond = registers.registers[-1].offset + 4
    window = registers.materials
    offsets = [beyond, 0x80, 0x1000, 0x1FFC, window.offset + window.entries * window.stride, 0x3FFC]
    offsets += [window.offset + 4 * n for n in range(window.words, window.stride // 4)]
    for offset in offsets:
        refused(device, DECERR, "BUS_ADDRESS", offset)
        refused(device, DECERR, "BUS_ADDRESS", offset, bytes_of(0))
    right(device)


@case(BUS)
def writes_of_what_is_read_only(device):
    registers = Driver(device).registers
    for register in registers.registers:
        if not register.writable:
            refused(device, SLVERR, "BUS_ACCESS", register.offset, bytes_of(0))
    right(device)


@case(BUS)
def reads_of_what_is_written_only(device):
    registers = Driver(device).registers
    offsets = [register.offset for register in registers.registers if not register.readable]
    assert registers["AMBIENT_BLUE"].offset in offsets
    for offset in (*offsets, registers.materials.offset + 8):
        refused(device, SLVERR, "BUS_ACCESS", offset)
    right(device)


@case(BUS)
def reads_of_some_bytes(device):
    """The two lowest bits of an address are ignored."""
    offset = Driver(device).registers["ID"].offset
    whole, _ = device.command("read", offset)
    for byte in range(1, 4):
        found = device.command("read", offset + byte, 4 - byte)
        assert found == (whole >> 8 * byte, OKAY)
    right(device)


@case(BUS)
def writes_of_some_bytes(device):
    registers = Driver(device).registers
    before = device.read32(registers["LAST_LINE"].offset)
    for register in ("LAST_LINE", "CONTROL", "AMBIENT_RED"):
        offset = registers[register].offset
        refused(device, SLVERR, "BUS_STROBE", offset, b"\x01")
        refused(device, SLVERR, "BUS_STROBE", offset + 1, b"\x00\x00\x00")
    refused(device, SLVERR, "BUS_STROBE", registers.materials.offset, b"\x01\x02")
    assert device.read32(registers["LAST_LINE"].offset) == before
    right(device)


@case(BUS)
def bits_that_a_register_lacks(device):
    registers = Driver(device).registers
    for register in registers.registers:
        if 0 < register.accepted < 0xFFFF_FFFF and register.name != "CONTROL":
            lacking = 1 << register.writable.bit_length()
            before = register.readable and device.read32(register.offset)
            refused(device, SLVERR, "BUS_VALUE", register.offset, bytes_of(lacking))
            assert before == (register.readable and device.read32(register.offset))
    window = registers.materials
    if window.writable[-1] != 0xFFFF_FFFF:
        last = window.offset + 4 * (window.words - 1)
        refused(device, SLVERR, "BUS_VALUE", last, bytes_of(window.writable[-1] + 1))
    right(device)


@case(BUS)
def an_interrupt_is_acknowledged_with_what_was_read(device):
    """IRQ_STATUS is read and written back, and so is ERROR, also with ones where no bit is."""
    engine, frame = setup(device, 23)
    status, error = (engine.registers[name].offset for name in ("IRQ_STATUS", "ERROR"))
    engine.set("IRQ_ENABLE", FRAME_DONE=1, ERROR=1)
    for quiet in (0, 1):
        engine.set("CONTROL", QUIET=quiet)
        send(device, "codewords", frame.codewords[:-1])  # without its end word
        device.receive()
        assert device.command("irq") == 1
        seen, response = device.command("read", status)
        assert (seen, response) == (0b11, OKAY)
        assert device.command("write", status, bytes_of(seen)) == OKAY
        assert device.command("read", status) == (0b10, OKAY)  # as long as ERROR has a bit
        assert engine.errors() == ["FRAME_ENDED_EARLY"]
        value = 0xFFFF_FFFF if quiet else device.read32(error)
        assert device.command("write", error, bytes_of(value)) == OKAY
        assert device.command("read", status) == (0, OKAY)
        assert device.command("irq") == 0
        assert engine.errors() == []
    engine.set("CONTROL")
    engine.set("IRQ_ENABLE")
    right(device)


@case(BUS)
def what_was_read_can_be_written_back(device):
    engine = Driver(device)
    for register in engine.registers.registers:
        if register.readable and register.writable:
            value = device.read32(register.offset)
            assert device.command("write", register.offset, bytes_of(value)) == OKAY
            assert engine.errors() == []
    right(device)


@case(BUS)
def one_write_with_two_errors(device):
    """The highest byte of a register alone, with a bit that the register does not have."""
    engine = Driver(device)
    engine.set("CONTROL")  # not quiet
    offset = engine.registers["LAST_LINE"].offset
    assert device.command("write", offset + 3, b"\x80") == SLVERR
    assert sorted(engine.errors()) == ["BUS_STROBE", "BUS_VALUE"]
    engine.set("ERROR", BUS_STROBE=1, BUS_VALUE=1)
    right(device)


@case(BUS)
def tables_written_in_mid_frame(device):
    """Refused, and changing nothing: neither of this frame nor of the next with the same tables."""
    engine, frame = setup(device, 20)
    device.command("pause", "raster", True)
    device.send(frame.codewords)
    device.command("wait", 200)
    assert engine.get("STATUS", "BUSY")
    window = engine.registers.materials
    offsets = [r.offset for r in engine.registers.registers if r.between_frames]
    offsets += [window.offset + 4 * n for n in range(2 * window.words)]
    assert len(offsets) > 8
    for offset in offsets:
        refused(device, SLVERR, "BUS_BUSY", offset, bytes_of(1))
    device.command("pause", "raster", False)
    expected = golden.render(frame)
    beats = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
    assert from_beats(beats, WIDTH, HEIGHT, engine.config).mismatches(expected) == 0
    assert engine.draw(frame.codewords).mismatches(expected) == 0
    right(device)


@case(BUS)
def a_frame_is_open_behind_others_that_wait(device):
    """End beats wait to be taken, and behind them a frame that has been read but not sent."""
    engine, frame = setup(device, 22)
    device.command("pause", "raster", True)
    ends = [end(engine.config)]
    blocks = np.array([*(block(engine.config, 9 * n) for n in range(5)), *ends], np.uint64)
    for words in (ends, ends, ends, blocks):
        send(device, "codewords", words)
    device.command("wait", 400)
    device.command("pause", "raster", False)
    device.command("wait", 5)
    device.command("pause", "raster", True)
    device.command("wait", 200)
    assert engine.get("FRAMES") % 4 == 3
    assert engine.get("STATUS", "BUSY")
    refused(device, SLVERR, "BUS_BUSY", engine.registers["LAST_LINE"].offset, bytes_of(1))
    device.command("pause", "raster", False)
    for _ in range(3):
        assert len(device.receive()) == 1
    beats = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
    expected = golden.render(dataclasses.replace(frame, codewords=blocks))
    assert from_beats(beats, WIDTH, HEIGHT, engine.config).mismatches(expected) == 0
    right(device)


@case(BUS)
def nothing_passes_within_a_cycle(device):
    """Inputs turned over between two edges move no output, in whatever state of a frame."""
    engine, frame = setup(device, 21)
    start, beats = initial_of(frame, 8)
    engine.set("START", LOAD=1)
    device.command("stall", 0.3, 8)
    device.send(frame.codewords, engine.widen(beats))
    assert device.command("turn_over", 600) == []
    drawn = device.receive()[:, : -(-engine.config.raster_end.end // 64)]
    picture = from_beats(drawn, WIDTH, HEIGHT, engine.config)
    assert picture.mismatches(golden.render(frame, start)) == 0
    right(device)
