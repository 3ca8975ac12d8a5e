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

    **Latency**: 2 cycles. **Throughput**: one element a cycle; a frame's first comes three cycles
    after the ``end`` token before it at the soonest, as the window must have moved on.

    Members
    -------
    i : In(stream of GeometryLayout)
        Elements, and ``end`` tokens.
    o : Out(stream of BlockLayout)
        Blocks; for an ``end`` token one without pixels, to be taken when the frame before is out.
    moves : Out(1)
        What ``o`` has in the next cycle is of the element at hand, or nothing: its colour moves on.
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
                "oldest": In(signed(config.line_bits + 2)),
                "last_column": In(config.x_bits),
                "last_line": In(config.line_bits),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        element = self.i.payload
        block = Signal(BlockLayout(self.config))
        there = Signal()  # an element, or the end
        near = Signal()  # its lines are in the window
        may, step, valid = Signal(), Signal(), Signal()
        held = {
            name: Signal.like(getattr(element, name), name=name, reset_less=True)
            for name in ("x", "z", "top", "end")
        }
        m.d.comb += [
            may.eq(held["end"] | near),
            step.eq(~valid | self.o.ready),
            self.moves.eq(step),
            self.i.ready.eq(~there | (step & may)),
            *(block[name].eq(held[name]) for name in ("z", "end")),
        ]
        with m.If(self.i.ready):
            m.d.sync += [held[name].eq(getattr(element, name)) for name in held]
            m.d.sync += there.eq(self.i.valid)

        given = Signal(BlockLayout(self.config), reset_less=True)
        top = Signal(element.top.shape(), name="given_top", init=-ROWS)
        m.d.comb += [self.o.valid.eq(valid), self.o.payload.eq(given), self.o.payload.top.eq(top)]
        place = Signal.like(held["x"], name="given_x", reset_less=True)
        with m.If(step):
            m.d.sync += [
                valid.eq(there & may),
                given.eq(block),
                place.eq(held["x"]),
                given.meets.eq(
                    self._meets(m, held["top"] - top, held["x"] - place) & valid & self.o.ready
                ),
            ]
            with m.If(there):
                m.d.sync += top.eq(held["top"])
            with m.Elif(valid & given.end):
                m.d.sync += top.eq(-ROWS)  # of the next frame

        # Known a cycle ahead, because all before it waits for it. While the element at hand waits,
        # the one behind it is not looked at, and comes as one whose lines are not there.
        waiting = Signal()
        behind = Signal(signed(len(held["top"]) + 1))
        m.d.comb += [
            waiting.eq(there & ~near),
            behind.eq(self.oldest - Mux(waiting, held["top"], element.top)),
        ]
        # Until an end token was taken, ``oldest`` is not of the frame behind it.
        ending = (there & held["end"]) | (valid & given.end)
        with m.If((waiting & self.i.ready) | ending):
            m.d.sync += near.eq(0)
        with m.Elif(waiting | self.i.ready):
            # A line takes the place of one that left some cycles ago: so less than that many lines
            # ahead of the window.
            bits = self.config.slot_bits
            within = behind[:bits] > BLOCK
            m.d.sync += near.eq(~behind[-1] | (behind[bits:].all() & within))
        self._place(m, element, held, block)
        return m

    def _place(self, m, element, held, block):
        """Lay the rows out in ``block``, from what was registered of the element."""
        bits = self.config.pixel_bits
        shape = ShapeRows(m, element)
        shifted = Signal(reset_less=True)
        rows = [Signal(BLOCK, name=f"row_{k}", reset_less=True) for k in range(2 * ROWS)]
        words_left = Signal(signed(self.config.word_bits + 1))
        inside = Signal(2, reset_less=True)  # which of the block's two words lie in the image
        m.d.comb += words_left.eq(self.last_column[bits:] - element.x[bits:])
        masks = [Signal(BLOCK, name=f"mask_{k}") for k in range(ROWS)]
        for row, mask in zip(shape.rows, masks, strict=True):
            m.d.comb += mask.eq(Cat((row.first <= c) & (row.last >= c) for c in range(BLOCK)))
        turned = [mask[::-1] for mask in masks[::-1]]
        with m.If(self.i.ready):
            m.d.sync += [
                shifted.eq(shape.shifted),
                inside.eq(Cat(words_left >= word for word in range(2))),
            ]
            for k in range(ROWS):
                # A raised shape's row 3 is in its middle and has no half turn.
                raised = turned[k + 1] if k + 1 < ROWS else 0
                lower = Mux(shape.raised, raised, turned[k])
                m.d.sync += [
                    rows[k].eq(masks[k]),
                    rows[ROWS + k].eq(Mux(element.mode, 0, lower)),
                ]

        # To the columns of the lanes. Of the lower rows each may lie a column further right.
        x, line = held["x"], held["top"]
        m.d.comb += [block.words[0].eq(x[bits:]), block.words[1].eq(x[bits:] + 1)]
        columns, halves = [], []
        for part, shift in ((0, 0), (1, shifted)):
            begin = Signal(bits + 1, name=f"begin_{part}")
            beyond = Signal(BLOCK, name=f"beyond_{part}")  # in the second word
            m.d.comb += [
                begin.eq(x[:bits] + shift),
                beyond.eq(Cat(begin > column for column in range(BLOCK))),
            ]
            halves.append(beyond ^ x[bits].replicate(BLOCK))
            clip = Mux(inside[1], -1, ~beyond) & Mux(inside[0], -1, beyond)
            columns += [
                _turn(row, begin[:bits]) & clip[:BLOCK]
                for row in rows[part * ROWS : (part + 1) * ROWS]
            ]

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
        with m.If(self.i.ready):
            m.d.sync += left.eq(Mux(groups < 0, 0, Mux(groups > 3, 3, groups)))
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
