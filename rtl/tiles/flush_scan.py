"""The way along the lines that leave the window: to each word that was written, and no other."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import PlaceLayout
from splatline.rtl.lib.mux import number_of
from splatline.rtl.window.frame_overlap import FrameOverlap

from .dirty_bits import RESIDUES, TileDirtyBits, mark_bits, stretches

__all__ = ["TileFlushScan"]


class TileFlushScan(wiring.Component):
    """Asks for each written word of the lines that no later element touches to be flushed.

    Line n of the image stands in place n mod ``window_lines`` of the window. ``oldest`` is the
    first line that has not left: it and the ``window_lines - 1`` after it are in the window, those
    above ``top`` are on their way out. Once a frame was closed, they all are, and ``top`` and what
    is written are the next frame's (see :class:`FrameOverlap`). A line that nothing was written
    into leaves in one cycle, and all at once if none was written. Of others the marks are taken a
    stretch at a time, in cycles in which nothing is written (``taking``), and each marked pair of
    words is asked for. A stretch that nothing has reached for long is passed over (``_reached``).
    With ``flush_words`` 2 a pair is one request, which names its even word, and while marks are
    taken words of other rows of lanes may be written.

    **Latency**: 3 cycles from a complete line to its first word. **Throughput**: one request a
    cycle; one cycle more a stretch, or two if it turns out to have no marks, and two a line.

    Members
    -------
    top : In(signed(line_bits + 2))
        Lines above this one are complete. Never falls during a frame.
    close : In(1)
        The frame at hand is complete; not while ``closing``.
    limit : In(signed(line_bits + 2))
        Lines above this one have received all of the initial raster that is meant for them.
    jump : In(1)
        No initial raster will come for any line, and ``limit`` means nothing: lines may leave many
        at a time.
    enable : In(1)
        Low: no marks are taken in the next cycle.
    touch : In(4 x 2)
        By residue of the line modulo 4, which of two neighbouring words are written in this cycle;
        none while ``taking``, or with ``flush_words`` 2 none in the row of lanes of ``oldest``.
    group : In(4 x group_bits)
        Places in the window of those lines, but for the two lowest bits.
    words : In(2 x word_bits)
        The two words.
    reaching : In(1)
        Something may be written in this cycle into ``words``; at least if ``touch``.
    load : In(4)
        By residue of the line, ``load_word`` is written in this cycle, and neither of ``words``;
        none while ``taking``.
    load_word : In(word_bits)
        A word of the initial raster.
    lone : In(4)
        By residue of the line, it may be that word that is written, and not ``words``.
    wipe : In(1)
        Clear the marks of all lines' stretches at ``wipe_row``.
    wipe_row : In
        Group of lines (high bits) and stretch.
    restart : In(1)
        The closed frame is over: go on with line 0 of the next.
    oldest : Out(line_bits + 1)
        First line in the window, of the frame that leaves.
    front : Out(signed(line_bits + 2))
        First line in the window, of the frame that is drawn.
    closing : Out(1)
        A frame was closed and is not over.
    over : Out(1)
        Nothing of the closed frame is in the window any more.
    taking : Out(1)
        Marks are taken in this cycle: nothing may be written, see ``touch``.
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
        stretch_bits = len(self.wipe_row) - config.group_bits
        m.submodules.dirty_bits = dirty_bits = TileDirtyBits(config)
        written = Signal(config.window_lines)
        place = self.oldest[: config.slot_bits]
        leaving = Signal()  # the oldest line is on its way out
        here = Signal()  # it was written
        clean = Signal()
        left = Signal()
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
            frame_overlap.oldest.eq(self.oldest),
            frame_overlap.line.eq(self.oldest),
            frame_overlap.leaves.eq(left | (leaving & ~here)),
            frame_overlap.wraps.eq(Cat(self._wraps(residue) for residue in range(RESIDUES)).any()),
            frame_overlap.clean.eq(clean),
            frame_overlap.close.eq(self.close),
            frame_overlap.restart.eq(self.restart),
            self.front.eq(frame_overlap.front),
            self.closing.eq(frame_overlap.closing),
            self.over.eq(frame_overlap.over),
        ]

        # Its stretches that are still to be taken: none that nothing reached. The first of them is
        # known a cycle late, lest the way to it and on to its marks be the longest of the engine;
        # what was reached since then was so on other lines.
        ahead = Signal(stretches(config), init=-1)
        wanted = Signal.like(ahead)
        lowest = Signal.like(ahead)
        stretch_bit = Signal.like(ahead, init=0, reset_less=True)
        next_stretch = Signal(stretch_bits)
        m.d.comb += [
            wanted.eq(self._reached(m, clean) & ahead),
            lowest.eq(wanted & (~wanted + 1)),
        ]
        m.d.sync += [stretch_bit.eq(lowest), next_stretch.eq(number_of(lowest))]

        # The stretch at hand: its marked pairs, but for the one that is asked for. The next stretch
        # is taken as soon as that is the last.
        pairs = Signal(1 << mark_bits(config))
        first = Signal.like(pairs)
        second_word = Signal()
        stretch = Signal(stretch_bits)
        asking, asked = Signal(), Signal()
        moves = Signal()
        pair = Signal(mark_bits(config) + stretch_bits)
        m.d.comb += [
            first.eq(pairs & (~pairs + 1)),
            self.flush.valid.eq(asking),
            self.flush.payload.word.eq(Cat(second_word, pair)),
            self.flush.payload.line.eq(self.oldest),
            asked.eq(self.flush.valid & self.flush.ready),
            moves.eq(~asking | (asked & second_word if config.flush_words == 1 else asked)),
        ]
        self._connect_dirty_bits(m, dirty_bits, place, next_stretch)
        m.d.comb += left.eq(leaving & here & moves & ~pairs.any() & ~wanted.any())
        # Known a cycle ahead, because whatever is drawn waits for it.
        m.d.sync += self.taking.eq(
            leaving & here & ~pairs.any() & wanted.any() & self.enable & ~self.taking
        )
        if config.flush_words == 1:
            with m.If(asked):
                m.d.sync += second_word.eq(~second_word)
        with m.If(moves):
            m.d.sync += [
                asking.eq(pairs.any()),
                pair.eq(Cat(number_of(first), stretch)),
                pairs.eq(pairs & ~first),
            ]
        with m.If(self.taking):
            m.d.sync += [pairs.eq(dirty_bits.taken), stretch.eq(next_stretch)]
            m.d.sync += ahead.eq(ahead & ~stretch_bit)
        with m.If(left):
            m.d.sync += ahead.eq(-1)

        self._mark_lines(m, written, left, place)
        with m.If(leaving & self.jump & clean & ~frame_overlap.closing):
            m.d.sync += self.oldest.eq(self.top)
        with m.Elif(frame_overlap.leaves & ~frame_overlap.last):
            m.d.sync += self.oldest.eq(self.oldest + 1)
        with m.If(self.restart):
            m.d.sync += self.oldest.eq(0)
        return m

    def _connect_dirty_bits(self, m, dirty_bits, place, next_stretch):
        """Pass the written words to the dirty bits, and the address of the stretch to take."""
        stretch_bits = len(next_stretch)
        m.d.comb += [
            dirty_bits.take.eq(self.taking | self.wipe),
            dirty_bits.wipe.eq(self.wipe),
            dirty_bits.line.eq(
                Mux(self.wipe, Cat(Const(0, 2), self.wipe_row[stretch_bits:]), place)
            ),
            dirty_bits.stretch.eq(Mux(self.wipe, self.wipe_row[:stretch_bits], next_stretch)),
            dirty_bits.touch.eq(self.touch),
            dirty_bits.group.eq(self.group),
            dirty_bits.words.eq(self.words),
            dirty_bits.load.eq(self.load),
            dirty_bits.load_word.eq(self.load_word),
            dirty_bits.lone.eq(self.lone),
        ]

    def _mark_lines(self, m, written, left, place):
        """Set the bit of each line that is written, and clear that of the line that leaves."""
        for slot in range(self.config.window_lines):
            touched = self._written(slot % 4) & (self.group[slot % 4] == slot // 4)
            gone = left & (place == slot)
            m.d.sync += written[slot].eq(~gone & (written[slot] | touched))

    def _wraps(self, residue):
        """Return whether a line is written whose place is before that of ``oldest``."""
        place = Cat(Const(residue, 2), self.group[residue])
        return self._written(residue) & (place < self.oldest[: self.config.slot_bits])

    def _written(self, residue):
        """Return whether something is written into a line of this residue."""
        return self.touch[residue].any() | self.load[residue]

    def _reached(self, m, clean):
        """Return which stretches may have marks, for all lines of the window together.

        Those reached since the window was last clean, and since ``oldest`` last passed a multiple
        of the window's height but one: all that was written before that has left.
        """
        config = self.config
        now, before = (Signal(stretches(config), name=name) for name in ("now", "before"))
        reach = Signal.like(now)
        turn, turned = Signal(), Signal()
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
