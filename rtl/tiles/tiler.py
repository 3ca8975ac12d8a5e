"""The tiler of the tiles engine: cuts elements into tiles."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import BLOCK, EngineConfig
from splatline.rtl.layouts import GeometryLayout, sum_bits
from splatline.rtl.lib.mux import number_of, pick
from splatline.rtl.shapes.rows import ShapeRows

from .layouts import PlaneTileLayout, TileLayout
from .overlap import overlap

__all__ = ["Tiler"]

SIDE = 4
"""Lines of a tile."""


class Tiler(wiring.Component):
    """Cuts elements into tiles, one a cycle, with their pixels rotated to the window's lanes.

    A tile is four lines high and as wide as a window word. With four pixels a word, an element's
    block of 8 x 8 pixels has four tiles, and a fraction of 8 x 4 has two. The tiles are aligned to
    the element, not to the image, so an element of up to 4 x 4 pixels is one tile at any position.
    Tiles without pixels take no cycle.

    The pixels of a tile lie in different lanes, one for each residue of line and column. Rows and
    columns are rotated to their residues, and clipped to the image, columns by whole words. If the
    centre of a shape lies at half a pixel, its lower tiles begin a column further right, or a line
    higher, or both.

    Stall: an element waits here until its lines are in the window. Its ``top`` is given while it
    waits, so that the lines above it may leave.

    **Latency**: 2 cycles. **Throughput**: one tile a cycle; a frame's first comes three
    cycles after the ``end`` token before it at the soonest, as the window must have moved on.

    Members
    -------
    i : In(stream of GeometryLayout)
        Elements, and ``end`` tokens.
    o : Out(stream of TileLayout, or of PlaneTileLayout)
        Tiles. An ``end`` token becomes one without pixels, to be taken when the frame before is
        out.
    moves : Out(1)
        In the next cycle ``o`` has a tile of the element that waits here, or none: its colour
        advances.
    oldest : In(signed(line_bits + 2))
        First line of the window as far as it was loaded, in lines of the frame that is drawn. Once
        an ``end`` token is taken from ``o``, this is the next frame.
    last_column : In(x_bits)
        Width of the image less 1; steady during a frame, as is the height.
    last_line : In(line_bits)
        Height of the image less 1.
    ending : In(1)
        With planes: an ``end`` token that was taken from ``o`` is not yet in the window.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        self.across = BLOCK // config.pixels_per_word  # tiles that lie side by side
        self.tile = PlaneTileLayout(config) if config.plane else TileLayout(config)
        super().__init__(
            {
                "i": In(stream.Signature(GeometryLayout(config))),
                "o": Out(stream.Signature(self.tile)),
                "moves": Out(1),
                "oldest": In(signed(config.line_bits + 2)),
                "last_column": In(config.x_bits),
                "last_line": In(config.line_bits),
                **({"ending": In(1)} if config.plane else {}),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        element = self.i.payload
        tile = Signal(self.tile)
        there = Signal()  # an element or an end token waits
        left = Signal(2 * self.across)  # tiles still to give: upper ones from the left, lower ones
        first = Signal.like(left)  # the next one
        rest = Signal.like(left)
        near = Signal(2)  # the lines of the upper, of the lower tiles are in the window
        may = Signal()  # the lines of the next tile are
        step = Signal()
        valid = Signal()
        depth = ("plane",) if self.config.plane else ("z",)
        held = {
            name: Signal.like(getattr(element, name), name=name, reset_less=True)
            for name in ("x", *depth, "top", "end")
        }
        m.d.comb += [
            first.eq(left & (~left + 1)),
            rest.eq(left & ~first),
            step.eq(~valid | self.o.ready),
            self.moves.eq(step),
            self.i.ready.eq(~there | (step & may & ~rest.any())),
            tile.end.eq(held["end"]),
        ]
        with m.If(self.i.ready):
            m.d.sync += [held[name].eq(getattr(element, name)) for name in held]
            m.d.sync += there.eq(self.i.valid)
        with m.Elif(step & may):
            m.d.sync += left.eq(rest)

        given = self._give(m, tile, held, there, may, left, step, valid)
        lower = Signal()
        column = Signal(range(self.across))  # of tiles, from the left
        m.d.comb += [
            lower.eq(~left[: self.across].any()),
            column.eq(number_of(first, len(column))),
            may.eq(held["end"] | Mux(lower, near[1], near[0])),
        ]
        # Until an end token is taken, ``oldest`` is of the frame that it ends.
        ending = (there & held["end"]) | (valid & given.end)
        if self.config.plane:
            ending |= self.ending
        self._compare(m, near, held["top"], there, ending)
        shape, raised, shifted = self._shape(m, element)
        # First column of the tile, from the left edge of the word that X lies in, and its first
        # line modulo 4. Lower tiles may lie a line higher or a column further right.
        place = Signal(self.config.pixel_bits + 1)
        turn = Signal(2)
        m.d.comb += [
            place.eq(held["x"][: self.config.pixel_bits] + (lower & shifted)),
            turn.eq(held["top"][:2] - (lower & raised)),
        ]
        rows, halves = self._rows(m, element, shape, left)
        pixels = self._turn(m, rows, halves, turn, place[:-1], lower, raised, column)
        lines, past = self._lines(m, element, tile, held["top"], lower)
        columns = self._columns(m, element, tile, held["x"], place, column)
        if self.config.plane:
            self._plane(m, element, tile, held["plane"], lower, past, column)
        else:
            m.d.comb += tile.z.eq(held["z"])
        for i in range(SIDE):
            for j in range(self.config.pixels_per_word):
                m.d.comb += tile.mask[i][j].eq(pixels[i][j] & lines[i] & columns[j])
        return m

    def _give(self, m, tile, held, there, may, left, step, valid):
        """Give a tile, or an end token, and its ``top``; return the register that holds it."""
        given = Signal(self.tile, reset_less=True)
        top = Signal(self.i.payload.top.shape(), name="given_top", init=-SIDE)
        m.d.comb += [self.o.valid.eq(valid), self.o.payload.eq(given), self.o.payload.top.eq(top)]
        with m.If(step):
            m.d.sync += [
                valid.eq(there & may & (left.any() | held["end"])),
                given.eq(tile),
            ]
            if not self.config.plane:
                m.d.sync += given.meets.eq(overlap(m, tile, given) & valid & self.o.ready)
            with m.If(there):
                m.d.sync += top.eq(held["top"])
            with m.Elif(valid & given.end):
                m.d.sync += top.eq(-SIDE)  # of the next frame
        return given

    def _compare(self, m, near, top, there, ending):
        """Set ``near``: whether the lines of the upper and of the lower tiles are in the window.

        It is a register, because all stages before stall for it. While an element waits, the next
        one is not compared: when it comes, its lines count as missing.

        A line takes the slot of a line that left some cycles ago. With a window of 16 lines an
        upper tile lies less than 12 lines after the oldest, and a lower one less than 8. A window
        of 8 lines is filled by an element, whose first line must be the oldest.
        """
        waiting = Signal()
        behind = Signal.like(top)
        m.d.comb += [
            waiting.eq(there & ~near.all()),
            behind.eq(self.oldest - Mux(waiting, top, self.i.payload.top)),
        ]
        with m.If((waiting & self.i.ready) | ending):
            m.d.sync += near.eq(0)
        with m.Elif(waiting | self.i.ready):
            bits = self.config.slot_bits
            high, low = behind[bits:].all(), behind[:bits]
            m.d.sync += near.eq(
                Cat(~behind[-1] | (high & (low > SIDE)), ~behind[-1] | (high & (low > 2 * SIDE)))
            )

    def _shape(self, m, element):
        """Return the offered element's rows, and the raised and shifted bits of the held one."""
        shape = ShapeRows(m, element)
        raised, shifted = (Signal(name=name, reset_less=True) for name in ("raised", "shifted"))
        with m.If(self.i.ready):
            m.d.sync += [raised.eq(shape.raised), shifted.eq(shape.shifted)]
        return shape, raised, shifted

    def _rows(self, m, element, shape, left):
        """Return the upper rows and their half turns as masks; note which tiles have a pixel."""
        masks = [Signal(BLOCK, name=f"mask_{k}", reset_less=True) for k in range(SIDE)]
        upper = Signal(self.across)  # the upper tiles that have a pixel, from the left
        turned = Signal(self.across)  # those whose half turn has one
        step = self.config.pixel_bits
        for n in range(self.across):
            reach = Cat(
                (row.first[step:] <= n if n < self.across - 1 else 1)
                & (row.last[step:] >= n if n else 1)
                for row in shape.rows
            )
            reached = shape.filled & reach
            m.d.comb += [
                upper[n].eq(reached.any()),
                turned[n].eq(reached[:3].any() | (reached[3] & ~shape.raised)),
            ]
        halves = [mask[::-1] for mask in masks]
        # The lower half is the upper one's half turn: its left is the upper one's right.
        lower = turned[::-1]
        if self.config.plane:
            halves, lower = self._halves(m, element, shape)
        with m.If(self.i.ready):
            for row, mask in zip(shape.rows, masks, strict=True):
                m.d.sync += mask.eq(Cat((row.first <= c) & (row.last >= c) for c in range(BLOCK)))
            lower &= ~element.mode.replicate(self.across)
            m.d.sync += left.eq(Cat(upper, lower) & ~element.end.replicate(len(left)))
        return masks, halves

    def _halves(self, m, element, shape):
        """Return the half turns of a plane word's rows as masks, and the tiles that have a pixel.

        An end that is moved stays in the block.
        """
        halves, now = [], []
        for k, row in enumerate(shape.rows):
            ends = []
            for end, place in enumerate((row.last, row.first)):
                turned = Signal(3, name=f"turned_{k}_{end}")
                moved = element.sides[2 * k + end] & shape.filled[k]
                out = element.outwards[end] if end else ~element.outwards[end]
                # The half turn of a place is its complement; out is to the right.
                stays = Mux(out, place == 0, place == BLOCK - 1)
                step = Mux(moved & ~stays, Mux(out, -1, 1), 0)
                m.d.comb += turned.eq(~(place + step))
                ends.append(turned)
            half = Signal(BLOCK, name=f"half_{k}", reset_less=True)
            mask = Signal(BLOCK, name=f"half_mask_{k}")
            m.d.comb += mask.eq(Cat((ends[0] <= c) & (ends[1] >= c) for c in range(BLOCK)))
            with m.If(self.i.ready):
                m.d.sync += half.eq(mask)
            halves.append(half)
            now.append(mask & ~shape.raised.replicate(BLOCK) if k == SIDE - 1 else mask)
        wide = self.config.pixels_per_word
        tiles = range(0, BLOCK, wide)
        return halves, Cat(Cat(mask[n : n + wide] for mask in now).any() for n in tiles)

    def _turn(self, m, rows, halves, turn_line, turn_column, lower, raised, column):
        """Select the tile from the rows; return its pixels by residue of line and column."""
        wide = self.config.pixels_per_word
        tile, by_line, turned = (
            [Signal(wide, name=f"{name}_{k}") for k in range(SIDE)]
            for name in ("tile", "by_line", "turned")
        )
        places = range(0, BLOCK, wide)
        for k in range(SIDE):
            row, other = (
                pick([pixels[place : place + wide] for place in places], column)
                for pixels in (rows[k], halves[SIDE - 1 - k])
            )
            if k == 0:  # a raised shape's row 3 has no half turn
                other = Mux(raised, 0, other)
            m.d.comb += tile[k].eq(Mux(lower, other, row))
        with m.Switch(turn_line):
            for turn in range(SIDE):
                with m.Case(turn):
                    m.d.comb += [by_line[i].eq(tile[(i - turn) % SIDE]) for i in range(SIDE)]
        with m.Switch(turn_column):
            for turn in range(wide):
                with m.Case(turn):
                    for i in range(SIDE):
                        columns = Cat(by_line[i][(j - turn) % wide] for j in range(wide))
                        m.d.comb += turned[i].eq(columns)
        return turned

    def _lines(self, m, element, tile, top, lower):
        """Set the slots of the tile's lines.

        Return the lines in the image, by residue, and the lines in the second group of four.
        """
        # Groups of four lines from the block's first to the image's last, at most 4. It is 0 if the
        # image ends above the block.
        groups = Signal(signed(len(top)))
        left = Signal(3, reset_less=True)
        m.d.comb += groups.eq((self.last_line >> 2) - (element.top >> 2) + 1)
        with m.If(self.i.ready):
            m.d.sync += left.eq(Mux(groups < 0, 0, Mux(groups > 4, 4, groups)))
        here = Signal(3)
        m.d.comb += here.eq(Mux(lower & left.any(), left - 1, left))
        inside, past_lines = Signal(SIDE), []
        for i in range(SIDE):
            # Past a multiple of 4: the line is in the group after the first row's.
            past = Signal(name=f"past_{i}")
            past_lines.append(past)
            low = self.last_line[:2] >= i
            m.d.comb += [
                past.eq(top[:2] > i),
                tile.group[i].eq(top[2 : self.config.slot_bits] + lower + past),
                inside[i].eq(
                    Mux(
                        here == 0,
                        0,
                        Mux(here == 1, ~past & low, Mux(here == 2, ~past | low, 1)),
                    )
                    & (~top[-1] | lower | past)
                ),
            ]
        return inside, past_lines

    def _plane(self, m, element, tile, plane, lower, past, column):
        """Set the depth at the block's corner, and what each line and column of the tile adds.

        The corner is the first column of the block's first word and the first line of its first
        group of four. What lanes add takes multipliers: a slope times the lane's column or line
        from there.
        """
        wide = self.config.pixels_per_word
        corner = Signal(sum_bits(self.config), name="corner", reset_less=True)
        with m.If(self.i.ready):
            given = element.plane
            m.d.sync += corner.eq((element.z << 1) - given.before - given.above)
        m.d.comb += tile.corner.eq(corner)
        for i in range(SIDE):
            group = Signal(2, name=f"group_{i}")
            m.d.comb += [
                group.eq(lower + past[i]),
                tile.down[i].eq(plane.down * Cat(Const(i, 2), group)),
            ]
        for j in range(wide):
            word = Signal(range(self.across + 1), name=f"word_{j}")
            m.d.comb += [
                word.eq(column + tile.next[j]),
                tile.across[j].eq(plane.across * Cat(Const(j, self.config.pixel_bits), word)),
            ]

    def _columns(self, m, element, tile, x, place, column):
        """Set the words of the tile's columns; return the columns in the image, by residue."""
        bits = self.config.pixel_bits
        last_word = self.last_column[bits:]
        # Whether the block's first word, and each word right of it, lies in the image.
        inside = Signal(self.across + 1, reset_less=True)
        words_left = Signal(signed(self.config.word_bits + 1))
        m.d.comb += words_left.eq(last_word - element.x[bits:])
        with m.If(self.i.ready):
            m.d.sync += inside.eq(Cat(words_left >= k for k in range(len(inside))))
        # One adder with a carry in: ``meets`` waits for it.
        m.d.comb += [
            tile.words[0].eq(x[bits:] + column),
            tile.words[1].eq((Cat(1, x[bits:]) + Cat(1, column))[1:]),
        ]
        columns = Signal(self.config.pixels_per_word)
        for j in range(len(columns)):
            past = Signal(name=f"next_{j}")
            m.d.comb += [
                past.eq(place > j),
                tile.next[j].eq(past),
                columns[j].eq(
                    pick([Mux(past, inside[n + 1], inside[n]) for n in range(self.across)], column)
                ),
            ]
        return columns
