"""Laying an element's whole block out for lanes that take it in a cycle."""

from amaranth.hdl import Cat, Module, Mux, Signal, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from .format import BLOCK, ROWS, EngineConfig
from .layouts import BlockLayout, GeometryLayout
from .shape_rows import ShapeRows

__all__ = ["BlockTiler"]


class BlockTiler(wiring.Component):
    """Gives an element's pixels in one cycle, dealt to the lanes of the window.

    A block has eight lines of eight columns, one for each residue of either, wherever it lies: its
    rows are turned to theirs, and its columns to theirs, and clipped to the image (columns by whole
    words). What is turned of a shape whose middle lies at a half place begins a column further
    right, or has its rows a line higher.

    An element waits here until its lines are in the window. Meanwhile its ``top`` is known already,
    so that the lines above it may leave.

    **Latency**: 3 cycles. **Throughput**: one element a cycle; a frame's first comes two cycles
    after the ``end`` token before it at the soonest, as the window must have moved on.

    Members
    -------
    i : In(stream of GeometryLayout)
        Elements, and ``end`` tokens.
    o : Out(stream of BlockLayout)
        Blocks; for an ``end`` token one without pixels, to be taken when the frame before is out.
    moves : Out(1)
        An element's pixels are in lanes in the next cycle, or none's: its colour moves on.
    settles : Out(1)
        What ``o`` has in the next cycle is of the element behind, or nothing: so again.
    oldest : In(signed(line_bits + 2))
        First line of the window as far as it was loaded, of the frame that is drawn: which is the
        next one as soon as an ``end`` token was taken from ``o``.
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
                "o": Out(stream.Signature(BlockLayout(config))),
                "moves": Out(1),
                "settles": Out(1),
                "oldest": In(signed(config.line_bits + 2)),
                "last_column": In(config.x_bits),
                "last_line": In(config.line_bits),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        element = self.i.payload
        # Three stages: the element's rows, its pixels in lanes, and those with all that is said of
        # them together.
        there, laid, offered = Signal(), Signal(), Signal()
        taken, steps = Signal(), Signal()  # what the last stage has is; it moves on
        m.d.comb += [
            taken.eq(self.o.valid & self.o.ready),
            steps.eq(~offered | taken),
            self.settles.eq(steps),
            self.moves.eq(steps | ~laid),
            self.i.ready.eq(self.moves | ~there),
        ]
        x, place, last_place = (
            Signal.like(element.x, name=f"x_{stage}", reset_less=True) for stage in range(3)
        )
        names = ("z", "top", "end")
        held = {name: Signal.like(element[name], name=name, reset_less=True) for name in names}
        block = Signal(BlockLayout(self.config))
        lanes = Signal(BlockLayout(self.config), reset_less=True)
        last = Signal(BlockLayout(self.config), reset_less=True)
        top = Signal.like(last.top, name="last_top", init=-ROWS)  # it stays where nothing follows
        m.d.comb += [block[name].eq(held[name]) for name in names]
        with m.If(self.i.ready):
            m.d.sync += [held[name].eq(element[name]) for name in names]
            m.d.sync += [there.eq(self.i.valid), x.eq(element.x)]
        with m.If(self.moves):
            m.d.sync += [laid.eq(there), lanes.eq(block), place.eq(x)]
        with m.If(steps):
            m.d.sync += [offered.eq(laid), last.eq(lanes), last_place.eq(place)]
            m.d.sync += [
                touch.eq(Cat((mask & odd).any(), (mask & ~odd).any()))
                for touch, mask, odd in zip(last.touch, lanes.mask, lanes.odd, strict=True)
            ]
            m.d.sync += last.meets.eq(self._meets(m, lanes.top - top, place - last_place) & taken)
            with m.If(laid):
                m.d.sync += top.eq(lanes.top)
            with m.Elif(offered & last.end):
                m.d.sync += top.eq(-ROWS)  # of the next frame

        # Whether the lines of what the last stage has are in the window is known a cycle ahead,
        # because all before it waits for it. While it waits itself, what is behind it is not looked
        # at, and comes as one whose lines are not there.
        near, waiting = Signal(), Signal()
        behind = Signal(signed(len(top) + 1))
        m.d.comb += [
            waiting.eq(offered & ~near),
            behind.eq(self.oldest - Mux(waiting, top, lanes.top)),
            self.o.valid.eq(offered & (near | last.end)),
            self.o.payload.eq(last),
            self.o.payload.top.eq(top),
        ]
        # Until an end token was taken, ``oldest`` is not of the frame behind it.
        with m.If(offered & last.end):
            m.d.sync += near.eq(0)
        with m.Elif(waiting | steps):
            # A line takes the place of one that left some cycles ago: so less than that many lines
            # ahead of the window.
            bits = self.config.slot_bits
            within = behind[:bits] > BLOCK
            m.d.sync += near.eq(~behind[-1] | (behind[bits:].all() & within))
        self._place(m, element, x, held["top"], block)
        return m

    def _place(self, m, element, x, line, block):
        """Lay the rows out in ``block``, from what was registered of the element."""
        bits = self.config.pixel_bits
        shape = ShapeRows(m, element)
        masks = [Signal(BLOCK, name=f"mask_{k}") for k in range(ROWS)]
        for row, mask in zip(shape.rows, masks, strict=True):
            m.d.comb += mask.eq(Cat((row.first <= c) & (row.last >= c) for c in range(BLOCK)))
        # A raised shape's row 3 is in its middle and has no half turn.
        turned = [mask[::-1] for mask in masks[::-1]]
        raised = [*turned[1:], 0]
        lower = [
            Mux(element.mode, 0, Mux(shape.raised, high, low))
            for high, low in zip(raised, turned, strict=True)
        ]

        # To the columns of the lanes, clipped. The lower rows may lie a column further right.
        words_left = Signal(signed(self.config.word_bits + 1))
        inside = Signal(2)  # which of the block's two words lie in the image
        m.d.comb += [
            words_left.eq(self.last_column[bits:] - element.x[bits:]),
            inside.eq(Cat(words_left >= word for word in range(2))),
            block.words[0].eq(x[bits:]),
            block.words[1].eq(x[bits:] + 1),
        ]
        columns = [Signal(BLOCK, name=f"row_{k}", reset_less=True) for k in range(2 * ROWS)]
        halves = []
        for part, (rows, shift) in enumerate(((masks, 0), (lower, shape.shifted))):
            begin = Signal(bits + 1, name=f"begin_{part}")
            beyond = Signal(BLOCK, name=f"beyond_{part}")  # in the second word
            half = Signal(BLOCK, name=f"half_{part}", reset_less=True)
            m.d.comb += [
                begin.eq(element.x[:bits] + shift),
                beyond.eq(Cat(begin > column for column in range(BLOCK))),
            ]
            clip = Mux(inside[1], -1, ~beyond) & Mux(inside[0], -1, beyond)
            with m.If(self.i.ready):
                m.d.sync += half.eq(beyond ^ element.x[bits].replicate(BLOCK))
                m.d.sync += [
                    column.eq(_turn(row, begin[:bits]) & clip[:BLOCK])
                    for column, row in zip(columns[part * ROWS :][:ROWS], rows, strict=True)
                ]
            halves.append(half)

        # To the lines of the lanes: a multiplier turns the pixels of a column, by a power of two.
        turn = Signal(BLOCK)
        here, past = self._lines(m, element, line, block)
        m.d.comb += turn.eq(1 << line[:3])
        for p in range(BLOCK):
            product = Signal(2 * BLOCK, name=f"product_{p}")
            m.d.comb += product.eq(Cat(row[p] for row in columns) * turn)
            for q in range(BLOCK):
                pixel = (product[q] & here[q]) | (product[BLOCK + q] & past[q])
                m.d.comb += block.mask[q][p].eq(pixel)
        for q in range(BLOCK):
            row = Signal(3, name=f"row_of_{q}")
            m.d.comb += [
                row.eq(q - line[:3]),
                block.odd[q].eq(Mux(row[2], halves[1], halves[0])),
            ]

    def _lines(self, m, element, top, block):
        """Place the block's lines; return which of them lie in the image, by residue.

        Those in the group of eight lines that its first row is in, and those in the next group.
        """
        # Groups of eight lines from the block's first to the image's last, 0..3: 0 if it lies
        # below, 3 stands for more.
        groups = Signal(signed(len(top)))
        left = Signal(2, reset_less=True)
        m.d.comb += groups.eq((self.last_line >> 3) - (element.top >> 3) + 1)
        more = groups[2:-1].any()
        with m.If(self.i.ready):
            # Not as a choice, which would clear the register from where ``ready`` is known last.
            m.d.sync += left.eq(Cat(groups[0] | more, groups[1] | more) & ~groups[-1].replicate(2))
        here, past = Signal(BLOCK), Signal(BLOCK)
        for q in range(BLOCK):
            low = self.last_line[:3] >= q
            m.d.comb += [
                block.group[q].eq(top[3 : self.config.slot_bits] + (top[:3] > q)),
                here[q].eq(~top[-1] & (left[1] | (left[0] & low))),
                past[q].eq(left[1] & (left[0] | low)),
            ]
        return here, past

    def _meets(self, m, lines, columns):
        """Return whether two blocks may have a pixel in common, so many lines and columns apart."""
        bits = self.config.slot_bits
        near = Signal(name="near_columns")
        apart = Signal(self.config.x_bits)
        m.d.comb += [
            apart.eq(columns),
            # Up to 8 to either side, as what is turned may lie a column further right.
            near.eq(apart[3:].all() | (~apart[4:].any() & ~(apart[3] & apart[:3].any()))),
        ]
        return ~lines[3:bits].any() & near


def _turn(bits, amount):
    """Return bits turned left by an amount, a power of two at a time."""
    for stage in range(len(amount)):
        bits = Mux(amount[stage], bits.rotate_left(1 << stage), bits)
    return bits
