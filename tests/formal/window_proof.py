"""The window of banks: its lines never mix, and no pixel is lost or invented."""

from amaranth.hdl import Cat, Const, Signal, signed
from lane_window_proof import LaneWindowProperties, Narrow
from properties import OneWord, any_constant, parts
from prove import Fault, Proof

from splatline.rtl.bank import Bank
from splatline.rtl.bank_arbiter import BankArbiter
from splatline.rtl.bank_layout import bank_address_bits, residue_bits
from splatline.rtl.bank_walker import BankWalker
from splatline.rtl.changeover import Changeover
from splatline.rtl.emitter import Emitter
from splatline.rtl.format import BLOCK
from splatline.rtl.halver import Halver
from splatline.rtl.loader import Loader
from splatline.rtl.scatter import Scatter
from splatline.rtl.share import ShareOfPair, ShareOfSixteen
from splatline.rtl.window import Window

__all__ = ["PROOFS"]

TINY = Narrow(x_bits=4, line_bits=5, depth_bits=2, channel_bits=1)
"""Four words of four pixels a line, sixteen lines in the window, an image of up to 32."""

TWO_WORDS = Narrow(x_bits=4, line_bits=5, depth_bits=2, channel_bits=1, raster_words=2)
"""The same with two words in a beat of the raster, as ``wide`` has it."""

SIXTEEN = Narrow(x_bits=4, line_bits=5, depth_bits=2, channel_bits=1, raster_words=2, banks=16)
"""And with sixteen banks."""

EIGHT = SIXTEEN.replace(x_bits=5, pixels_per_word=8)
"""And those with words of eight pixels, as ``banks16`` has it."""


class WindowProperties(LaneWindowProperties):
    """Any one pixel of any one place in the window, followed from line to line.

    As with lanes, but what is drawn are elements' footprints. Of those only what
    :class:`FootprintLayout` says is assumed, which ``decoder_proof`` proves.

    Parameters
    ----------
    load
        1: frames start from an initial raster; 0: they do not.
    pixel
        Which pixel, if not any: its line's place, word and number, as constants.
    """

    delay = 4  # the place is another line's with the request for the word that leaves

    def __init__(self, config, load, pixel=None):
        super().__init__(config, load)
        self.pixel = pixel

    def describe(self, m):
        """Add the window and its properties."""
        config = self.config
        self.slot = slot = any_constant(m, config.slot_bits, "slot")
        self.word = any_constant(m, config.word_bits, "word")
        self.number = any_constant(m, config.pixel_bits, "number")
        if self.pixel is not None:
            self.given(m, "pixel", Cat(self.slot, self.word, self.number) == Cat(*self.pixel))
        self.last_column = any_constant(m, config.x_bits, "last_column")
        self.last_line = any_constant(m, config.line_bits, "last_line")
        self.last_word = self.last_column[config.pixel_bits :]
        address = Signal(bank_address_bits(config))
        m.d.comb += address.eq(Cat(self.word[1:], slot[residue_bits(config) :]))
        self.memories = OneWord(address, init=(-1, 0) * config.banks)  # the background
        self.dut = dut = Window(config)
        fragment = self.add(m, dut)
        (walker,) = parts(fragment, BankWalker)
        self.free(
            m,
            dut,
            last_column=self.last_column,
            last_line=self.last_line,
            load=Signal(init=self.load, reset_less=True, name="load"),
            shade=self._shade(m),
        )
        self._own(m, walker.oldest, walker.front)
        drawn = self._elements(m)
        loaded = self._initial(m)
        self._follow(m, drawn, loaded)
        for index, bank in enumerate(parts(fragment, Bank)):
            self._keep_apart(m, index, bank)

    def _keep_apart(self, m, index, bank):
        """Assert what a bank takes for granted: no word is asked for before it was written."""
        request = bank.request
        asked, alters = Signal(name=f"asked_{index}"), Signal(name=f"alters_{index}")
        m.d.comb += [
            alters.eq(request.draw | request.clear),
            asked.eq(alters | request.load),  # which is written at once
        ]
        then = Signal(name=f"asked_before_{index}")
        there = Signal.like(request.address, name=f"there_{index}")
        with m.If(bank.enable):
            m.d.sync += [then.eq(alters), there.eq(request.address)]
        same = asked & then & (request.address == there)
        self.always(m, f"apart_{index}", ~(bank.enable & same))

    def _shade(self, m):
        """Return the colour of the element that last moved on, which is its depth."""
        shade = Signal.like(self.dut.shade, reset_less=True, name="shade_moved")
        with m.If(self.dut.moves):
            m.d.sync += shade.eq(self.dut.i.payload.z)
        return shade

    def _elements(self, m):
        """Assume of the footprints what they are; return whether one draws the pixel now."""
        config, dut = self.config, self.dut
        footprint = dut.i.payload
        taken = dut.i.valid & dut.i.ready
        top = Signal.like(footprint.top, name="top_before", init=-4)
        passed = Signal.like(top, name="top_taken", init=-4)  # of the last element that was taken
        opened, closed = Signal(), Signal()
        lowest = (1 << len(top) - 1) - 1
        oldest = Signal.like(dut.oldest, name="oldest_before")
        ran, waited = Signal(), Signal()
        m.d.sync += [oldest.eq(dut.oldest), closed.eq(self.close)]
        m.d.sync += [ran.eq(dut.running), waited.eq(dut.i.valid & ~dut.i.ready)]
        m.d.sync += [top.eq(footprint.top), opened.eq(dut.active)]
        with m.If(taken):
            m.d.sync += passed.eq(footprint.top)
        with m.If(self.close):
            m.d.sync += [top.eq(-4), passed.eq(-4), opened.eq(0)]
        self.given(m, "elements_steady", self.steady(m, dut.i, "i"))
        self.given(m, "sorted", footprint.top >= top)
        # While none is offered it is that of the last element, or of one that is still to come: an
        # end token is offered at once.
        at_once = dut.i.valid & footprint.end & ~waited
        self.given(m, "end_at_once", ~at_once | (top == passed))
        # An element is offered once all its lines were in a window that did not stand still; one of
        # the next frame not at once.
        self.given(m, "behind_the_end", ~(closed & dut.i.valid) | footprint.end)
        settled = ran & (footprint.top - oldest < config.window_lines - BLOCK)
        self.given(m, "settled", ~dut.i.valid | footprint.end | waited | settled)
        # So the window may not move past an element that waits.
        waits = dut.i.valid & ~footprint.end & (footprint.top >= 0)
        there = (dut.oldest <= footprint.top) & (self.front <= footprint.top)
        self.always(m, "waits", ~waits | there)
        self.given(m, "end_top", ~dut.i.valid | ~footprint.end | (footprint.top == lowest))
        self.given(m, "active", (dut.active >= opened) & (dut.active >= dut.i.valid))

        bits, most = config.pixel_bits, config.block_words << config.pixel_bits
        distance = Signal(config.word_bits)
        column = Signal(4)
        m.d.comb += [
            distance.eq(self.word - footprint.word),
            column.eq(Cat(self.number, distance)),
        ]
        hits = []
        for residue in range(4):
            above = Signal(2, name=f"above_{residue}")
            m.d.comb += above.eq(residue - footprint.top)
            spans = footprint.upper[residue], footprint.lower[residue]
            for half, span in enumerate(spans):
                name = f"{residue}_{half}"
                line = Signal(signed(config.line_bits + 3), name=f"line_{name}")
                m.d.comb += line.eq(footprint.top + above + 4 * half)
                there = dut.i.valid & span.words.any()
                in_image = (line >= 0) & (line <= self.last_line) & ~footprint.end
                group = (footprint.upper_group[residue] + half)[:2]
                within = (span.first < most) & (span.last < most)
                self.given(m, f"within_{name}", within)
                self.given(m, f"span_{name}", ~there | (in_image & (group == line[2:4])))
                for word in range(config.block_words):
                    touched = dut.i.valid & span.words[word]
                    inside = footprint.word + word <= self.last_word
                    reached = (span.first[bits:] <= word) & (word <= span.last[bits:])
                    self.given(
                        m,
                        f"word_{name}_{word}",
                        ~touched | (inside & reached & (span.first <= span.last)),
                    )
                hits.append(
                    (line == self.line)
                    & self.is_drawn
                    & (self.word >= footprint.word)
                    & span.words.bit_select(distance, 1)
                    & (span.first <= column)
                    & (column <= span.last)
                )
        draws = Signal()
        m.d.comb += draws.eq(taken & ~footprint.end & Cat(hits).any())
        return draws


SWEPT = (
    Fault("swept", BankArbiter, r"sweeping = Signal\(init=1\)", "sweeping = Signal()"),
    Fault("and written", BankArbiter, r"swept = Signal\(init=1\)", "swept = Signal()"),
)
"""The banks have been cleared."""

SWEEPING = (
    Fault("the sweep's last cycle", BankArbiter, r"(sweep = Signal\(.*)\)", r"\1, init=-1)"),
)
"""They have been cleared but for their last words."""


def plan(name, shows, load, depth, *faults, config=TINY, pixel=None, changes=SWEPT, long=False):
    """Return a proof of the window."""
    return Proof(
        name=name,
        shows=shows,
        build=lambda: WindowProperties(config, load, pixel=pixel),
        depth=depth,
        engine="abc bmc3",
        changes=changes,
        faults=faults,
        slow=True,
        long=long,
    )


PROOFS = [
    plan(
        "window of banks",
        "a pixel leaves with its own line, as it was drawn, once; none is lost or invented",
        0,
        13,
        Fault("the word of the element before", Scatter, r"same & deal\.want & valid.*\)\)", "0)"),
        Fault("only its first words", Scatter, r" & ~several\.any\(\)", ""),
        Fault("a bank left out", Emitter, r"range\(banks\)", "range(banks - 1)", "_words"),
        Fault("right border", Emitter, r"pixel > self", "pixel >= self", "_inside"),
        Fault("flushed beside an element", BankArbiter, r"sought & ~kept & ", "0 & "),
        Fault("closed before it is drawn", Window, r"& ~scatter\.o\.valid & loader", "& loader"),
        Fault("left before it is written", Window, r"top\.eq\(retired\)", "top.eq(top)"),
        Fault("over too early", Changeover, r"self\.clean \| self", "1 | self"),
        Fault(
            "over before all are asked for",
            BankWalker,
            r"Cat\(found, left, self\.flush\.valid\)",
            "self.flush.valid",
        ),
        Fault("a line left too early", BankWalker, r"line < self\.top", "line <= self.top"),
        Fault("the front too early", BankWalker, r"sole & self\.idle & jumps", "sole & jumps"),
        Fault("what is written behind it", BankWalker, r"jumps & empty", "jumps"),
    ),
    plan(
        "window of banks, two words",
        "the same where beats have two words",
        0,
        13,
        Fault("left for right", Emitter, r"= turned\(.*line\)", "= 0", "_words"),
        Fault("what was not asked for", Bank, r"Mux\(taken\.clear, ", "Mux(1, "),
        Fault(
            "one of two is enough", BankArbiter, r"halves & blocked\)\.any", "halves & blocked).all"
        ),
        config=TWO_WORDS,
    ),
    plan(
        "window of sixteen banks",
        "the same with sixteen banks",
        0,
        13,
        *(
            Fault(name, ShareOfSixteen, pattern, text, "find")
            for name, pattern, text in (
                ("the middle word for an outer one", r"word\[0\] \^ member", "word[0]"),
                ("the line eight below", r"group\[residue\]\[0\] \^", "group[0][0] &"),
                ("dealt once", r"several\.eq\(.*\)", "several.eq(0)"),
            )
        ),
        Fault("flushed beside an element", BankArbiter, r"sought & ~kept & ", "0 & "),
        config=SIXTEEN,
    ),
    plan(
        "window of sixteen banks, words of eight",
        "the same with words of eight pixels",
        0,
        13,
        *(
            Fault(name, ShareOfPair, pattern, text, "find")
            for name, pattern, text in (
                ("the left word for the right", r"word\[0\] \^ member", "word[0]"),
                ("from its word's first pixel on", r"~right \| first\[3\]", "first[3]"),
                ("to its word's last pixel", r"right \| ~last\[3\]", "~last[3]"),
            )
        ),
        config=EIGHT,
    ),
    plan(
        "window of banks, sweep",
        "the same from the sweep's last cycle on",
        0,
        9,
        Fault("drawn while it is swept", BankArbiter, r"(draw\.valid) & ~swept", r"\1"),
        changes=SWEEPING,
    ),
    plan(
        "window of banks, one pixel",
        "the same for one pixel of one place",
        0,
        16,
        Fault("the colour of before", Scatter, r"moves\.eq\(step\)", "moves.eq(self.i.ready)"),
        Fault("found, and lost", BankWalker, r"reading & \(moves.*\)\)", "reading)"),
        Fault("two wait already", BankWalker, r" & ~second_valid\)", ")"),
        Fault("marks lost", BankWalker, r"here & ~marks\.busy", "here"),
        pixel=(Const(2, 4), Const(1, 2), Const(1, 2)),
        long=True,
    ),
    plan(
        "window of banks, initial raster",
        "the same for frames that start from an initial raster",
        1,
        12,
        Fault("loaded where one leaves", BankArbiter, r"& ~again\b", ""),
        Fault("loaded where one draws", BankArbiter, r"deal\.want, line\)", "deal.want & 0, line)"),
        Fault("lost to an element", BankArbiter, r"held = kept", "held = ~pressing & kept"),
        Fault("an element lost to it", BankArbiter, r"want, first_line", "want, leaving.line"),
        Fault("loaded beyond the window", Loader, r"& ~drop & in_window", "& ~drop"),
        Fault(
            "limit a line too far", Loader, r"(limit\.eq\(Mux\(in_window, beat\.line)", r"\1 + 1"
        ),
        Fault("front a line too far", Loader, r"oldest, loaded\)", "oldest, loaded + 1)"),
        Fault("left before it was loaded", BankWalker, r"self\.jump \| (\(line < )", r"1 | \1"),
        Fault("left while it is loaded", BankWalker, r"line < self\.limit", "line <= self.limit"),
        Fault("a load unmarked", Bank, r" \| taken\.load", ""),
    ),
    plan(
        "window of banks, one initial raster after another",
        "the same, until a frame's first word meets the last one of the frame before",
        1,
        13,
        Fault("where one is still to leave", BankArbiter, r"refused \| self\.early", "refused"),
        long=True,
    ),
    plan(
        "window of banks, initial raster of two words",
        "the same where beats have two words",
        1,
        12,
        Fault("the right word is lost", Halver, r"left_empty \| right_empty", "1"),
        Fault("the left word for the right", Window, r"= load\.word\[0\]", "= 0", "_loaded"),
        config=TWO_WORDS,
        long=True,
    ),
    plan(
        "window of sixteen banks, initial raster",
        "the same with sixteen banks",
        1,
        12,
        Fault(
            "loaded into another bank",
            BankArbiter,
            r"word\[0\] \^ turned\(.*\)",
            "line[0]",
        ),
        config=SIXTEEN,
        long=True,
    ),
]
