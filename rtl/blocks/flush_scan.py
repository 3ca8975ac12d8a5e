"""The flush scan of the blocks engine."""

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
    """Scans retired lines and requests a flush of every dirty beat.

    Line n of the image is in slot n mod ``window_lines``. ``oldest`` is the first line that has not
    left. The window holds it and the ``window_lines - 1`` lines after it. Lines above ``top`` are
    retired. Once a frame is closed, all of its lines are retired, and ``top`` and all writes are of
    the next frame (see :class:`FrameOverlap`).

    A clean line leaves in one cycle. If all lines of the window are clean, all retired ones leave
    in one cycle. The dirty bits of other lines are taken a stretch at a time, while the last beat
    of the stretch before is requested. ``line`` is therefore ``oldest`` or a line after it. A
    stretch without recent writes is skipped (``_reached``).

    **Latency**: 2 cycles from a complete line to its first beat. **Throughput**: one beat a cycle,
    or one stretch without dirty bits.

    Members
    -------
    top : In(signed(line_bits + 2))
        Lines above this one are complete: they are not written in this cycle or later. Never falls
        during a frame.
    close : In(1)
        The frame that is drawn is complete; never while ``closing``.
    limit : In(signed(line_bits + 2))
        Lines above this one have received their initial raster.
    jump : In(1)
        The initial raster has ended. ``limit`` means nothing, and many lines may leave at a time.
    enable : In(8)
        By residue, if it is that of ``line``: dirty bits may be taken. None of the residue's lines
        is written in this cycle.
    drawing : In(1)
        The words of ``touch`` are written in this cycle.
    touch : In(8 x 2)
        By residue of the line modulo 8: a block is drawn into an odd word, and into an even one.
    group : In(8 x group_bits)
        Slots of those lines, or of the line that is loaded, without the three lowest bits.
    words : In(2 x word_bits)
        The block's two words. The second is one more than the first.
    reaching : In(1)
        ``words`` may be written in this cycle; high whenever ``drawing`` is.
    load : In(8)
        By residue of the line, the beat of ``load_word`` is written in this cycle.
    load_word : In(word_bits)
        A word of the initial raster.
    lone : In(8)
        By residue of the line, the beat of ``load_word`` may be written, and ``words`` are not.
    wipe : In(1)
        Clear the dirty bits of all residues at ``wipe_row``.
    wipe_row : In
        Group of lines (high bits) and stretch.
    restart : In(1)
        The closed frame is over: continue with line 0 of the next.
    oldest : Out(line_bits + 1)
        First line in the window, in lines of the frame that leaves.
    line : Out(line_bits + 1)
        The line whose dirty bits are taken next.
    oldest_row, line_row : Out(8)
        Residues of ``oldest`` and ``line`` modulo 8, one-hot. They are registers of their own, as
        the path from them to the window's ``i.ready``, and to all stages before it, is long.
    takes : Out(1)
        ``line`` has dirty bits to take. They are taken in this cycle if its ``enable`` is high and
        the beats of the stretch before have been requested.
    front : Out(signed(line_bits + 2))
        First line in the window, in lines of the frame that is drawn.
    closing : Out(1)
        A closed frame is not over yet.
    empties : Out(1)
        At most one beat of ``oldest`` is left in the window. In the cycle in which it is flushed,
        the window moves to ``top``, if it is not there.
    over : Out(1)
        The closed frame has left the window.
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
                **dict.fromkeys(("close", "jump", "drawing"), In(1)),
                "enable": In(residues),
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
                "oldest_row": Out(residues, init=1),
                "line_row": Out(residues, init=1),
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
        asks = Signal()  # dirty bits are taken if they may be
        may = Signal.like(self.line_row)  # ``line_row``, if they may be
        take = Signal()  # they are
        m.d.comb += [
            self.line.eq(line),
            clean.eq(~written.any()),
            may.eq(self.line_row & self.enable),
            take.eq(asks & may.any()),
        ]
        leaving = self._look(m, frame_overlap, line, written, clean, left)
        stretch = self._stretches(m, line, clean, leaving.here, take, left)
        beats = self._beats(m, dirty_bits.taken, leaving, line, stretch, asks, take)
        # For each residue its own, as ``take`` is late.
        m.d.comb += dirty_bits.look.eq(may | self.wipe.replicate(len(may)))
        connect_dirty_bits(m, self, dirty_bits, asks, place, stretch)
        wraps = Cat(self._wraps(q, place) for q in range(config.tile_lines)).any()
        connect_frame_overlap(m, self, frame_overlap, line, leaving.goes, wraps, clean)
        m.d.comb += self.over.eq(frame_overlap.over & ~beats.any())
        mark_lines(m, self, written, left, place, self._written)
        with m.If(leaving.jumps):
            m.d.sync += [line.eq(self.top), self.line_row.eq(self._row_of(self.top))]
        with m.Elif(leaving.goes & ~frame_overlap.last):
            m.d.sync += [
                line.eq(leaving.looked_at),
                self.line_row.eq(self._row_of(leaving.looked_at)),
            ]
        with m.If(self.restart):
            m.d.sync += [line.eq(0), self.line_row.eq(1)]
        return m

    def _row_of(self, line):
        """Return the residue of a line, one-hot."""
        return 1 << line[: residue_bits(self.config)]

    def _look(self, m, frame_overlap, line, written, clean, left):
        """Look at a line a cycle ahead, while the line above it is still there."""
        config = self.config
        here = Signal()  # ``line`` is retired and dirty
        empty = Signal()  # ``line`` is retired and clean
        known = Signal()
        goes = Signal()
        leaving = Signal()
        jumps = Signal()
        free = Signal()  # nothing keeps the window from the line at ``top``
        looked_at = Signal.like(line)  # ``line``, or the next one once ``line`` is known
        complete = Signal()  # of the line that is looked at, as is ``loaded``
        loaded = Signal()
        m.d.comb += [
            known.eq(here | empty),
            goes.eq(left | empty),
            free.eq(self.jump & clean & ~frame_overlap.closing),
            jumps.eq((empty | complete) & free),
            complete.eq(looked_at < self.top),
            loaded.eq(looked_at < self.limit),
            leaving.eq(
                (frame_overlap.closing | (complete & (self.jump | loaded)))
                & ~frame_overlap.halted
                & ~(goes & frame_overlap.last)
                & ~jumps
            ),
        ]
        with m.If(~known | goes):
            is_written = written.bit_select(looked_at[: config.slot_bits], 1)
            m.d.sync += [here.eq(leaving & is_written), empty.eq(leaving & ~is_written)]
            with m.If(leaving):
                m.d.sync += looked_at.eq(looked_at + 1)
        with m.If(jumps):
            m.d.sync += looked_at.eq(self.top)
        with m.If(self.restart):
            m.d.sync += [here.eq(0), empty.eq(0), looked_at.eq(0)]
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

    def _beats(self, m, taken, leaving, line, stretch, asks, take):
        """Request the dirty beats of the stretch taken last; return those not flushed yet.

        The next dirty bits are taken while the last beat is flushed.
        """
        config = self.config
        beats, first, behind = (
            Signal(1 << mark_bits(config), name=name) for name in ("beats", "first", "behind")
        )
        asked_stretch = Signal.like(stretch)
        oldest = Signal.like(line)
        turns = Signal()
        m.d.comb += [
            first.eq(beats & (~beats + 1)),
            behind.eq(beats & ~first),
            turns.eq(~beats.any() | (self.flush.ready & ~behind.any())),
            asks.eq(leaving.here & turns),
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
            m.d.sync += [oldest.eq(0), self.oldest_row.eq(1)]
        with m.Elif(turns):
            m.d.sync += [
                oldest.eq(Mux(leaving.jumps, self.top, line)),
                self.oldest_row.eq(Mux(leaving.jumps, self._row_of(self.top), self.line_row)),
                asked_stretch.eq(stretch),
            ]
        return beats

    def _wraps(self, residue, place):
        """Return whether a line is written in a slot before ``place``."""
        bits = residue_bits(self.config)
        group, own = self.group[residue], place[bits:]
        return self._written(residue) & (
            (group < own) | ((group == own) & (place[:bits] > residue))
        )

    def _written(self, residue):
        """Return whether a line of this residue is written."""
        return (self.drawing & self.touch[residue].any()) | self.load[residue]

    def _reached(self, m, line, clean):
        """Return the stretches that may have dirty bits, for all lines of the window together.

        These are the stretches written since the window was last clean, in this lap of ``line`` or
        in the one before. All beats of earlier laps have left.
        """
        config = self.config
        now, before = (Signal(1 << stretch_bits(config), name=name) for name in ("now", "before"))
        reach = Signal.like(now)
        turn = Signal()
        turned = Signal()
        low = 1 + mark_bits(config)  # of a word's number, within its stretch
        own = Signal.like(now)
        beyond = Signal()
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
