"""The way along the lines that leave the window: to each word that was written, and no other."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from .choose import number_of
from .format import EngineConfig
from .layouts import PlaceLayout
from .marks import RESIDUES, Marks, mark_bits, stretches

__all__ = ["Walker"]


class Walker(wiring.Component):
    """Asks for each written word of the lines that no later element touches to be flushed.

    Line n of the image stands in place n mod ``window_lines`` of the window. ``oldest`` is the
    first line that has not left: it and the ``window_lines - 1`` after it are in the window, those
    above ``top`` are on their way out. A line that nothing was written into leaves in one cycle,
    and all at once if none was written. Of others the marks are taken a stretch at a time, in
    cycles in which nothing is written (``taking``), and each marked pair of words is asked for.

    **Latency**: 2 cycles. **Throughput**: one word a cycle, one cycle more a stretch.

    Members
    -------
    top : In(signed(line_bits + 2))
        Lines above this one are complete. Never falls during a frame.
    loaded : In(1)
        Line ``oldest`` has received all of the initial raster that is meant for it.
    jump : In(1)
        No initial raster will come for any line: lines may leave many at a time.
    enable : In(1)
        Low: no marks are taken in the next cycle.
    touch : In(4 x 2)
        By residue of the line modulo 4, which of two neighbouring words are written in this cycle;
        none while ``taking``.
    group : In(4 x group_bits)
        Places in the window of those lines, but for the two lowest bits.
    words : In(2 x word_bits)
        The two words.
    wipe : In(1)
        Clear the marks of all lines' stretches at ``wipe_row``.
    wipe_row : In
        Group of lines (high bits) and stretch.
    restart : In(1)
        The frame is over: go back to line 0.
    oldest : Out(line_bits + 1)
        First line in the window.
    clean : Out(1)
        No line of the window is written.
    taking : Out(1)
        Marks are taken in this cycle: nothing may be written.
    flush : Out(stream of PlaceLayout)
        Words to read and clear.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "top": In(signed(config.line_bits + 2)),
                "loaded": In(1),
                "jump": In(1),
                "enable": In(1),
                "touch": In(data.ArrayLayout(2, RESIDUES)),
                "group": In(data.ArrayLayout(config.group_bits, RESIDUES)),
                "words": In(data.ArrayLayout(config.word_bits, 2)),
                "wipe": In(1),
                "wipe_row": In((stretches(config) - 1).bit_length() + config.group_bits),
                "restart": In(1),
                "oldest": Out(config.line_bits + 1),
                "clean": Out(1),
                "taking": Out(1),
                "flush": Out(stream.Signature(PlaceLayout(config))),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        stretch_bits = len(self.wipe_row) - config.group_bits
        m.submodules.marks = marks = Marks(config)
        written = Signal(config.window_lines)
        place = self.oldest[: config.slot_bits]
        leaving = Signal()
        walking = Signal()  # the oldest line leaves, and was written; known one cycle later

        # The stretch at hand: its marked pairs, but for the one that is asked for. The next stretch
        # is taken as soon as that is the last.
        pairs = Signal(1 << mark_bits(config))
        first = Signal.like(pairs)
        second_word = Signal()
        next_stretch = Signal(stretch_bits + 1)  # its top bit: all were taken
        stretch = Signal(stretch_bits)  # the one before the next
        asking, asked, left = Signal(), Signal(), Signal()
        pair = Signal(mark_bits(config) + stretch_bits)
        m.d.comb += [
            leaving.eq((self.oldest < self.top) & self.loaded),
            first.eq(pairs & (~pairs + 1)),
            stretch.eq(next_stretch - 1),
            self.clean.eq(~written.any()),
            self.flush.valid.eq(asking),
            self.flush.payload.word.eq(Cat(second_word, pair)),
            self.flush.payload.line.eq(self.oldest),
            asked.eq(self.flush.valid & self.flush.ready),
            marks.take.eq(self.taking | self.wipe),
            marks.wipe.eq(self.wipe),
            marks.line.eq(Mux(self.wipe, Cat(Const(0, 2), self.wipe_row[stretch_bits:]), place)),
            marks.stretch.eq(Mux(self.wipe, self.wipe_row[:stretch_bits], next_stretch)),
            marks.touch.eq(self.touch),
            marks.group.eq(self.group),
            marks.words.eq(self.words),
            left.eq(~asking & ~pairs.any() & next_stretch[-1]),
        ]
        m.d.sync += [
            walking.eq(leaving & written.bit_select(place, 1) & ~left),
            # Known a cycle ahead, because whatever is drawn waits for it.
            self.taking.eq(walking & ~pairs.any() & ~next_stretch[-1] & self.enable & ~self.taking),
        ]
        with m.If(asked):
            m.d.sync += second_word.eq(~second_word)
        with m.If(~asking | (asked & second_word)):
            m.d.sync += [
                asking.eq(pairs.any()),
                pair.eq(Cat(number_of(first), stretch)),
                pairs.eq(pairs & ~first),
            ]
        with m.If(self.taking):
            m.d.sync += [pairs.eq(marks.taken), next_stretch.eq(next_stretch + 1)]
        with m.If(left):
            m.d.sync += next_stretch.eq(0)

        for slot in range(config.window_lines):
            touched = self.touch[slot % 4].any() & (self.group[slot % 4] == slot // 4)
            gone = left & (place == slot)
            m.d.sync += written[slot].eq(~gone & (written[slot] | touched))
        with m.If(leaving & self.jump & self.clean):
            m.d.sync += self.oldest.eq(self.top)
        with m.Elif(left | (leaving & ~written.bit_select(place, 1))):
            m.d.sync += self.oldest.eq(self.oldest + 1)
        with m.If(self.restart):
            m.d.sync += self.oldest.eq(0)
        return m
