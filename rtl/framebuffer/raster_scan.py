"""The raster scan: walks the lines of a frame, and fills in background."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import stream, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.lib.mux import pick

from .layouts import (
    ColourBeatLayout,
    ColourWordLayout,
    SettingsLayout,
    bus_pixels,
    word_address_bits,
)

__all__ = ["RasterScan"]


class RasterScan(wiring.Component):
    """Makes the lines of a frame of its beats, bus word by bus word.

    A line is written if a beat lies on it, or if the buffer holds something there: a memory has a
    bit for each line and buffer, which is 1 if the line was drawn into when it was last written.
    All other lines are skipped. Of a line that is written, pixels that no beat has are background.

    A bus word waits for the beat that comes after it in the frame, or for the end beat. After the
    last line all beats are taken up to the end beat.

    **Latency**: 4 cycles from ``start`` to the first word. **Throughput**: a bus word a cycle; 2
    cycles more for each line, written or not.

    Parameters
    ----------
    config
        The engine's configuration.
    data_bits
        Bits of a bus word.

    Members
    -------
    beats : In(stream of ColourBeatLayout)
        The frame, with its end beat.
    start : In(1)
        Begin a frame.
    settings : In(SettingsLayout)
        Its settings; steady until ``done``.
    buffer : In(1)
        Its buffer; steady until ``done``.
    rewrite : In(1)
        Write every line; steady until ``done``.
    words : Out(stream of ColourWordLayout)
        The bus words, in the order of their addresses within a line.
    done : Out(1)
        The end beat is taken in this cycle, and the last word has been offered.
    """

    def __init__(self, config: EngineConfig, data_bits: int):
        self.config = config
        self.data_bits = data_bits
        super().__init__(
            {
                "beats": In(stream.Signature(ColourBeatLayout(config))),
                "start": In(1),
                "settings": In(SettingsLayout(config)),
                "buffer": In(1),
                "rewrite": In(1),
                "words": Out(stream.Signature(ColourWordLayout(config, data_bits))),
                "done": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config, settings, beat = self.config, self.settings, self.beats.payload
        skipped_bits = (bus_pixels(self.data_bits) - 1).bit_length()
        parts = config.raster_pixels // bus_pixels(self.data_bits)
        part_bits = (parts - 1).bit_length()
        line = Signal(config.line_bits)
        line_address = Signal(word_address_bits(self.data_bits), reset_less=True)
        column = Signal(config.x_bits - skipped_bits)  # in bus words
        here = Signal()
        drawn = Signal()
        at_last = Signal()
        room = Signal()
        issue = Signal()
        write = Signal()
        leave = Signal()
        dirty = self._dirty_lines(m, line, write, here)
        low_bits = len(settings.buffers[0]) - len(line_address)
        m.d.comb += [
            here.eq(self.beats.valid & ~beat.end & (beat.line == line)),
            drawn.eq(here & (beat.word == column[part_bits:])),
            at_last.eq(column == settings.last_column[skipped_bits:]),
            room.eq(~self.words.valid | self.words.ready),
        ]
        with m.FSM():
            with m.State("IDLE"):
                base = pick([settings.buffers[0], settings.buffers[1]], self.buffer)
                m.d.sync += [line.eq(0), line_address.eq(base[low_bits:])]
                with m.If(self.start):
                    m.next = "LOOK"
            with m.State("LOOK"):  # the memory of dirty lines takes a cycle
                m.d.sync += column.eq(0)
                m.next = "DECIDE"
            with m.State("DECIDE"):
                m.d.comb += write.eq(self.beats.valid & (here | dirty | self.rewrite))
                m.d.comb += leave.eq(self.beats.valid & ~write)
                with m.If(write):
                    m.next = "FILL"
                self._leave(m, leave, line)
            with m.State("FILL"):
                whole = Cat(column[:part_bits]).all() | at_last
                m.d.comb += issue.eq(self.beats.valid & room)
                m.d.comb += self.beats.ready.eq(room & drawn & whole)
                m.d.comb += leave.eq(issue & at_last)
                with m.If(issue):
                    m.d.sync += column.eq(column + 1)
                self._leave(m, leave, line)
            with m.State("FINISH"):
                m.d.comb += self.beats.ready.eq(1)
                m.d.comb += self.done.eq(self.beats.valid & beat.end)
                with m.If(self.done):
                    m.next = "IDLE"
        with m.If(leave):
            m.d.sync += [
                line.eq(line + 1),
                line_address.eq(line_address + settings.stride[low_bits:]),
            ]
        self._words(m, room, issue, drawn, column, part_bits, line_address, at_last)
        return m

    def _dirty_lines(self, m, line, write, drawn):
        """Return whether the buffer holds something on the line, which was set a cycle before."""
        m.submodules.dirty_lines = memory = Memory(shape=1, depth=2 << len(line), init=[])
        read, written = memory.read_port(), memory.write_port()
        place = Cat(line, self.buffer)
        m.d.comb += [
            read.addr.eq(place),
            written.addr.eq(place),
            written.data.eq(drawn),
            written.en.eq(write),
        ]
        return read.data

    def _leave(self, m, leave, line):
        """Go to the next line, or behind the last one."""
        with m.If(leave):
            with m.If(line == self.settings.last_line):
                m.next = "FINISH"
            with m.Else():
                m.next = "LOOK"

    def _words(self, m, room, issue, drawn, column, part_bits, line_address, at_last):
        """Offer a bus word: a part of the beat's pixels."""
        pixels = bus_pixels(self.data_bits)
        beat, word = self.beats.payload, self.words.payload
        part = column[:part_bits]

        def part_of(field):
            bits = Value.cast(field)
            width = len(bits) * pixels // self.config.raster_pixels
            return pick([bits[at : at + width] for at in range(0, len(bits), width)], part)

        valid = Signal()
        offered = Signal(word.shape(), reset_less=True)
        m.d.comb += [self.words.valid.eq(valid), word.eq(offered)]
        with m.If(room):
            m.d.sync += valid.eq(issue)
        with m.If(issue):
            m.d.sync += [
                offered.colour.eq(part_of(beat.colour)),
                offered.drawn.eq(Mux(drawn, part_of(beat.drawn), 0)),
                offered.address.eq(Mux(column == 0, line_address, offered.address + 1)),
                offered.last.eq(at_last),
            ]
