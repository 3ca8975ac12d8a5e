"""The flush scan of the tiles engine."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal, signed
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

from .dirty_bits import RESIDUES, TileDirtyBits, mark_bits, stretches

__all__ = ["TileFlushScan"]


class TileFlushScan(wiring.Component):
    """Scans retired lines and requests a flush of every dirty word.

    Line n of the image is in slot n mod ``window_lines``. ``oldest`` is the first line that has not
    left. The window holds it and the ``window_lines - 1`` lines after it. Lines above ``top`` are
    retired. Once a frame is closed, all of its lines are retired, and ``top`` and all writes are of
    the next frame (see :class:`FrameOverlap`).

    A clean line leaves in one cycle. If all lines of the window are clean, all retired ones leave
    in one cycle. The dirty bits of other lines are taken a stretch at a time, in a cycle without
    writes (``taking``). Each pair of words with a dirty bit is then requested. A stretch without
    recent writes is skipped (``_reached``).

    With ``flush_words`` 2 one request is for a pair and names its even word. Other rows of lanes
    may be written while dirty bits are taken.

    **Latency**: 3 cycles from a complete line to its first word. **Throughput**: one request a
    cycle. A stretch costs one cycle more, or two if it has no dirty bits. A line costs two.

    Members
    -------
    top : In(signed(line_bits + 2))
        Lines above this one are complete. Never falls during a frame.
    close : In(1)
        The frame that is drawn is complete; never while ``closing``.
    limit : In(signed(line_bits + 2))
        Lines above this one have received their initial raster.
    jump : In(1)
        The initial raster has ended. ``limit`` means nothing, and many lines may leave at a time.
    enable : In(1)
        Low: no dirty bits are taken in the next cycle.
    touch : In(4 x 2)
        By residue of the line modulo 4, the words of ``words`` that are written in this cycle.
        None while ``taking``; with ``flush_words`` 2 none in the row of lanes of ``oldest``.
    group : In(4 x group_bits)
        Slots of those lines, without the two lowest bits.
    words : In(2 x word_bits)
        Two neighbouring words.
    reaching : In(1)
        ``words`` may be written in this cycle; high whenever ``touch`` is.
    load : In(4)
        By residue of the line, ``load_word`` is written in this cycle, and ``words`` are not. None
        while ``taking``.
    load_word : In(word_bits)
        A word of the initial raster.
    lone : In(4)
        By residue of the line, ``load_word`` may be written, and ``words`` are not.
    wipe : In(1)
        Clear the dirty bits of all residues at ``wipe_row``.
    wipe_row : In
        Group of lines (high bits) and stretch.
    restart : In(1)
        The closed frame is over: continue with line 0 of the next.
    oldest : Out(line_bits + 1)
        First line in the window, in lines of the frame that leaves.
    front : Out(signed(line_bits + 2))
        First line in the window, in lines of the frame that is drawn.
    closing : Out(1)
        A closed frame is not over yet.
    over : Out(1)
        The closed frame has left the window.
    taking : Out(1)
        Dirty bits are taken in this cycle: no writes, see ``touch``.
    flush : Out(stream of PlaceLayout)
        Words to read and clear.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "top": In(signed(config.line_bits + 2)),
                "limit": In(signed(config.line_bits + 2)),
                "jump": In(1),
                "enable": In(1),
                "touch": In(data.ArrayLayout(2, RESIDUES)),
                "group": In(data.ArrayLayout(config.group_bits, RESIDUES)),
                "words": In(data.ArrayLayout(config.word_bits, 2)),
                "reaching": In(1),
                "load": In(RESIDUES),
                "load_word": In(config.word_bits),
                "lone": In(RESIDUES),
                "wipe": In(1),
                "wipe_row": In((stretches(config) - 1).bit_length() + config.group_bits),
                "restart": In(1),
                "close": In(1),
                "oldest": Out(config.line_bits + 1),
                "front": Out(signed(config.line_bits + 2)),
                "closing": Out(1),
                "over": Out(1),
                "taking": Out(1),
                "flush": Out(stream.Signature(PlaceLayout(config))),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        m.submodules.dirty_bits = dirty_bits = TileDirtyBits(config)
        written = Signal(config.window_lines)  # dirty lines, by slot
        place = self.oldest[: config.slot_bits]
        leaving = Signal()  # the oldest line is retired
        here = Signal()  # it is dirty
        clean = Signal()
        left = Signal()  # its last dirty pair is requested
        m.submodules.frame_overlap = frame_overlap = FrameOverlap(config)
        m.d.comb += [
            leaving.eq(
                (
                    frame_overlap.closing
                    | ((self.oldest < self.top) & (self.jump | (self.oldest < self.limit)))
                )
                & ~frame_overlap.halted
            ),
            here.eq(written.bit_select(place, 1)),
            clean.eq(~written.any()),
        ]
        leaves = left | (leaving & ~here)
        wraps = Cat(self._wraps(residue) for residue in range(RESIDUES)).any()
        connect_frame_overlap(m, self, frame_overlap, self.oldest, leaves, wraps, clean)
        m.d.comb += self.over.eq(frame_overlap.over)
        ahead, wanted, rest, next_stretch = self._stretches(m, clean)
        pairs, stretch = self._pairs(m, dirty_bits, leaving & here, wanted, next_stretch, left)
        with m.If(self.taking):
            m.d.sync += [pairs.eq(dirty_bits.taken), stretch.eq(next_stretch), ahead.eq(rest)]
        with m.If(left):
            m.d.sync += ahead.eq(-1)
        mark_lines(m, self, written, left, place, self._written)
        with m.If(leaving & self.jump & clean & ~frame_overlap.closing):
            m.d.sync += self.oldest.eq(self.top)
        with m.Elif(frame_overlap.leaves & ~frame_overlap.last):
            m.d.sync += self.oldest.eq(self.oldest + 1)
        with m.If(self.restart):
            m.d.sync += self.oldest.eq(0)
        return m

    def _stretches(self, m, clean):
        """Return the stretches of the oldest line to take: all, those written, the rest, the next.

        ``ahead``: stretches that are not taken yet. ``wanted``: those with recent writes; others
        are skipped. ``rest``: ``ahead`` without the next one. ``next_stretch``: number of the next
        one. It is a register, to cut the engine's longest path. Writes of the cycle between are on
        other lines.
        """
        ahead = Signal(stretches(self.config), init=-1)
        wanted = Signal.like(ahead)
        lowest = Signal.like(ahead)
        stretch_bit = Signal.like(ahead, init=0, reset_less=True)
        next_stretch = Signal(len(self.wipe_row) - self.config.group_bits)
        m.d.comb += [
            wanted.eq(self._reached(m, clean) & ahead),
            lowest.eq(wanted & (~wanted + 1)),
        ]
        m.d.sync += [stretch_bit.eq(lowest), next_stretch.eq(number_of(lowest))]
        return ahead, wanted, ahead & ~stretch_bit, next_stretch

    def _pairs(self, m, dirty_bits, scans, wanted, next_stretch, left):
        """Request the dirty pairs of the stretch taken last; return them and the stretch.

        The next stretch is taken while the last pair is requested. ``scans``: the oldest line is
        retired and dirty.
        """
        config = self.config
        pairs = Signal(1 << mark_bits(config))  # without the one that is being requested
        first = Signal.like(pairs)
        second_word = Signal()
        stretch = Signal.like(next_stretch, name="stretch")
        asking = Signal()
        asked = Signal()
        moves = Signal()
        pair = Signal(mark_bits(config) + len(stretch))
        m.d.comb += [
            first.eq(pairs & (~pairs + 1)),
            self.flush.valid.eq(asking),
            self.flush.payload.word.eq(Cat(second_word, pair)),
            self.flush.payload.line.eq(self.oldest),
            asked.eq(self.flush.valid & self.flush.ready),
            moves.eq(~asking | (asked & second_word if config.flush_words == 1 else asked)),
        ]
        place = self.oldest[: config.slot_bits]
        connect_dirty_bits(m, self, dirty_bits, self.taking, place, next_stretch)
        m.d.comb += left.eq(scans & moves & ~pairs.any() & ~wanted.any())
        # A register, because tiles stall for it.
        m.d.sync += self.taking.eq(scans & ~pairs.any() & wanted.any() & self.enable & ~self.taking)
        if config.flush_words == 1:
            with m.If(asked):
                m.d.sync += second_word.eq(~second_word)
        with m.If(moves):
            m.d.sync += [
                asking.eq(pairs.any()),
                pair.eq(Cat(number_of(first), stretch)),
                pairs.eq(pairs & ~first),
            ]
        return pairs, stretch

    def _wraps(self, residue):
        """Return whether a line is written in a slot before that of ``oldest``."""
        place = Cat(Const(residue, 2), self.group[residue])
        return self._written(residue) & (place < self.oldest[: self.config.slot_bits])

    def _written(self, residue):
        """Return whether a line of this residue is written."""
        return self.touch[residue].any() | self.load[residue]

    def _reached(self, m, clean):
        """Return the stretches that may have dirty bits, for all lines of the window together.

        These are the stretches written since the window was last clean, in this lap of ``oldest``
        or in the one before. All words of earlier laps have left.
        """
        config = self.config
        now, before = (Signal(stretches(config), name=name) for name in ("now", "before"))
        reach = Signal.like(now)
        turn = Signal()
        turned = Signal()
        m.d.comb += turned.eq(self.oldest[config.slot_bits] != turn)
        own = [1 << word[1 + mark_bits(config) :] for word in self.words]
        loaded = 1 << self.load_word[1 + mark_bits(config) :]
        m.d.comb += reach.eq(
            ((own[0] | own[1]) & self.reaching.replicate(len(reach)))
            | (loaded & self.load.any().replicate(len(reach)))
        )
        m.d.sync += [
            turn.eq(self.oldest[config.slot_bits]),
            now.eq(Mux(clean | turned, 0, now) | reach),
            before.eq(Mux(clean, 0, Mux(turned, now, before))),
        ]
        return now | before
