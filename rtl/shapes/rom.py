"""The shape ROM: turns compact words into plain code words."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Mux, Signal, Value
from amaranth.lib import data, memory, stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import BLOCK, COMPACT, ROWS, EngineConfig
from splatline.contract.fields import Field
from splatline.rtl.layouts import CodeWordLayout

from .contents import SMALLEST, TINY, shape_contents

__all__ = ["ROM_LATENCY", "ShapeRom"]

ROM_LATENCY = 3
"""Cycles that a word takes through the ROM."""


class ShapeRom(wiring.Component):
    """Turns each compact word into one or two code words, and passes plain ones, in order.

    ``docs/contract.md`` defines compact words. Two block RAMs are read one after the other. The
    first holds the number of a shape by size and levels, the second the shape. Levels are stored
    without their signs: an ellipse with both signs changed is the same, and with one it is
    mirrored. The logic after the memories mirrors it. A size over 8 gives the left and the right
    fraction of four lines. The lower four lines are the half turn of the upper ones. One word of
    the first memory holds the numbers of both fractions, so the second memory is read only for
    fractions with pixels.

    **Latency**: 3 cycles for every word, and one more for a right fraction behind its left one.
    **Throughput**: a word a cycle on ``o``. A compact word without a code word takes one cycle, or
    none if its follower waits: its size is not in the ROM, or its fractions have no pixels or lie
    right of every image.

    Parameters
    ----------
    config
        The sizes in the ROM, and all widths; see :class:`EngineConfig`.
    layout
        Layout of both streams, with at least ``mode``, ``scans`` and ``x``; a code word's if not
        given. Other fields pass unchanged.

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
        self.full = config.largest_shape > BLOCK
        self.layout = CodeWordLayout(config) if layout is None else layout
        super().__init__(
            {"i": In(stream.Signature(self.layout)), "o": Out(stream.Signature(self.layout))}
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        contents = shape_contents(self.config)
        m.submodules.numbers = numbers = _rom(contents.numbers, contents.word_bits)
        m.submodules.shapes = shapes = _rom(contents.shapes, contents.shape_bits)
        number, shape = numbers.read_port(), shapes.read_port()

        # A stage advances if the next one does, or if it is empty. The first one stalls while it
        # has a right fraction to give.
        more = Signal()
        gone = Signal()
        valid = Signal(ROM_LATENCY)
        moves = Signal(ROM_LATENCY)
        place = Signal(contents.number_bits, reset_less=True)
        m.d.comb += [
            moves[2].eq(~valid[2] | gone | self.o.ready),
            moves[1].eq(~valid[1] | moves[2]),
            moves[0].eq(~valid[0] | (moves[1] & ~more)),
            self.i.ready.eq(moves[0]),
            number.en.eq(moves[0]),
            shape.en.eq(moves[2]),
            shape.addr.eq(place),
            self.o.valid.eq(valid[2] & ~gone),
        ]
        for stage in range(ROM_LATENCY):
            with m.If(moves[stage]):
                m.d.sync += valid[stage].eq(valid[stage - 1] if stage else self.i.valid)
        asked = self._ask(m, moves[0], number.addr)
        if self.full:
            sides = number.data[: len(place)], number.data[len(place) :]
            left, right = (Mux(asked.second, sides[1 - n], sides[n]) for n in range(2))
            found = self._find(m, moves[1], asked, left, place)
            m.d.comb += more.eq(
                valid[0] & self._follow(m, moves[1] & valid[0], asked, found, left, right, place)
            )
        else:
            found = self._find(m, moves[1], asked, number.data, place)
        shown = self._keep(m, moves[2], found)
        self._show(m, shown, shape.data)
        m.d.comb += gone.eq(shown.unknown)
        return m

    def _ask(self, m: Module, moves, address) -> _Stage:
        """Read the number; return the registers of the word beside it."""
        config = self.config
        word = self.i.payload

        def take(field: Field):
            return word.scans.as_value()[field.lsb - config.scans.lsb :][: field.width]

        size = take(config.compact_size)
        level_x, level_y = take(config.compact_level_x), take(config.compact_level_y)
        part = take(config.compact_part)
        compact = Signal()
        large = Signal()
        mirror = Signal()  # left to right
        turn = Signal()  # top to bottom as well: the lower half of a size over 8
        # 4..8 as 0..4, and the smaller sizes as 5.
        low = Cat(Mux(size[2], size[0], ~size[3]), size[1] & size[2], ~size[2])
        row = Value.cast(low)
        m.d.comb += [
            compact.eq(~word.mode & (take(config.compact_mark) == COMPACT)),
            mirror.eq(level_x[5] ^ level_y[5] ^ turn),
        ]
        kept = _Stage(self.layout)
        with m.If(moves):
            m.d.sync += [
                kept.word.eq(word),
                kept.compact.eq(compact),
                kept.unknown.eq(compact & ~_held(size, self.full)),
                kept.mirrored.eq(compact & mirror),
                kept.turned.eq(turn),
                # 0: a number by itself; 1..3: the first to third of three.
                kept.kind.eq(Mux(size[2:].any(), 0, Mux(size[1], Cat(size[0], Const(1, 1)), 1))),
            ]
            with m.If(compact):
                m.d.sync += kept.word.scans.as_value().eq(0)
        if self.full:
            m.d.comb += [
                large.eq(compact & (size[4] | (size[3] & size[:3].any()))),
                turn.eq(large & part[1]),
            ]
            with m.If(moves):
                m.d.sync += [
                    kept.word.mode.eq(word.mode | large),
                    kept.second.eq(Mux(large, mirror, row[0])),
                    # There is a right fraction, and it is not right of every image.
                    kept.wide.eq(large & _held(size, self.full) & ~word.x[3:].all()),
                ]
            upper = Cat(part[0] ^ part[1], size[:3], Const(0, 1))
            row = Mux(large, upper, Cat(row[1:], Const(0, 2), Const(1, 1)))
        m.d.comb += address.eq(Cat(_fold(level_y), _fold(level_x), row))
        return kept

    def _find(self, m: Module, moves, found: _Stage, numbers, place) -> _Stage:
        """Select the shape's address. It is 0, where all bits are 0, for a word with own rows."""
        threes = [numbers[TINY * n :][:TINY] for n in range(SMALLEST - 1)]
        with m.If(moves):
            m.d.sync += place.eq(0)
            with m.If(found.compact):
                with m.Switch(found.kind):
                    m.d.sync += place.eq(numbers)
                    for which, three in enumerate(threes, start=1):
                        with m.Case(which):
                            m.d.sync += place.eq(three)
        return self._keep(m, moves, found)

    def _follow(self, m: Module, moves, asked: _Stage, found: _Stage, left, right, place):
        """Let the right fraction follow the left one; return whether it is still to come.

        If the left one has no pixels, the right one comes at once. If neither has, none comes.
        """
        follows = Signal()  # the left one has gone
        has_left = Signal()
        has_right = Signal()
        now_right = Signal()
        m.d.comb += [
            has_left.eq(left.any()),
            has_right.eq(asked.wide & right.any()),
            now_right.eq(has_right & (follows | ~has_left)),
        ]
        with m.If(moves):
            m.d.sync += [
                follows.eq(has_right & ~now_right),
                found.unknown.eq(asked.unknown | (asked.compact & ~has_left & ~has_right)),
            ]
            with m.If(now_right):
                m.d.sync += [place.eq(right), found.word.x[3:].eq(asked.word.x[3:] + 1)]
        return has_right & ~now_right

    def _keep(self, m: Module, moves, stage: _Stage) -> _Stage:
        """Return the next stage, with the fields that ``_show`` needs."""
        kept = _Stage(self.layout)
        with m.If(moves):
            m.d.sync += [
                kept.word.eq(stage.word),
                kept.unknown.eq(stage.unknown),
                kept.mirrored.eq(stage.mirrored),
                kept.turned.eq(stage.turned),
            ]
        return kept

    def _show(self, m: Module, shown: _Stage, shape):
        """Offer the word with its rows, mirrored or rotated by half a turn."""
        rows = [shape[6 * k :][:6] for k in range(ROWS)]
        empty = shape[6 * ROWS :]
        m.d.comb += self.o.payload.eq(shown.word)
        for k in range(ROWS):
            pixels, without = rows[k], empty[k]
            if self.full:
                pixels = Mux(shown.turned, rows[ROWS - 1 - k], pixels)
                without = Mux(shown.turned, empty[ROWS - 1 - k], without)
            # Column c becomes 7 - c, so the ends of a row are swapped. An empty row stays.
            mirrored = Signal(name=f"mirrored_{k}")
            m.d.comb += [
                mirrored.eq(shown.mirrored & ~without),
                self.o.payload.scans[k]
                .as_value()
                .eq(
                    shown.word.scans[k].as_value()
                    | Mux(mirrored, ~Cat(pixels[3:], pixels[:3]), pixels)
                ),
            ]


class _Stage:
    """The registers of a stage, for a word whose memory is being read.

    - ``word``: its fields. The scans of a compact word are 0.
    - ``compact``: it is a compact word.
    - ``unknown``: it gives no code word.
    - ``second`` and ``kind``: position of its number in a word of the first memory.
    - ``wide``: it may have a right fraction.
    - ``mirrored`` and ``turned``: mirror the shape, or take its half turn.
    """

    def __init__(self, layout: data.StructLayout):
        self.word = Signal(layout, reset_less=True)
        self.compact = Signal(reset_less=True)
        self.unknown = Signal(reset_less=True)
        self.mirrored = Signal(reset_less=True)
        self.turned = Signal(reset_less=True)
        self.second = Signal(reset_less=True)
        self.kind = Signal(2, reset_less=True)
        self.wide = Signal(reset_less=True)


def _rom(contents: list[int], bits: int) -> memory.Memory:
    """Return a read-only memory in block RAM."""
    return memory.Memory(
        shape=bits, depth=len(contents), init=contents, attrs={"ram_style": "block"}
    )


def _fold(level):
    """Return a level without its sign: 32 and 31 are 0, 63 and 0 are 31."""
    return Mux(level[5], level[:5], ~level[:5])


def _held(size, full: bool):
    """Return whether a size is in the ROM: at most 16, or at most 8."""
    return ~size[4] | ~size[:4].any() if full else ~size[4] & (~size[3] | ~size[:3].any())
