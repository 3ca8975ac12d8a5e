"""The way along the lines that leave rows of lanes: to each beat that was written, and no other."""

from typing import NamedTuple

from amaranth.hdl import Cat, Const, Module, Mux, Signal, Value, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import PlaceLayout
from splatline.rtl.lib.mux import number_of
from splatline.rtl.window.flush_scan import (
    connect_dirty_bits,
    connect_frame_overlap,
    mark_lines,
)
from splatline.rtl.window.frame_overlap import FrameOverlap

from .dirty_bits import BlockDirtyBits, mark_bits, residue_bits, stretch_bits

__all__ = ["BlockFlushScan"]


class Leaving(NamedTuple):
    """State of the line that is scanned.

    Parameters
    ----------
    here
        It is retired and dirty.
    goes
        It leaves in this cycle.
    jumps
        All retired lines leave in this cycle.
    free
        All lines are clean, loaded and of the frame that is drawn.
    looked_at
        The line whose state is known in the next cycle.
    """

    here: Value
    goes: Value
    jumps: Value
    free: Value
    looked_at: Value


class BlockFlushScan(wiring.Component):
    """Asks for each written beat of the lines that no later element touches to be flushed.

    Line n of the image stands in place n mod ``window_lines`` of the window. ``oldest`` is the
    first line that has not left: it and the ``window_lines - 1`` after it are in the window, those
    above ``top`` are on their way out. Once a frame was closed, they all are, and ``top`` and what
    is written are the next frame's (see :class:`FrameOverlap`). A line that nothing was written
    into leaves in one cycle, and all at once if none was written.

    Of others the marks are taken a stretch at a time, while the last beat of the stretch before is
    asked for: ``line`` is ``oldest``, or lies below it. A stretch that nothing has reached for long
    is passed over (``_reached``).

    **Latency**: 2 cycles from a complete line to its first beat. **Throughput**: one beat a cycle,
    or a stretch without marks.

    Members
    -------
    top : In(signed(line_bits + 2))
        Lines above this one are complete: nothing is drawn into them in this cycle, nor later.
        Never falls during a frame.
    close : In(1)
        The frame at hand is complete; not while ``closing``.
    limit : In(signed(line_bits + 2))
        Lines above this one have received all of the initial raster that is meant for them.
    jump : In(1)
        No initial raster will come for any line, and ``limit`` means nothing: lines may leave many
        at a time.
    enable : In(1)
        Marks may be taken: nothing is touched or loaded in lines of the residue of ``line``.
    drawing : In(1)
        What ``touch`` says is written in this cycle.
    touch : In(8 x 2)
        By residue of the line: whether a block is drawn into an odd word, and into an even one.
    group : In(8 x group_bits)
        Places in the window of those lines, or of the one that is loaded, but for the three lowest
        bits.
    words : In(2 x word_bits)
        The block's two words, the second one more than the first.
    reaching : In(1)
        Something may be written in this cycle into ``words``; at least if ``drawing``.
    load : In(8)
        By residue of the line, the beat of ``load_word`` is written in this cycle.
    load_word : In(word_bits)
        A word of the initial raster.
    lone : In(8)
        By residue of the line, it may be that beat that is written, and not ``words``.
    wipe : In(1)
        Clear the marks of all lines' stretches at ``wipe_row``.
    wipe_row : In
        Group of lines (high bits) and stretch.
    restart : In(1)
        The closed frame is over: go on with line 0 of the next.
    oldest : Out(line_bits + 1)
        First line in the window, of the frame that leaves.
    line : Out(line_bits + 1)
        The line whose marks are taken next.
    takes : Out(1)
        They are about to be taken; if ``enable`` and what is asked for let them, in this cycle.
    front : Out(signed(line_bits + 2))
        First line in the window, of the frame that is drawn.
    closing : Out(1)
        A frame was closed and is not over.
    empties : Out(1)
        Nothing is left in the window but one beat of ``oldest`` at most: as soon as that goes, the
        window comes to what is ``top`` now, unless it is there.
    over : Out(1)
        Nothing of the closed frame is in the window any more.
    flush : Out(stream of PlaceLayout)
        The even word of each beat to read and clear.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        residues = config.tile_lines
        super().__init__(
            {
                "top": In(signed(config.line_bits + 2)),
                "limit": In(signed(config.line_bits + 2)),
                **dict.fromkeys(("close", "jump", "enable", "drawing"), In(1)),
                "touch": In(data.ArrayLayout(2, residues)),
                "group": In(data.ArrayLayout(config.group_bits, residues)),
                "words": In(data.ArrayLayout(config.word_bits, 2)),
                "reaching": In(1),
                "load": In(residues),
                "load_word": In(config.word_bits),
                "lone": In(residues),
                "wipe": In(1),
                "wipe_row": In(stretch_bits(config) + config.group_bits),
                "restart": In(1),
                "oldest": Out(config.line_bits + 1),
                "line": Out(config.line_bits + 1),
                "takes": Out(1),
                "front": Out(signed(config.line_bits + 2)),
                "closing": Out(1),
                "empties": Out(1),
                "over": Out(1),
                "flush": Out(stream.Signature(PlaceLayout(config))),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        m.submodules.dirty_bits = dirty_bits = BlockDirtyBits(config)
        m.submodules.frame_overlap = frame_overlap = FrameOverlap(config)
        line = Signal.like(self.line)
        place = line[: config.slot_bits]
        written = Signal(config.window_lines)  # dirty lines, by slot
        clean = Signal()
        left = Signal()  # the last dirty bits of ``line`` are taken
        take = Signal()  # dirty bits are taken
        m.d.comb += [self.line.eq(line), clean.eq(~written.any())]
        leaving = self._look(m, frame_overlap, line, written, clean, left)
        stretch = self._stretches(m, line, clean, leaving.here, take, left)
        beats = self._beats(m, dirty_bits.taken, leaving, line, stretch, take)
        m.d.comb += dirty_bits.look.eq(self.enable | self.wipe)
        connect_dirty_bits(m, self, dirty_bits, take, place, stretch)
        wraps = Cat(self._wraps(q, place) for q in range(config.tile_lines)).any()
        connect_frame_overlap(m, self, frame_overlap, line, leaving.goes, wraps, clean)
        m.d.comb += self.over.eq(frame_overlap.over & ~beats.any())
        mark_lines(m, self, written, left, place, self._written)
        with m.If(leaving.jumps):
            m.d.sync += line.eq(self.top)
        with m.Elif(leaving.goes & ~frame_overlap.last):
            m.d.sync += line.eq(leaving.looked_at)
        with m.If(self.restart):
            m.d.sync += line.eq(0)
        return m

    def _look(self, m, frame_overlap, line, written, clean, left):
        """Look at a line a cycle ahead, while the line above it is still there."""
        config = self.config
        here, empty = Signal(), Signal()  # ``line`` is retired, and dirty or clean
        known, goes = Signal(), Signal()
        leaving, jumps = Signal(), Signal()
        free = Signal()  # nothing keeps the window from the line at ``top``
        looked_at = Signal.like(line)  # ``line``, or the next one once ``line`` is known
        complete, loaded = Signal(), Signal()  # the line that is looked at
        m.d.comb += [
            known.eq(here | empty),
            goes.eq(left | empty),
            free.eq(self.jump & clean & ~frame_overlap.closing),
            jumps.eq((empty | complete) & free),
            looked_at.eq(line + known),
            complete.eq(looked_at < self.top),
            loaded.eq(looked_at < self.limit),
            leaving.eq(
                (frame_overlap.closing | (complete & (self.jump | loaded)))
                & ~frame_overlap.halted
                & ~(goes & frame_overlap.last)
                & ~jumps
            ),
        ]
        with m.If(self.restart):
            m.d.sync += [here.eq(0), empty.eq(0)]
        with m.Elif(~known | goes):
            is_written = written.bit_select(looked_at[: config.slot_bits], 1)
            m.d.sync += [here.eq(leaving & is_written), empty.eq(leaving & ~is_written)]
        return Leaving(here, goes, jumps, free, looked_at)

    def _stretches(self, m, line, clean, here, take, left):
        """Return the stretch of ``line`` whose dirty bits are taken next.

        Stretches without recent writes are skipped. The stretch is a register.
        """
        config = self.config
        ahead = Signal(1 << stretch_bits(config), init=-1)  # stretches that are still to be taken
        reached, wanted, rest, soon = (
            Signal.like(ahead, init=0, name=name) for name in ("reached", "wanted", "rest", "soon")
        )
        stretch_bit = Signal.like(ahead, init=0)
        stretch = Signal(stretch_bits(config))
        m.d.comb += [
            reached.eq(self._reached(m, line, clean)),
            wanted.eq(reached & ahead),
            rest.eq(wanted & ~stretch_bit),
            left.eq(take & ~rest.any()),
            soon.eq(Mux(here & rest.any(), rest, reached)),
        ]
        lowest = soon & (~soon + 1)
        with m.If(take | ~here):
            m.d.sync += [stretch_bit.eq(lowest), stretch.eq(number_of(lowest, len(stretch)))]
        with m.If(left):
            m.d.sync += ahead.eq(-1)
        with m.Elif(take):
            m.d.sync += ahead.eq(rest)
        return stretch

    def _beats(self, m, taken, leaving, line, stretch, take):
        """Request the dirty beats of the stretch taken last; return those not flushed yet.

        The next dirty bits are taken while the last beat is flushed.
        """
        config = self.config
        beats, first, behind = (
            Signal(1 << mark_bits(config), name=name) for name in ("beats", "first", "behind")
        )
        asked_stretch, oldest = Signal.like(stretch), Signal.like(line)
        turns = Signal()
        m.d.comb += [
            first.eq(beats & (~beats + 1)),
            behind.eq(beats & ~first),
            turns.eq(~beats.any() | (self.flush.ready & ~behind.any())),
            take.eq(leaving.here & turns & self.enable),
            self.takes.eq(leaving.here),
            self.flush.valid.eq(beats.any()),
            self.flush.payload.word.eq(
                Cat(Const(0, 1), number_of(first, mark_bits(config)), asked_stretch)
            ),
            self.flush.payload.line.eq(oldest),
            self.oldest.eq(oldest),
            self.empties.eq(~behind.any() & leaving.free),
        ]
        with m.If(take):
            m.d.sync += beats.eq(taken)
        with m.Elif(self.flush.ready):
            m.d.sync += beats.eq(behind)
        with m.If(self.restart):
            m.d.sync += oldest.eq(0)
        with m.Elif(turns):
            m.d.sync += [oldest.eq(Mux(leaving.jumps, self.top, line)), asked_stretch.eq(stretch)]
        return beats

    def _wraps(self, residue, place):
        """Return whether a line is written whose place is before one."""
        bits = residue_bits(self.config)
        group, own = self.group[residue], place[bits:]
        return self._written(residue) & (
            (group < own) | ((group == own) & (place[:bits] > residue))
        )

    def _written(self, residue):
        """Return whether something is written into a line of this residue."""
        return (self.drawing & self.touch[residue].any()) | self.load[residue]

    def _reached(self, m, line, clean):
        """Return which stretches may have marks, for all lines of the window together.

        Those reached since the window was last clean, and since ``line`` last passed a multiple of
        the window's height but one: all that was written before that has left.
        """
        config = self.config
        now, before = (Signal(1 << stretch_bits(config), name=name) for name in ("now", "before"))
        reach = Signal.like(now)
        turn, turned = Signal(), Signal()
        low = 1 + mark_bits(config)  # of a word's number, within its stretch
        own, beyond = Signal.like(now), Signal()
        loaded = 1 << self.load_word[low:]
        m.d.comb += [
            turned.eq(line[config.slot_bits] != turn),
            own.eq(Mux(self.reaching, 1 << self.words[0][low:], 0)),
            beyond.eq(self.words[0][:low].all()),
            reach.eq(
                own
                | Mux(beyond, own.rotate_left(1), 0)
                | (loaded & self.load.any().replicate(len(reach)))
            ),
        ]
        m.d.sync += [
            turn.eq(line[config.slot_bits]),
            now.eq(Mux(clean | turned, 0, now) | reach),
            before.eq(Mux(clean, 0, Mux(turned, now, before))),
        ]
        return now | before
