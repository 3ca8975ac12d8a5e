"""Assertions of what a window gives: a pixel leaves with its line, and beats are in order."""

from typing import NamedTuple

from amaranth.hdl import Cat, Mux, Signal, Value
from amaranth.lib import data

from tests.formal.properties import Properties

__all__ = ["FollowedPixel"]


class Due(NamedTuple):
    """The pixel of the line that has the place, now and a cycle before.

    Parameters
    ----------
    owner, owner_before
        The line and its frame.
    due, due_before
        The depth that is to leave.
    gone, gone_before
        It has left.
    passed
        The line is another than a cycle before.
    again
        It was loaded after it had left.
    """

    owner: Value
    owner_before: Value
    due: Value
    due_before: Value
    gone: Value
    gone_before: Value
    passed: Value
    again: Value


class Left(NamedTuple):
    """The lines that lost their place and are still to leave, oldest first.

    Parameters
    ----------
    kept
        The registers.
    queue
        The same with the line that lost its place in this cycle.
    length_before, length
        The lines in each.
    """

    kept: list
    queue: list
    length_before: Value
    length: Value


class FollowedPixel(Properties):
    """Any one pixel of a window, from when it is drawn or loaded until it leaves.

    Its sub-class says which pixel that is, which line has its place, and what depth it is drawn
    with.
    """

    def _is_mine(self, beat):
        """Return whether a beat has the place of the pixel in its line."""
        return beat.word == self.word[self.config.raster_words - 1 :]

    def _depth(self, beat):
        """Return the depth of the pixel in a beat of its place."""
        return beat.pixels.depth[self._pixel()]

    def _pixel(self):
        """Return the number of the pixel in its beat."""
        return Cat(self.number, self.word[: self.config.raster_words - 1])

    def _follow(self, m, drawn, loaded):
        """Assert that the pixel leaves with its line as it was drawn, or not at all."""
        raster, beat = self.dut.raster, self.dut.raster.payload
        inside = Signal()
        m.d.comb += inside.eq(Cat(self.number, self.word) <= self.last_column)
        now = self._due(m, drawn, loaded, inside)
        left = self._left(m, now)
        mine, first, second = Signal(), Signal(), Signal()
        source = Signal(self._place_of_a_line())  # the line and the frame that the beat is of
        frame = Signal()
        m.d.sync += frame.eq(frame ^ (raster.valid & raster.ready & beat.end))
        depth = Signal(self.config.depth_bits)
        m.d.comb += [
            depth.eq(self._depth(beat)),
            mine.eq(
                raster.valid
                & ~beat.end
                & (beat.line[: self.config.slot_bits] == self.slot)
                & self._is_mine(beat)
            ),
            source.line.eq(beat.line),
            source.frame.eq(frame),
            first.eq(
                mine & (left.length != 0) & (source.as_value() == left.queue[0].owner.as_value())
            ),
            second.eq(mine & ~first & (source.as_value() == now.owner.as_value()) & ~now.gone),
        ]
        self._remove(m, now, left, first & raster.ready, second & raster.ready)
        background = self.config.background_depth
        due_now = Mux(first, left.queue[0].depth, Mux(second, now.due, background))
        self.always(m, "pixel", ~mine | (depth == due_now))
        colour = Mux(depth == background, 0, depth)
        self.always(m, "colour", ~mine | (beat.pixels.colour[self._pixel()] == colour))
        self._complete(m, now, left.length, first & raster.ready, second & raster.ready)
        self._stream(m)

    def _place_of_a_line(self):
        """Return the layout of a line of a frame."""
        return data.StructLayout({"line": len(self.line), "frame": 1})

    def _due(self, m, drawn, loaded, inside):
        """Return what was drawn on the line that has the place, and whether it has left already."""
        background, width = self.config.background_depth, self.config.depth_bits
        owner, owner_before = Signal(self._place_of_a_line()), Signal(self._place_of_a_line())
        m.d.comb += [owner.line.eq(self.line), owner.frame.eq(self.owner)]
        due_before, gone_before = Signal(width, init=background), Signal()
        due, gone = Signal(width), Signal()
        new = Signal(width)
        passed = Signal()
        again = Signal()  # it was loaded once more, and has to leave once more
        m.d.comb += [
            # The line that has the place is another: the one before is on its way out, or empty.
            passed.eq(owner.as_value() != owner_before.as_value()),
            due.eq(Mux(passed, background, due_before)),
            gone.eq(~passed & gone_before),
            new.eq(Mux(drawn, self.drawn_depth, self._depth(self.dut.initial.payload))),
        ]
        m.d.sync += [owner_before.eq(owner), due_before.eq(due)]
        with m.If((drawn | loaded) & inside & (new < due)):
            m.d.sync += due_before.eq(new)
        if self.ordered:
            self.always(m, "not_drawn_after", ~(gone & (drawn | loaded)))
            # A load keeps nothing of what was there.
            self.always(m, "loaded_first", ~(loaded & inside) | (due == background))
        else:
            with m.If(gone & loaded & inside & (new != background)):
                m.d.comb += again.eq(1)
        return Due(owner, owner_before, due, due_before, gone, gone_before, passed, again)

    def _left(self, m, now):
        """Return the lines that lost their place and are still to leave."""
        pixel = data.StructLayout(
            {"owner": self._place_of_a_line(), "depth": self.config.depth_bits}
        )
        kept = [Signal(pixel, name=f"kept_{n}") for n in range(2)]
        queue = [Signal(pixel, name=f"queue_{n}") for n in range(2)]
        length_before, length = Signal(2), Signal(2)
        pushed = Signal()
        background = self.config.background_depth
        m.d.comb += [
            pushed.eq(now.passed & (now.due_before != background) & ~now.gone_before),
            length.eq(length_before + pushed),
        ]
        for n in range(2):
            with m.If(pushed & (length_before == n)):
                m.d.comb += [
                    queue[n].owner.eq(now.owner_before),
                    queue[n].depth.eq(now.due_before),
                ]
            with m.Else():
                m.d.comb += queue[n].eq(kept[n])
        self.always(m, "room", length <= 2)
        return Left(kept, queue, length_before, length)

    def _remove(self, m, now, left, first, second):
        """Remove what leaves: the first line that lost its place, or the one that has it."""
        m.d.sync += [left.kept[n].eq(left.queue[n]) for n in range(2)]
        m.d.sync += [
            left.length_before.eq(left.length),
            now.gone_before.eq((now.gone & ~now.again) | second),
        ]
        with m.If(first):
            m.d.sync += [
                left.kept[0].eq(left.queue[1]),
                left.length_before.eq(left.length - 1),
            ]

    def _complete(self, m, now, length, first, second):
        """Assert that all lines leave, in time, and before their frame is over."""
        dut = self.dut
        waited = Signal(3)
        with m.If((length == 0) | first):
            m.d.sync += waited.eq(0)
        with m.Elif(dut.raster.ready & ~waited.all()):
            m.d.sync += waited.eq(waited + 1)
        self.always(m, "leaves", waited < self.delay)
        self.always(m, "complete", ~dut.finished | (length - first == 0))
        with m.If(dut.finished):
            # Of the frame that leaves; the next one's lines may be drawn by now.
            left = (now.due == self.config.background_depth) | now.gone | second
            self.always(m, "empty", left | (self.is_drawn & dut.closing))

    def _stream(self, m):
        """Assert that beats are in order, are not background, and that one ends the frame."""
        config, raster = self.config, self.dut.raster
        beat = raster.payload
        taken = raster.valid & raster.ready
        place = Signal(config.word_bits + config.line_bits + 1)
        last = Signal.like(place)
        ended = Signal()
        m.d.comb += place.eq(Cat(beat.word, beat.line) + 1)
        with m.If(taken):
            m.d.sync += last.eq(Mux(beat.end, 0, place))
        with m.If(self.dut.finished):
            m.d.sync += ended.eq(1)
        with m.Elif(taken & beat.end):
            m.d.sync += ended.eq(0)
        shown = Cat(depth != config.background_depth for depth in beat.pixels.depth).any()
        self.always(m, "steady", self.steady(m, raster, "raster"))
        self.always(m, "end", ~raster.valid | (beat.end == ended))
        self.always(m, "order", ~raster.valid | beat.end | ((place > last) & shown))
