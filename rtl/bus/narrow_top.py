"""The engine behind few pins: each wide stream in pieces, the lowest bits first."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.rtl.engine import Engine
from splatline.rtl.layouts import CodeWordLayout, RasterLayout, TableWriteLayout
from splatline.rtl.lib.mux import pick

__all__ = ["IO_PINS", "Gatherer", "PieceLayout", "PinTop", "Splitter"]

IO_PINS = 172
"""Pins of the XC2V250-FG256 that a design may use."""

WORD_PIECE = 16
"""Bits of a code word or table write that enter in a clock."""

BEAT_PIECE = 18
"""Bits of a raster's beat that enter or leave in a clock: five times for the ``paper`` preset."""


class PieceLayout(data.StructLayout):
    """A piece of a code word (``table`` 0) or of a table write (1)."""

    def __init__(self):
        super().__init__({"data": WORD_PIECE, "table": 1})


class Gatherer(wiring.Component):
    """Puts pieces together, the first lowest.

    Neither direction has logic between its two sides: ``i.ready`` and ``o.valid`` hang on the count
    of pieces alone. So a word costs a cycle more than it has pieces.

    **Latency**: 1 cycle from the last piece. **Throughput**: a word in ``pieces + 1`` cycles.

    Parameters
    ----------
    bits
        Bits of a word; those of its last piece above them are ignored.
    piece
        Bits of a piece.

    Members
    -------
    i : In(stream of piece bits)
        The pieces.
    o : Out(stream of bits bits)
        The words.
    """

    def __init__(self, bits: int, piece: int):
        self.pieces = -(-bits // piece)
        super().__init__({"i": In(stream.Signature(piece)), "o": Out(stream.Signature(bits))})

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        piece = len(self.i.payload)
        held = Signal(self.pieces * piece, reset_less=True)
        count = Signal(range(self.pieces))
        full = Signal()
        m.d.comb += [
            self.i.ready.eq(~full),
            self.o.valid.eq(full),
            self.o.payload.eq(held),
        ]
        with m.If(self.i.valid & ~full):
            last = count == self.pieces - 1
            m.d.sync += [
                held.eq(Cat(held[piece:], self.i.payload)),
                count.eq(Mux(last, 0, count + 1)),
                full.eq(last),
            ]
        with m.If(full & self.o.ready):
            m.d.sync += full.eq(0)
        return m


class Splitter(wiring.Component):
    """Takes words apart, the lowest piece first.

    A word stays where it is while its pieces leave, and is taken in a cycle of its own: so nothing
    of what lies before it waits for ``o.ready`` in the same cycle. The pieces come from a register,
    which the vendor's tools can put into the I/O blocks.

    **Latency**: 1 cycle to the first piece. **Throughput**: a word in ``pieces + 1`` cycles.

    Parameters
    ----------
    bits
        Bits of a word; the last piece is filled up with zeros.
    piece
        Bits of a piece.

    Members
    -------
    i : In(stream of bits bits)
        The words.
    o : Out(stream of piece bits)
        The pieces.
    """

    def __init__(self, bits: int, piece: int):
        self.pieces = -(-bits // piece)
        super().__init__({"i": In(stream.Signature(bits)), "o": Out(stream.Signature(piece))})

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        piece = len(self.o.payload)
        count = Signal(range(self.pieces))
        over = Signal()
        room = Signal()
        valid = Signal()
        left = Signal(piece, reset_less=True)
        pieces = [self.i.payload[n * piece :][:piece] for n in range(self.pieces)]
        m.d.comb += [
            room.eq(~valid | self.o.ready),
            self.i.ready.eq(over),
            self.o.valid.eq(valid),
            self.o.payload.eq(left),
        ]
        with m.If(room):
            m.d.sync += [valid.eq(self.i.valid & ~over), left.eq(pick(pieces, count))]
        with m.If(over):
            m.d.sync += over.eq(0)
        with m.Elif(room & self.i.valid):
            last = count == self.pieces - 1
            m.d.sync += [count.eq(Mux(last, 0, count + 1)), over.eq(last)]
        return m


class PinTop(wiring.Component):
    """An engine whose streams fit the pins of a package: 61 of the XC2V250-FG256's 172.

    Every word, beat and table write travels as pieces, the lowest bits first. The three streams are
    independent, as the engine's are: code words may wait for the initial raster and it for them, so
    that neither may stand behind the other on the same pins. Table writes share the code words'
    pins, and take effect in the order in which they come. They are sent between frames: within one
    they would wait for its end, which could no longer pass.

    Each side ends in registers, so that no path leads through the chip from pin to pin. They are
    most of what the top takes beside the engine: for ``paper`` 183 flip-flops, 64 of them for a
    word, 90 for an initial beat and 19 on the way out, and 60 to 90 LUTs, three for each pin of the
    raster.

    **Latency**: 1 cycle more than the engine from a word's last piece, 1 to a beat's first.
    **Throughput**: at 100 MHz and with the ``paper`` preset, a code word in 5 cycles (20 million a
    second) and a beat of 4 pixels in 6 cycles (67 million pixels a second). The engine is faster:
    the pins, not it, set the pace. With ``rgb24``, whose table writes have five pieces, a code word
    takes 6 cycles, as it is filled up to five. A plane word has six pieces and takes 7 cycles, and
    so does a table write of its engine.

    Parameters
    ----------
    config
        The engine's configuration.

    Members
    -------
    words : In(stream of PieceLayout)
        Code words and table writes, in pieces of 16 bits; both have as many pieces as the wider of
        them needs. Bits of a table write above its address are ignored. ``table`` is the same for
        all pieces of a word.
    initial : In(stream of 18 bits)
        What the frame starts from: beats of a raster, five pieces each.
    raster : Out(stream of 18 bits)
        The picture's beats, and the end beat.
    """

    @property
    def latency(self) -> int:
        """Cycles from a code word's last piece to the one that writes its first pixels."""
        return self.engine.latency + 1

    def __init__(self, config: EngineConfig = PAPER):
        self.config = config
        self.engine = Engine(config)
        super().__init__(
            {
                "words": In(stream.Signature(PieceLayout())),
                "initial": In(stream.Signature(BEAT_PIECE)),
                "raster": Out(stream.Signature(BEAT_PIECE)),
            }
        )

    @property
    def clear_cycles(self) -> int:
        """Cycles after reset in which the engine clears its memory; code words wait."""
        return self.engine.clear_cycles

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        codeword = CodeWordLayout(self.config)
        table_write = TableWriteLayout(self.config)
        beat = RasterLayout(self.config)
        m.submodules.machine = engine = self.engine
        m.submodules.words = words = Gatherer(max(codeword.size, table_write.size), WORD_PIECE)
        m.submodules.initial = initial = Gatherer(beat.size, BEAT_PIECE)
        m.submodules.raster = raster = Splitter(beat.size, BEAT_PIECE)

        table = Signal()
        m.d.comb += [
            words.i.payload.eq(self.words.payload.data),
            words.i.valid.eq(self.words.valid),
            self.words.ready.eq(words.i.ready),
            engine.codewords.payload.eq(words.o.payload),
            engine.codewords.valid.eq(words.o.valid & ~table),
            engine.tables.payload.eq(words.o.payload),
            engine.tables.valid.eq(words.o.valid & table),
            words.o.ready.eq(Mux(table, engine.tables.ready, engine.codewords.ready)),
        ]
        with m.If(words.i.valid & words.i.ready):
            m.d.sync += table.eq(self.words.payload.table)

        connect(m, flipped(self.initial), initial.i)
        connect(m, raster.o, flipped(self.raster))
        m.d.comb += [
            engine.initial.payload.eq(initial.o.payload),
            engine.initial.valid.eq(initial.o.valid),
            initial.o.ready.eq(engine.initial.ready),
            raster.i.payload.eq(engine.raster.payload),
            raster.i.valid.eq(engine.raster.valid),
            engine.raster.ready.eq(raster.i.ready),
        ]
        return m
