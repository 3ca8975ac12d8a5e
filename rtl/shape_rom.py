"""The shape ROM: compact words, which name a size and a normal, become plain code words."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import data, memory, stream, wiring
from amaranth.lib.wiring import In, Out

from .format import BLOCK, ROWS, EngineConfig, Field
from .layouts import CodeWordLayout
from .shape_contents import SMALLEST, TINY, shape_contents
from .shape_table import FOLDED

__all__ = ["ROM_LATENCY", "ShapeRom"]

ROM_LATENCY = 3
"""Cycles that a word takes through the ROM."""


class ShapeRom(wiring.Component):
    """Turns compact words into one or two code words and lets all others pass, in order.

    What a compact word means is in ``docs/contract.md``. Two block RAMs are read one after the
    other: the first has the number of a shape by size and levels, the second the shape. Levels are
    folded by their sign: an ellipse with both turned round is the same, with one it is mirrored,
    which the logic after the memories does. A size over 8 gives the left and the right fraction of
    four lines, of which the lower half is the upper one turned.

    **Latency**: 3 cycles, of every word. **Throughput**: one word a cycle; a compact word of a size
    over 8 takes two. What gives nothing leaves no gap if its follower waits: a size that the ROM
    does not hold, a fraction without pixels, or one right of every image.

    Parameters
    ----------
    config
        Which ROM, and the widths; see :class:`EngineConfig`.
    layout
        What travels: a layout with at least ``mode``, ``scans`` and ``x``; a code word if not
        given. All else is handed on.

    Members
    -------
    i : In(stream of layout)
        Plain and compact words.
    o : Out(stream of layout)
        Plain words.
    """

    @property
    def latency(self) -> int:
        """Cycles from the one that takes a word to the one that offers it."""
        return ROM_LATENCY

    def __init__(self, config: EngineConfig, layout: data.StructLayout | None = None):
        self.config = config
        self.layout = CodeWordLayout(config) if layout is None else layout
        super().__init__(
            {"i": In(stream.Signature(self.layout)), "o": Out(stream.Signature(self.layout))}
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        full = config.largest_shape > BLOCK
        contents = shape_contents(config)
        m.submodules.numbers = numbers = _rom(contents.numbers, contents.number_bits)
        m.submodules.shapes = shapes = _rom(contents.shapes, contents.shape_bits)
        number, shape = numbers.read_port(), shapes.read_port()

        scans = self.i.payload.scans.as_value()

        def take(field: Field):
            return scans[field.lsb - config.scans.lsb :][: field.width]

        # A stage moves on if the one after it does, or if it holds nothing.
        valid = Signal(ROM_LATENCY)
        moves = Signal(ROM_LATENCY)
        m.d.comb += [
            moves[2].eq(~valid[2] | self.o.ready),
            moves[1].eq(~valid[1] | moves[2]),
            moves[0].eq(~valid[0] | moves[1]),
        ]

        # What is asked for.
        size = take(config.compact_size)
        level_x, level_y = take(config.compact_level_x), take(config.compact_level_y)
        part = take(config.compact_part)
        compact = Signal()
        large = Signal()
        mirror = Signal()  # left to right
        turn = Signal()  # and top to bottom: the lower half of a size over 8
        right = Signal()  # the second fraction of four lines
        row = Signal(range(len(contents.numbers) // FOLDED**2))
        low = Cat(
            Mux(size[2], size[0], ~size[3]), size[1] & size[2], ~size[2]
        )  # 4..8 as 0..4, and 5
        m.d.comb += [
            compact.eq(
                ~self.i.payload.mode & take(config.compact_set) & ~take(config.compact_clear)
            ),
            mirror.eq(level_x[5] ^ level_y[5] ^ turn),
            row.eq(low),
        ]
        if full:
            m.d.comb += [
                large.eq(compact & (size[4] | (size[3] & size[:3].any()))),
                turn.eq(large & part[1]),
            ]
            with m.If(large):
                m.d.comb += row.eq(Cat(right ^ mirror, part[0] ^ part[1], size[:3]))
            with m.Else():
                m.d.comb += row.eq(Cat(low, Const(0, 2), Const(1, 1)))
        m.d.comb += [
            number.en.eq(moves[0]),
            number.addr.eq(Cat(_fold(level_y), _fold(level_x), row)),
            self.i.ready.eq(moves[0] & (~large | right)),
        ]

        # The number comes; the rest waits.
        beyond = Signal()
        word = Signal(self.layout, reset_less=True)
        asked = Signal(reset_less=True)
        dropped = Signal(reset_less=True)
        mirrored = Signal(reset_less=True)
        turned = Signal(reset_less=True)
        kind = Signal(
            2, reset_less=True
        )  # 0: a number by itself; 1..3: the first to third of three
        with m.If(moves[0]):
            m.d.sync += [
                valid[0].eq(self.i.valid),
                word.eq(self.i.payload),
                asked.eq(compact),
                dropped.eq(compact & (~_held(size, full) | beyond)),
                mirrored.eq(compact & mirror),
                turned.eq(turn),
                kind.eq(Mux(size[2:].any(), 0, Mux(size[1], Cat(size[0], Const(1, 1)), 1))),
            ]
            with m.If(compact):
                m.d.sync += word.scans.as_value().eq(0)
            if full:
                eighths = self.i.payload.x[3:]
                further = Signal(len(eighths) + 1)
                m.d.comb += [
                    further.eq(eighths + right),
                    beyond.eq(further[-1]),
                ]
                m.d.sync += [word.mode.eq(self.i.payload.mode | large), word.x[3:].eq(further)]
                with m.If(self.i.valid):
                    m.d.sync += right.eq(large & ~right)

        # The shape comes; its place is 0, which is empty of bits, for a word that has its own.
        threes = [number.data[TINY * n :][:TINY] for n in range(SMALLEST - 1)]
        place = Signal(contents.number_bits)
        with m.If(asked):
            with m.Switch(kind):
                m.d.comb += place.eq(number.data)
                for which, three in enumerate(threes, start=1):
                    with m.Case(which):
                        m.d.comb += place.eq(three)
        m.d.comb += [shape.en.eq(moves[1]), shape.addr.eq(place)]
        late = {
            name: Signal(1, reset_less=True, name=f"late_{name}")
            for name in ("dropped", "mirrored", "turned")
        }
        late_word = Signal(self.layout, reset_less=True)
        with m.If(moves[1]):
            m.d.sync += [
                valid[1].eq(valid[0]),
                late_word.eq(word),
                late["dropped"].eq(dropped),
                late["mirrored"].eq(mirrored),
                late["turned"].eq(turned),
            ]

        # It is mirrored and turned.
        result = Signal(self.layout, reset_less=True)
        rows = [shape.data[6 * k :][:6] for k in range(ROWS)]
        empty = shape.data[6 * ROWS :]
        nothing = empty.all() if full else Const(0)
        with m.If(moves[2]):
            m.d.sync += [
                valid[2].eq(valid[1] & ~late["dropped"] & ~nothing),
                result.eq(late_word),
            ]
            for k in range(ROWS):
                pixels, without = rows[k], empty[k]
                if full:
                    pixels = Mux(late["turned"], rows[ROWS - 1 - k], pixels)
                    without = Mux(late["turned"], empty[ROWS - 1 - k], without)
                # Column c goes to 7 - c, and so do the ends change places.
                pixels = Mux(late["mirrored"], ~Cat(pixels[3:], pixels[:3]), pixels)
                own = late_word.scans[k].as_value()
                with m.If(without):
                    m.d.sync += result.scans[k].as_value().eq(1)
                with m.Else():
                    m.d.sync += result.scans[k].as_value().eq(own | pixels)
        m.d.comb += [self.o.valid.eq(valid[2]), self.o.payload.eq(result)]
        return m


def _rom(contents: list[int], bits: int) -> memory.Memory:
    """Return a memory that is never written, in block RAM."""
    return memory.Memory(
        shape=bits, depth=len(contents), init=contents, attrs={"ram_style": "block"}
    )


def _fold(level):
    """Return a level without its sign: 32 and 31 are 0, 63 and 0 are 31."""
    return Mux(level[5], level[:5], ~level[:5])


def _held(size, full: bool):
    """Return whether the ROM has a size: 16 or 8 and less."""
    return ~size[4] | ~size[:4].any() if full else ~size[4] & (~size[3] | ~size[:3].any())
