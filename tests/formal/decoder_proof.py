"""The decoder against the contract, for every element, size of image, line and column."""

from amaranth.hdl import Signal
from properties import Properties, any_constant, covers
from prove import Fault, Proof

from splatline.rtl.decoder import Decoder, SpanDecoder
from splatline.rtl.format import BLOCK
from splatline.rtl.layouts import GeometryLayout
from splatline.rtl.presets import PRESETS
from splatline.rtl.variants import BANKS16

__all__ = ["PROOFS"]


class DecoderProperties(Properties):
    """One row of a block and one column, whichever: the spans have the pixel if the contract has.

    A span may reach past the right border in an image's last word, and nowhere else. An element is
    offered once its lines were in a window that did not stand still, a cycle after that.
    """

    def __init__(self, config):
        self.config = config

    def describe(self, m):
        """Add the decoder and its properties."""
        config = self.config
        m.submodules.dut = dut = Decoder(config)
        last_column = any_constant(m, config.x_bits, "last_column")
        last_line = any_constant(m, config.line_bits, "last_line")
        self.free(m, dut, last_column=last_column, last_line=last_line)
        self.given(m, "input_steady", self.steady(m, dut.i, "i"))
        self.given(m, "top", dut.i.payload.top >= -4)

        element = Signal(GeometryLayout(config))
        here = Signal()  # it was taken, and not yet handed on
        top = Signal.like(element.top, init=-4)  # no later element lies above it
        leaves = Signal()
        m.d.comb += leaves.eq(dut.o.valid & dut.o.ready)
        with m.If(dut.i.valid & dut.i.ready):
            m.d.sync += [element.eq(dut.i.payload), here.eq(1), top.eq(dut.i.payload.top)]
        with m.Elif(leaves):
            m.d.sync += here.eq(0)
            with m.If(element.end):
                m.d.sync += top.eq(-4)

        # The window moves on, and back to the next frame once the end token was taken.
        oldest, ran = Signal.like(dut.oldest), Signal()
        ended, waited = Signal(), Signal()
        m.d.sync += [
            oldest.eq(dut.oldest),
            ran.eq(dut.running),
            ended.eq(leaves & element.end),
            waited.eq(dut.o.valid & ~dut.o.ready),
        ]
        near = ran & (element.top - oldest < config.window_lines - BLOCK)
        # And back as well before the frame, where no line of it is in the window.
        before_all = oldest <= 1 - config.window_lines
        self.given(m, "oldest", ended | (dut.oldest >= oldest) | before_all)
        self.always(m, "offered", ~dut.o.valid | (here & (element.end | waited | (near & ~ended))))
        self.always(m, "not_late", ~here | dut.o.valid | ended | ~(near | element.end))
        self.always(m, "taken", dut.i.ready == (~here | leaves))
        self.always(m, "top", dut.o.payload.top == top)

        row = any_constant(m, 3, "row")
        column = any_constant(m, config.x_bits + 1, "column")
        footprint = dut.o.payload
        line = Signal(range(-4, 2 * config.max_height + 8))
        residue, word = Signal(2), Signal(config.x_bits + 1)
        m.d.comb += [line.eq(element.top + row), residue.eq(line[:2])]
        # The first four lines of the block are the upper ones, and each residue has one of them.
        span = Signal.like(footprint.upper[0])
        for number in range(4):
            with m.If(residue == number):
                with m.If(row < 4):
                    m.d.comb += span.eq(footprint.upper[number])
                with m.Else():
                    m.d.comb += span.eq(footprint.lower[number])
        bits = config.pixel_bits
        distance = Signal(range(-(4 << config.x_bits), 4 << config.x_bits))
        spanned = Signal()
        m.d.comb += [
            word.eq(column >> bits),
            distance.eq(column - (footprint.word << bits)),
            spanned.eq(
                (distance >= 0)
                & (distance < config.block_words << bits)
                & (span.words.bit_select(distance[bits:4], 1))
                & (span.first <= distance)
                & (distance <= span.last)
            ),
        ]
        covered = Signal()
        m.d.comb += covered.eq(covers(element, row, column) & (line >= 0) & (line <= last_line))
        with m.If(here):  # it stands there before it is offered as well
            self.always(m, "same", ~(column <= last_column) | (spanned == covered))
            self.always(m, "border", (column >> bits <= last_column >> bits) | ~spanned)
            for word in range(config.block_words):
                reached = (span.first[bits:] <= word) & (word <= span.last[bits:])
                touches = reached & (span.first <= span.last)
                self.always(m, f"touches_{word}", ~span.words[word] | touches)
            # The window's proof takes it for granted, of spans without words as well.
            most = config.block_words << bits
            within = (span.first < most) & (span.last < most)
            self.always(m, "within", within)
            self.always(m, "rows", (line >= 0) & (line <= last_line) | ~span.words.any())
            group = Signal(2)
            for number in range(4):
                with m.If(residue == number):
                    m.d.comb += group.eq(footprint.upper_group[number])
            self.always(m, "group", (group + row[2])[:2] == line[2:4])
            self.always(
                m,
                "rest",
                (footprint.z == element.z)
                & (footprint.top == element.top)
                & (footprint.end == element.end),
            )
        self.always(m, "output_steady", self.steady(m, dut.o, "o"))


PROOFS = [
    Proof(
        name="decoder: spans",
        shows="a pixel is spanned if and only if the contract covers it",
        build=lambda: DecoderProperties(PRESETS["wide"]),
        depth=5,
        endless=True,
        faults=(
            Fault("a row too many", Decoder, r"near >= k \+ 4", "near >= k + 3", "_enables"),
            Fault("not turned", Decoder, r'"first", "last"\)', '"first", "first")', "_deal"),
            Fault("turned for an even top", Decoder, r"odd, ends\[2\]", "0, 0", "_deal"),
            Fault("raised for an even top", Decoder, r"odd, ends\[1\]", "0, 0", "_deal"),
            Fault("raised, but as full", Decoder, r"filled\[:3\]", "filled", "_enables"),
            Fault("not shifted", Decoder, r"eq\(shape\.shifted\)", "eq(0)", "_deal"),
            Fault(
                "right border", Decoder, r"words_left >= word", "words_left + 1 >= word", "_deal"
            ),
            Fault("top border", Decoder, r">= 8 - k", ">= 7 - k", "_enables"),
            Fault("last word", SpanDecoder, r"last\[bits:\] >= word", "last[bits:] > word"),
            Fault("not held", Decoder, r"~valid \| \(self\.o\.valid & self\.o\.ready\)", "1"),
            Fault(
                "taken unoffered", Decoder, r"\(self\.o\.valid & self\.o\.ready\)", "self.o.ready"
            ),
            Fault("a line too early", Decoder, r" & behind\[:bits\]\.any\(\)", ""),
            Fault(
                "the element behind it", Decoder, r"Mux\(waits, top, element\.top\)", "element.top"
            ),
            Fault("while all stands still", Decoder, r"self\.running & within", "within"),
            Fault("the frame before", Decoder, r"m\.If\(valid & held\.end\)", "m.If(0)"),
            Fault(
                "the top of the frame before", Decoder, r"m\.Elif\(valid & held\.end\)", "m.Elif(0)"
            ),
        ),
    ),
    Proof(
        name="decoder: spans, words of eight",
        shows="the same where words have eight pixels",
        build=lambda: DecoderProperties(BANKS16),
        depth=5,
        endless=True,
        faults=(
            Fault("last word", SpanDecoder, r"last\[bits:\] >= word", "last[bits:] > word"),
            Fault("not shifted", Decoder, r"eq\(shape\.shifted\)", "eq(0)", "_deal"),
        ),
    ),
]
