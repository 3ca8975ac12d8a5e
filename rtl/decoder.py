"""The decoder: from a code word's rows to the spans that each line of the window receives."""

from amaranth.hdl import Cat, Module, Mux, Signal, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from .format import BLOCK, ROWS, EngineConfig
from .layouts import FootprintLayout, GeometryLayout, SpanLayout
from .shape_rows import ShapeRows

__all__ = ["Decoder", "SpanDecoder"]


class SpanDecoder(wiring.Component):
    """One row of a block, placed on the words of a line.

    **Latency**: 0, combinational.

    Members
    -------
    first, last : In(3)
        Columns of the block, inclusive.
    enable : In(1)
        The row is not empty and its line lies in the image.
    offset : In(pixel_bits)
        Pixel of its word in which the block's column 0 lies.
    shifted : In(1)
        The row lies one column further right.
    inside : In(block_words)
        Which of that word and its neighbours on the right lie in the image.
    span : Out(SpanLayout)
        The pixels covered. Where ``words`` is 0, ``first`` and ``last`` mean nothing.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "first": In(3),
                "last": In(3),
                "enable": In(1),
                "offset": In(config.pixel_bits),
                "shifted": In(1),
                "inside": In(config.block_words),
                "span": Out(SpanLayout(config)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        span = self.span
        bits = self.config.pixel_bits
        m.d.comb += [
            # With the shift as the carry into the adder, where it costs nothing.
            span.first.eq((Cat(1, self.first) + Cat(self.shifted, self.offset))[1:]),
            span.last.eq((Cat(1, self.last) + Cat(self.shifted, self.offset))[1:]),
        ]
        for word in range(self.config.block_words):
            touched = (span.first[bits:] <= word) & (span.last[bits:] >= word)
            m.d.comb += span.words[word].eq(self.enable & self.inside[word] & touched)
        return m


class Decoder(wiring.Component):
    """Unfolds an element's rows, clips them to the image and deals them to the lines' residues.

    An element is offered once all its lines are in the window, which is known a cycle ahead.

    **Latency**: 1 cycle. **Throughput**: one element a cycle.

    Members
    -------
    i : In(stream of GeometryLayout)
        Elements, and ``end`` tokens.
    o : Out(stream of FootprintLayout)
        What the window draws. An end token and an element outside the image have no words.
    oldest : In(signed(line_bits + 2))
        First line of the window as far as it was loaded.
    running : In(1)
        Low: the window stands still, and what has left may not have been cleared as yet.
    last_column : In(x_bits)
        Width of the image less 1; steady during a frame, as is the height.
    last_line : In(line_bits)
        Height of the image less 1.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(GeometryLayout(config))),
                "o": Out(stream.Signature(FootprintLayout(config))),
                "oldest": In(signed(config.line_bits + 2)),
                "running": In(1),
                "last_column": In(config.x_bits),
                "last_line": In(config.line_bits),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        element = self.i.payload

        footprint = Signal(FootprintLayout(config))
        m.d.comb += [
            footprint.word.eq(element.x[config.pixel_bits :]),
            footprint.z.eq(element.z),
            footprint.end.eq(element.end),
        ]
        for residue, group in enumerate(footprint.upper_group):
            # The first line from the top on with this residue: past a multiple of 4 or not.
            m.d.comb += group.eq(element.top[2:4] + (residue < element.top[:2]))
        shape = ShapeRows(m, element)
        self._deal(m, element, shape, self._enables(m, element, shape), footprint)

        valid = Signal()
        near = Signal()  # its lines are in the window
        held = Signal(FootprintLayout(config), reset_less=True)
        top = Signal.like(element.top, name="held_top", init=-ROWS)
        m.d.comb += [
            self.o.valid.eq(valid & (near | held.end)),
            self.o.payload.eq(held),
            self.o.payload.top.eq(top),
            self.i.ready.eq(~valid | (self.o.valid & self.o.ready)),
        ]
        with m.If(self.i.ready):
            m.d.sync += [valid.eq(self.i.valid), held.eq(footprint)]
            with m.If(self.i.valid):
                m.d.sync += top.eq(element.top)
            with m.Elif(valid & held.end):
                m.d.sync += top.eq(top.init)  # of the next frame

        # Known a cycle ahead: while the element at hand waits it is looked at, else the one behind
        # it. Until an end token was taken, ``oldest`` is not of the frame behind it.
        waits = Signal()
        settled = Signal()
        behind = Signal(signed(len(top) + 1))
        beyond = config.window_lines - BLOCK  # so many lines ahead, or more
        bits = beyond.bit_length() - 1
        within = Signal()
        m.d.comb += [
            within.eq(~behind[-1] | (behind[bits:].all() & behind[:bits].any())),
            waits.eq(valid & ~near),
            behind.eq(self.oldest - Mux(waits, top, element.top)),
            settled.eq(self.running & within),
        ]
        with m.If(valid & held.end):
            m.d.sync += near.eq(0)
        with m.Elif(waits | self.i.ready):
            m.d.sync += near.eq(settled)
        return m

    def _enables(self, m, element, shape):
        """Return which of the block's rows are drawn, of the upper and of the lower four."""
        # Lines of the image from the block's first row on, less 1; 7 stands for more.
        left = Signal(signed(len(element.top) + 1))
        near = Signal(3)
        m.d.comb += [
            left.eq(self.last_line - element.top),
            near.eq(Mux(left[3:].any(), 7, left[:3])),
        ]
        above = element.top < 0  # then it lies in -4 .. -1
        upper, lower = Signal(4), Signal(4)
        drawn = Signal()
        turned = Signal(4)
        m.d.comb += [
            drawn.eq(~element.end & (left >= 0)),
            # A raised shape's row 3 is in its middle and has no half turn.
            turned.eq(Mux(shape.raised, shape.filled[:3][::-1], shape.filled[::-1])),
        ]
        for k in range(4):
            below_border = ~above | (element.top[:3] >= 8 - k)
            m.d.comb += [
                upper[k].eq(drawn & shape.filled[k] & below_border & (near >= k)),
                lower[k].eq(drawn & turned[k] & ~element.mode & (near >= k + 4)),
            ]
        return upper, lower

    def _deal(self, m, element, shape, enables, footprint):
        """Turn the rows from the block's order into the order of residues, and place them."""
        # Words of the image from X's word on, less 1.
        bits = self.config.pixel_bits
        words_left = Signal(signed(self.config.word_bits + 1))
        inside = Signal(self.config.block_words)
        m.d.comb += [
            words_left.eq(self.last_column[bits:] - element.x[bits:]),
            inside.eq(Cat(words_left >= word for word in range(len(inside)))),
        ]
        spans = {name: [SpanDecoder(self.config) for _ in range(4)] for name in ("upper", "lower")}
        for name, row in spans.items():
            for residue, span in enumerate(row):
                m.submodules[f"{name}_{residue}"] = span
                m.d.comb += [
                    span.offset.eq(element.x[:bits]),
                    span.inside.eq(inside),
                    footprint[name][residue].eq(span.span),
                ]
        with m.Switch(element.top[:2]):
            for turn in range(4):
                with m.Case(turn):
                    for residue in range(4):
                        k = (residue - turn) % 4
                        m.d.comb += [
                            spans["upper"][residue].first.eq(shape.rows[k].first),
                            spans["upper"][residue].last.eq(shape.rows[k].last),
                            spans["upper"][residue].enable.eq(enables[0][k]),
                            spans["lower"][residue].enable.eq(enables[1][k]),
                        ]
        # The lower half is the upper one turned by half a circle: row k is row 3 - k of that, or
        # 2 - k of a raised shape's; so the one turned above for another residue, which depends on
        # the block's top being odd.
        odd = element.top[0]
        for residue, span in enumerate(spans["lower"]):
            rows = [spans["upper"][(3 - residue + turn) % 4] for turn in range(4)]
            for end, other in (("first", "last"), ("last", "first")):
                ends = [getattr(row, other) for row in rows]
                raised = Mux(odd, ends[1], ends[3])
                m.d.comb += getattr(span, end).eq(
                    ~Mux(shape.raised, raised, Mux(odd, ends[2], ends[0]))
                )
            m.d.comb += span.shifted.eq(shape.shifted)
