"""The tiler of the blocks engine: rotates an element's block to the lanes."""

from amaranth.hdl import Cat, Module, Mux, Signal, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import BLOCK, ROWS, EngineConfig
from splatline.rtl.layouts import GeometryLayout
from splatline.rtl.shapes.rows import ShapeRows

from .layouts import BlockLayout, ClearedLayout

__all__ = ["BlockTiler"]


def _kept(config: EngineConfig) -> tuple[str, ...]:
    """Return the fields of an element that the tiler's first stages keep as they are."""
    return ("mode", "x", "z", "top", "end", *(("plane",) if config.plane else ()))


class ShapeLayout(data.StructLayout):
    """An element's rows, and how they are rotated and clipped.

    ``rows``: the columns of each row, from X on; those of the lower four rows begin one column
    further right if ``shifted``. ``turns``: the lane of the first column, one-hot, for the upper
    four rows and for the lower four. ``inside``: the word of X, and the one after it, lies in the
    image. ``groups``: groups of eight lines from that of the first row to the image's last, 0..3: 0
    if the image ends above the block, 3 for three or more. The others as in
    :class:`GeometryLayout`.
    """

    def __init__(self, config: EngineConfig):
        element = GeometryLayout(config).members
        super().__init__(
            {
                **{name: element[name] for name in _kept(config)},
                "rows": data.ArrayLayout(BLOCK, BLOCK),
                "shifted": 1,
                "turns": data.ArrayLayout(BLOCK, 2),
                "inside": 2,
                "groups": 2,
            }
        )


class TurnedLayout(data.StructLayout):
    """The rows with their columns rotated to the lanes, and clipped to the image's words.

    ``odd``: columns that lie in odd words, of the upper four rows and of the lower four.
    """

    def __init__(self, config: EngineConfig):
        names = (*_kept(config), "rows", "groups")
        shape = ShapeLayout(config).members
        super().__init__(
            {
                **{name: shape[name] for name in names},
                "odd": data.ArrayLayout(BLOCK, 2),
            }
        )


class BlockTiler(wiring.Component):
    """Rotates the pixels of an element's block to the lanes, one element a cycle.

    A block has eight lines of eight columns, one for each residue of line and column, wherever it
    lies. Rows and columns are rotated to their residues, and clipped to the image, columns by whole
    words. If the centre of a shape lies at half a pixel, its lower rows begin a column further
    right, or a line higher, or both.

    Stall: an element waits here until its lines are in the window, and none of them has the slot of
    a line that is still being cleared. Its ``top`` is given while it waits, so that the lines above
    it may leave. If the window is about to move to its lines (``empties``), it goes at that moment.

    **Latency**: 4 cycles. **Throughput**: one element a cycle; a frame's first comes two cycles
    after the ``end`` token before it at the soonest, as the window must have moved on.

    Members
    -------
    i : In(stream of GeometryLayout)
        Elements, and ``end`` tokens.
    o : Out(stream of BlockLayout)
        Blocks. An ``end`` token becomes one without pixels, to be taken when the frame before is
        out.
    moves : Out(1)
        In the next cycle all stages hold the elements after those that they hold now, or none:
        their colours advance.
    oldest : In(signed(line_bits + 2))
        First line of the window as far as it was loaded, in lines of the frame that is drawn. Once
        an ``end`` token is taken from ``o``, this is the next frame.
    cleared : In(ClearedLayout)
        This slot is not free in this cycle and in the next.
    empties : In(1)
        The window moves to the ``top`` of the element that waits. All slots are free but that of
        ``cleared`` and that of the line of ``oldest``, the latter for two more cycles.
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
                "cleared": In(ClearedLayout(config)),
                "empties": In(1),
                "last_column": In(config.x_bits),
                "last_line": In(config.line_bits),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        element = self.i.payload
        # Four stages: the element's rows; the rows rotated to the columns of lanes; the pixels in
        # their lanes; the block with ``touch`` and ``rows``.
        shaped = Signal()
        there = Signal()
        laid = Signal()
        offered = Signal()
        # They move on together and keep gaps between elements, because ``o.ready`` is late.
        steps = Signal()
        m.d.comb += [
            steps.eq(~offered | (self.o.valid & self.o.ready)),
            self.moves.eq(steps),
            self.i.ready.eq(steps),
        ]
        shape = Signal(ShapeLayout(self.config), reset_less=True)
        turned = Signal(TurnedLayout(self.config), reset_less=True)
        lanes = Signal(BlockLayout(self.config), reset_less=True)
        last = Signal(BlockLayout(self.config), reset_less=True)
        top = Signal.like(last.top, name="last_top", init=-ROWS)  # stays until the next element
        rows, columns, pixels = self._shape(m, element), self._turn(m, shape), self._lay(m, turned)
        with m.If(steps):
            m.d.sync += [
                Cat(shaped, there, laid, offered).eq(Cat(self.i.valid, shaped, there, laid)),
                shape.eq(rows),
                turned.eq(columns),
                lanes.eq(pixels),
                last.eq(lanes),
                last.rows.eq(Cat(mask.any() for mask in lanes.mask)),
            ]
            m.d.sync += [
                touch.eq(Cat((mask & odd).any(), (mask & ~odd).any()))
                for touch, mask, odd in zip(last.touch, lanes.mask, lanes.odd, strict=True)
            ]
            if self.config.plane:
                m.d.sync += [
                    sums.eq(line + (lanes.z << 1))
                    for sums, line in zip(last.lines, lanes.lines, strict=True)
                ]
            with m.If(laid):
                m.d.sync += top.eq(lanes.top)
            with m.Elif(offered & last.end):
                m.d.sync += top.eq(-ROWS)  # of the next frame

        # ``near``: the lines of the last stage's element are in the window. It is a register,
        # because all stages before stall for it. While an element waits, the next one is not
        # compared: when it comes, its lines count as missing.
        near = Signal()
        waiting = Signal()
        wanted, mode = Mux(waiting, top, lanes.top), waiting & last.mode
        behind = Signal(signed(len(top) + 1))
        left = Signal(self.config.slot_bits)  # lines from ``wanted`` to the slot that is cleared
        m.d.comb += [
            waiting.eq(offered & ~near),
            behind.eq(self.oldest - wanted),
            left.eq(self.cleared.place - wanted),
            self.o.valid.eq(offered & (near | last.end)),
            self.o.payload.eq(last),
            self.o.payload.top.eq(top),
        ]
        # Until an end token is taken, ``oldest`` is of the frame that it ends.
        with m.If(offered & last.end):
            m.d.sync += near.eq(0)
        with m.Elif(waiting | steps):
            bits = self.config.slot_bits
            there = ~behind[-1] | (behind[bits:].all() & (behind[:bits] > BLOCK))
            comes = self.empties & waiting & _outside(behind[:bits], mode)
            m.d.sync += near.eq((there | comes) & ~(self.cleared.valid & ~_outside(left, mode)))
        return m

    def _shape(self, m, element):
        """Return the columns of an element's rows, and how they are rotated and clipped."""
        config = self.config
        bits = config.pixel_bits
        rows = Signal(ShapeLayout(config))
        shape = ShapeRows(m, element)
        masks = [Signal(BLOCK, name=f"mask_{k}") for k in range(ROWS)]
        for row, mask in zip(shape.rows, masks, strict=True):
            m.d.comb += mask.eq(Cat((row.first <= c) & (row.last >= c) for c in range(BLOCK)))
        # Row 3 of a raised shape is its middle row and has no half rotation.
        halves = [mask[::-1] for mask in masks]
        if config.plane:
            halves = self._half_turns(m, element, shape)
        turned = halves[::-1]
        raised = [*turned[1:], 0]
        # The lower rows and ``groups`` are masked by gates. Yosys would make a reset of the
        # register from a Mux with 0, which depends on ``ready`` and would be late.
        whole = ~element.mode.replicate(BLOCK)
        lower = [
            Mux(shape.raised, high, low) & whole for high, low in zip(raised, turned, strict=True)
        ]
        first = Signal(BLOCK)
        words_left = Signal(signed(config.word_bits + 1))
        groups = Signal(signed(len(element.top)))
        m.d.comb += [
            first.eq(_one_of(element.x[:bits])),
            words_left.eq(self.last_column[bits:] - element.x[bits:]),
            groups.eq((self.last_line >> 3) - (element.top >> 3) + 1),
        ]
        more = groups[2:-1].any()
        m.d.comb += [rows[name].eq(element[name]) for name in _kept(config)]
        m.d.comb += [
            rows.rows.eq(Cat(*masks, *lower)),
            rows.shifted.eq(shape.shifted),
            rows.turns.eq(Cat(first, Mux(shape.shifted, first.rotate_left(1), first))),
            rows.inside.eq(Cat(words_left >= word for word in range(2))),
            rows.groups.eq(Cat(groups[0] | more, groups[1] | more) & ~groups[-1].replicate(2)),
        ]
        return rows

    def _half_turns(self, m, element, shape):
        """Return the half turns of a plane word's rows as masks.

        A row has the columns from its first one on that are not after its last one. An end is moved
        by a shift of all columns on its inner side, which keep the block's outermost one: no end
        leaves the block.
        """
        masks = []
        for k, row in enumerate(shape.rows):
            # The half turn's first column comes from the row's last one. What belongs to its last
            # column is mirrored.
            ends = (
                Cat(row.last >= BLOCK - 1 - c for c in range(BLOCK)),
                Cat(row.first <= c for c in range(BLOCK)),
            )
            moved = []
            for end, columns in enumerate(ends):
                given = Signal(BLOCK, name=f"inner_{k}_{end}")
                shifted = Signal(BLOCK, name=f"moved_{k}_{end}")
                inwards = Cat(0, given[: BLOCK - 2], 1)
                outwards = Cat(given[1:], 1)
                moves = element.sides[2 * k + end] & shape.filled[k]
                m.d.comb += [
                    given.eq(columns),
                    shifted.eq(Mux(moves, Mux(element.outwards[end], outwards, inwards), given)),
                ]
                moved.append(shifted)
            masks.append(moved[0] & moved[1][::-1])
        return masks

    def _turn(self, m, shape):
        """Return the rows with their columns rotated to the lanes, and clipped.

        A multiplication by a power of two rotates a row's pixels.
        """
        turned = Signal(TurnedLayout(self.config))
        bits = self.config.pixel_bits
        kept = (*_kept(self.config), "groups")
        m.d.comb += [turned[name].eq(shape[name]) for name in kept]
        # The lower rows may lie a column further right.
        for part, shift in enumerate((0, shape.shifted)):
            begin = Signal(bits + 1, name=f"begin_{part}")
            beyond = Signal(BLOCK, name=f"beyond_{part}")  # in the second word
            m.d.comb += [
                begin.eq(shape.x[:bits] + shift),
                beyond.eq(Cat(begin > column for column in range(BLOCK))),
                turned.odd[part].eq(beyond ^ shape.x[bits].replicate(BLOCK)),
            ]
            clip = Mux(shape.inside[1], -1, ~beyond) & Mux(shape.inside[0], -1, beyond)
            for k in range(part * ROWS, part * ROWS + ROWS):
                product = Signal(2 * BLOCK, name=f"turned_{k}")
                m.d.comb += [
                    product.eq(shape.rows[k] * shape.turns[part]),
                    turned.rows[k].eq((product[:BLOCK] | product[BLOCK:]) & clip),
                ]
        return turned

    def _lay(self, m, turned):
        """Return the block, with the pixels of its columns rotated to their lines.

        A multiplication would take a multiplier, which lies far away.
        """
        block = Signal(BlockLayout(self.config))
        bits = self.config.pixel_bits
        top = turned.top
        m.d.comb += [block[name].eq(turned[name]) for name in ("z", "mode", "top", "end")]
        m.d.comb += [block.words[n].eq(turned.x[bits:] + n) for n in range(2)]
        inside = self._lines(m, turned, block)
        for p in range(BLOCK):
            column = _rotate(m, Cat(row[p] for row in turned.rows), top[:3], f"column_{p}")
            m.d.comb += Cat(mask[p] for mask in block.mask).eq(column & inside)
        for q in range(BLOCK):
            row = Signal(3, name=f"row_of_{q}")
            m.d.comb += [
                row.eq(q - top[:3]),
                block.odd[q].eq(Mux(row[2], turned.odd[1], turned.odd[0])),
            ]
            if self.config.plane:
                m.d.comb += block.lines[q].eq(turned.plane.down * row)
        if self.config.plane:
            for p in range(BLOCK):
                column = Signal(bits, name=f"column_of_{p}")
                m.d.comb += [
                    column.eq(p - turned.x[:bits]),
                    block.columns[p].eq(turned.plane.across * column),
                ]
        return block

    def _lines(self, m, turned, block):
        """Set the slots of the block's lines; return the lines in the image, by residue.

        A line lies in the group of eight lines of the block's first row, or in the next group.
        """
        top, left = turned.top, turned.groups
        inside = Signal(BLOCK)
        for q in range(BLOCK):
            low = self.last_line[:3] >= q
            is_next = top[:3] > q
            m.d.comb += [
                block.group[q].eq(top[3 : self.config.slot_bits] + (top[:3] > q)),
                inside[q].eq(
                    Mux(
                        is_next,
                        left[1] & (left[0] | low),
                        ~top[-1] & (left[1] | (left[0] & low)),
                    )
                ),
            ]
        return inside


def _outside(lines, mode):
    """Return whether a slot lies outside a block: below its eighth line, or fourth with ``mode``.

    ``lines``: slots from that of the block's first line, modulo the window's height.
    """
    return lines[3:].any() | (mode & lines[2])


def _rotate(m, bits, places, name):
    """Return bits rotated by a number of places towards the highest."""
    for stage, by in enumerate(places):
        rotated = Signal(len(bits), name=f"{name}_{stage}")
        m.d.comb += rotated.eq(Mux(by, bits.rotate_left(1 << stage), bits))
        bits = rotated
    return bits


def _one_of(number):
    """Return a number one-hot; ``1 << number`` would become a Mux with 0 (see ``_shape``)."""
    return Cat(number == n for n in range(1 << len(number)))
