"""Cutting elements into tiles of 4 x 4 pixels, each of which the window's lanes take in a cycle."""

from amaranth.hdl import Cat, Module, Mux, Signal, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from .format import EngineConfig
from .layouts import GeometryLayout, TileLayout

__all__ = ["Tiler"]

SIDE = 4
"""Lines and columns of a tile."""


class Tiler(wiring.Component):
    """Gives an element's tiles, one a cycle, dealt to the lanes of the window.

    An element's block of 8 x 8 pixels (8 x 4 for a fraction) has four (two) tiles. They lie on the
    element, not on the image, so whatever is up to four pixels wide and high is one tile at any
    place. Tiles without a pixel are passed over in no time. A tile's pixels lie in sixteen
    different lanes, one for each residue of line and column: its rows and columns are turned to
    theirs, and clipped to the image (columns by whole words of four pixels).

    An element waits here until its lines are in the window. Meanwhile its ``top`` is known already,
    so that the lines above it may leave.

    **Latency**: 2 cycles. **Throughput**: one tile a cycle.

    Members
    -------
    i : In(stream of GeometryLayout)
        Elements, and ``end`` tokens.
    o : Out(stream of TileLayout)
        Tiles; for an ``end`` token one without pixels, to be taken when its frame is out.
    moves : Out(1)
        What ``o`` has in the next cycle is of the element at hand, or nothing: its colour moves on.
    oldest : In(line_bits + 1)
        First line in the window.
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
                "o": Out(stream.Signature(TileLayout(config))),
                "moves": Out(1),
                "oldest": In(config.line_bits + 1),
                "last_column": In(config.x_bits),
                "last_line": In(config.line_bits),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        element = self.i.payload
        tile = Signal(TileLayout(self.config))
        there = Signal()  # an element, or the end
        left = Signal(4)  # tiles to do: upper left, upper right, lower left, lower right
        first = Signal(4)  # the one to do now
        rest = Signal(4)
        near = Signal(2)  # the lines of its upper, of its lower tiles are in the window
        may = Signal()  # those of the tile to do now
        step = Signal()
        valid = Signal()
        held = {
            name: Signal.like(getattr(element, name), name=name, reset_less=True)
            for name in ("x", "z", "top", "end")
        }
        m.d.comb += [
            first.eq(left & (~left + 1)),
            rest.eq(left & ~first),
            step.eq(~valid | self.o.ready),
            self.moves.eq(step),
            self.i.ready.eq(~there | (step & may & ~rest.any())),
            *(tile[name].eq(held[name]) for name in ("z", "end")),
        ]
        with m.If(self.i.ready):
            m.d.sync += [held[name].eq(getattr(element, name)) for name in held]
            m.d.sync += there.eq(self.i.valid)
        with m.Elif(step & may):
            m.d.sync += left.eq(rest)

        given = Signal(TileLayout(self.config), reset_less=True)
        top = Signal(element.top.shape(), name="given_top", init=-SIDE)
        m.d.comb += [self.o.valid.eq(valid), self.o.payload.eq(given), self.o.payload.top.eq(top)]
        with m.If(step):
            m.d.sync += [
                valid.eq(there & may & (left.any() | held["end"])),
                given.eq(tile),
                given.meets.eq(self._meets(m, tile, given) & valid & self.o.ready),
            ]
            with m.If(valid & given.end):
                m.d.sync += top.eq(-SIDE)  # of the next frame
            with m.Elif(there):
                m.d.sync += top.eq(held["top"])

        lower, right = Signal(), Signal()
        waiting = Signal()
        behind = Signal.like(held["top"])
        m.d.comb += [
            lower.eq(~left[:2].any()),
            right.eq(first[1] | first[3]),
            may.eq(held["end"] | Mux(lower, near[1], near[0])),
            # Known a cycle ahead, because all before it waits for it. While the element at hand
            # waits, the one behind it is not looked at, and comes as one whose lines are not there.
            waiting.eq(there & ~near.all()),
            behind.eq(self.oldest - Mux(waiting, held["top"], element.top)),
        ]
        with m.If(waiting & self.i.ready):
            m.d.sync += near.eq(0)
        with m.Elif(waiting | self.i.ready):
            # A line takes the place of one that left some cycles ago, not of the four before it:
            # they may still be cleared. So less than 12 lines ahead, or 8 for a lower tile.
            high = behind[4:].all()
            m.d.sync += near.eq(
                Cat(
                    ~behind[-1] | (high & (behind[:4] > 4)), ~behind[-1] | (high & (behind[:4] > 8))
                )
            )
        pixels = self._turn(m, self._rows(m, element, left), held, lower, right)
        lines = self._lines(m, element, tile, held["top"], lower)
        columns = self._columns(m, element, tile, held["x"], right)
        for i in range(SIDE):
            for j in range(SIDE):
                m.d.comb += tile.mask[i][j].eq(pixels[i][j] & lines[i] & columns[j])
        return m

    def _rows(self, m, element, left):
        """Return the upper rows as masks, and note which tiles have a pixel."""
        rows = [Signal(2 * SIDE, name=f"row_{k}", reset_less=True) for k in range(SIDE)]
        filled = Cat(scan.first <= scan.last for scan in element.scans)
        halves = Signal(2)  # the upper rows have a pixel on the left, on the right
        m.d.comb += halves.eq(
            Cat(
                (filled & ~Cat(scan.first[2] for scan in element.scans)).any(),
                (filled & Cat(scan.last[2] for scan in element.scans)).any(),
            )
        )
        with m.If(self.i.ready):
            for scan, row in zip(element.scans, rows, strict=True):
                m.d.sync += row.eq(
                    Cat((scan.first <= c) & (scan.last >= c) for c in range(2 * SIDE))
                )
            # The lower half is the upper one turned: its left is the upper one's right.
            turned = Cat(halves[1], halves[0]) & ~element.mode.replicate(2)
            m.d.sync += left.eq(Cat(halves, turned) & ~element.end.replicate(4))
        return rows

    def _turn(self, m, rows, held, lower, right):
        """Take the tile out of the rows; return its pixels by residue of line and column."""
        turn_line, turn_column = held["top"][:2], held["x"][:2]
        tile, by_line, turned = (
            [Signal(SIDE, name=f"{name}_{k}") for k in range(SIDE)]
            for name in ("tile", "by_line", "turned")
        )
        for k in range(SIDE):
            row, other = rows[k], rows[SIDE - 1 - k][::-1]
            m.d.comb += tile[k].eq(
                Mux(
                    lower,
                    Mux(right, other[SIDE:], other[:SIDE]),
                    Mux(right, row[SIDE:], row[:SIDE]),
                )
            )
        with m.Switch(turn_line):
            for turn in range(SIDE):
                with m.Case(turn):
                    m.d.comb += [by_line[i].eq(tile[(i - turn) % SIDE]) for i in range(SIDE)]
        with m.Switch(turn_column):
            for turn in range(SIDE):
                with m.Case(turn):
                    for i in range(SIDE):
                        columns = Cat(by_line[i][(j - turn) % SIDE] for j in range(SIDE))
                        m.d.comb += turned[i].eq(columns)
        return turned

    def _lines(self, m, element, tile, top, lower):
        """Place the tile's lines; return which of them lie in the image, by residue."""
        # Groups of four lines from the block's first to the image's last, 0..4: 0 if it lies above,
        # 4 stands for more.
        groups = Signal(signed(len(top)))
        left = Signal(3, reset_less=True)
        m.d.comb += groups.eq((self.last_line >> 2) - (element.top >> 2) + 1)
        with m.If(self.i.ready):
            m.d.sync += left.eq(Mux(groups < 0, 0, Mux(groups > 4, 4, groups)))
        here = Signal(3)
        m.d.comb += here.eq(Mux(lower & left.any(), left - 1, left))
        inside = Signal(SIDE)
        for i in range(SIDE):
            # Past a multiple of 4: in the group after the first row's.
            past = Signal(name=f"past_{i}")
            low = self.last_line[:2] >= i
            m.d.comb += [
                past.eq(top[:2] > i),
                tile.group[i].eq(top[2:4] + lower + past),
                inside[i].eq(
                    Mux(
                        here == 0,
                        0,
                        Mux(here == 1, ~past & low, Mux(here == 2, ~past | low, 1)),
                    )
                    & (~top[-1] | lower | past)
                ),
            ]
        return inside

    def _columns(self, m, element, tile, x, right):
        """Place the tile's columns; return which of them lie in the image, by residue."""
        last_word = self.last_column[2:]
        # Of the block's first word and the two on its right, which lie in the image.
        inside = Signal(3, reset_less=True)
        words_left = Signal(signed(self.config.word_bits + 1))
        m.d.comb += words_left.eq(last_word - element.x[2:])
        with m.If(self.i.ready):
            m.d.sync += inside.eq(Cat(words_left >= k for k in range(3)))
        m.d.comb += [
            tile.words[0].eq(x[2:] + right),
            tile.words[1].eq(x[2:] + right + 1),
        ]
        columns = Signal(SIDE)
        for j in range(SIDE):
            past = Signal(name=f"next_{j}")
            m.d.comb += [
                past.eq(x[:2] > j),
                tile.next[j].eq(past),
                columns[j].eq(Mux(right, Mux(past, inside[2], inside[1]),
                                  Mux(past, inside[1], inside[0]))),
            ]  # fmt: skip
        return columns

    def _meets(self, m, tile, before):
        """Return whether two tiles overlap: whether they have a pixel of the image in common."""
        same, after, ahead = Signal(), Signal(), Signal()
        m.d.comb += [
            same.eq(tile.words[0] == before.words[0]),
            after.eq(tile.words[1] == before.words[0]),
            ahead.eq(tile.words[0] == before.words[1]),
        ]
        # Which of their pixels they draw would be known too late, and says little more.
        lines, columns = Signal(SIDE), Signal(SIDE)
        for i in range(SIDE):
            new, old = tile.next[i], before.next[i]
            m.d.comb += [
                lines[i].eq(tile.group[i] == before.group[i]),
                columns[i].eq(Mux(new == old, same, Mux(new, after, ahead))),
            ]
        return lines.any() & columns.any()
