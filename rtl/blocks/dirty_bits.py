"""The dirty bits of the blocks engine: one for each beat of a line."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.lib.mux import choose

__all__ = ["BlockDirtyBits", "mark_bits", "residue_bits", "stretch_bits"]


def residue_bits(config: EngineConfig) -> int:
    """Return the bits of a line's residue, which names its row of lanes."""
    return config.slot_bits - config.group_bits


def mark_bits(config: EngineConfig) -> int:
    """Return the bits of a beat's number within its stretch of up to four beats.

    With two lines a residue and 32 beats a line, a memory has sixteen rows, as many as a LUT of a
    Virtex-II.
    """
    return min(2, config.word_bits - 1)


def stretch_bits(config: EngineConfig) -> int:
    """Return the bits of a stretch's number in its line."""
    return config.word_bits - 1 - mark_bits(config)


class BlockDirtyBits(wiring.Component):
    """Marks beats as dirty, and gives and clears the dirty bits of a stretch.

    As :class:`TileDirtyBits`, with four differences. There are eight residues of lines. A dirty bit
    is of a beat, two words. Each bit of a row is written by itself, so no row is read to be
    written. Each residue has a write address of its own, so the dirty bits of one may be taken
    while a block is drawn into others.

    The read address depends on no late signal, because the path from it to ``taken`` is long.

    **Latency**: 1 cycle from a touch to the dirty bit, 0 from ``take`` to ``taken``.
    **Throughput**: one block a cycle, and a stretch or a load in a line of another residue.

    Members
    -------
    drawing : In(1)
        The words of ``touch`` are written in this cycle.
    touch : In(8 x 2)
        By residue of the line: a block is drawn into an odd word, and into an even one. If the
        first word is even, both are of one beat.
    group : In(8 x group_bits)
        Slots of those lines, or of the line that is loaded, without the three lowest bits.
    words : In(2 x word_bits)
        The block's two words. The second is one more than the first.
    load : In(8)
        By residue of the line: the beat of ``load_word`` is written, and ``words`` are not.
    load_word : In(word_bits)
        A word of a third beat, of one line.
    lone : In(8)
        By residue of the line: ``words`` are not written. It comes earlier in the cycle than
        ``drawing``.
    look : In(8)
        By residue of the line: a stretch may be taken. No line of the residue is written in this
        cycle. High for one residue at most, but with ``wipe`` for all.
    take : In(1)
        Clear the stretch, if ``look`` is high for its residue.
    line : In(slot_bits)
        Slot of the stretch's line.
    stretch : In(stretch_bits)
        Its number in the line.
    taken : Out(2 ** mark_bits)
        Its dirty bits, from left to right.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        residues = config.tile_lines
        super().__init__(
            {
                "drawing": In(1),
                "touch": In(data.ArrayLayout(2, residues)),
                "group": In(data.ArrayLayout(config.group_bits, residues)),
                "words": In(data.ArrayLayout(config.word_bits, 2)),
                "load": In(residues),
                "load_word": In(config.word_bits),
                "lone": In(residues),
                "look": In(residues),
                "take": In(1),
                "line": In(config.slot_bits),
                "stretch": In(stretch_bits(config)),
                "taken": Out(1 << mark_bits(config)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        residues = range(config.tile_lines)
        own_bits = residue_bits(config)
        low_bits = mark_bits(config) - 1  # of a beat's number among the even, or the odd, ones
        beats = [word[1:] for word in self.words]
        # An odd first word has its neighbour in the next beat.
        apart = self.words[0][0]
        loaded = self.load_word[1:]
        loaded_bit = Signal(1 << mark_bits(config))
        m.d.comb += loaded_bit.eq(1 << loaded[: 1 + low_bits])
        # Beside the block: a stretch that is taken or wiped, or a beat that is loaded.
        taken, served = (Signal(len(residues), name=name) for name in ("taken", "served"))
        m.d.comb += [
            taken.eq(self.look & self.take.replicate(len(residues))),
            served.eq(taken | self.load),
        ]

        kept = [Signal(2 << low_bits, name=f"kept_{q}") for q in residues]
        for parity in range(2):
            # The beat of this parity: the first word's, or the next one.
            own = Signal(name=f"own_{parity}")
            beat = Signal.like(beats[0], name=f"beat_{parity}")
            bits = Signal(1 << low_bits, name=f"bits_{parity}")
            m.d.comb += [
                own.eq(beats[0][0] == parity),
                beat.eq(Mux(own, beats[0], beats[1])),
                bits.eq(self.drawing << beat[1 : 1 + low_bits]),
            ]
            for residue in residues:
                ram = memory.Memory(
                    shape=1 << low_bits,
                    depth=1 << stretch_bits(config) + config.group_bits,
                    init=[],
                    attrs={"ram_style": "distributed"},
                )
                m.submodules[f"marks_{residue}_{parity}"] = ram
                read, write = ram.read_port(domain="comb"), ram.write_port(granularity=1)
                odd, even = self.touch[residue][0], self.touch[residue][1]
                look, lone = self.look[residue], self.lone[residue]
                touched = Signal(name=f"touched_{residue}_{parity}")
                written = Mux(lone, loaded[1 + low_bits :], beat[1 + low_bits :])
                m.d.comb += [
                    touched.eq(Mux(own, odd | (even & ~apart), even & apart)),
                    read.addr.eq(Cat(self.stretch, self.line[own_bits:])),
                    write.addr.eq(
                        Cat(
                            Mux(look, self.stretch, written),
                            Mux(look, self.line[own_bits:], self.group[residue]),
                        )
                    ),
                    write.data.eq((~look).replicate(1 << low_bits)),
                    write.en.eq(
                        Mux(
                            served[residue],
                            Mux(look, -1, loaded_bit[parity::2]),
                            Mux(touched, bits, 0),
                        )
                    ),
                    Cat(kept[residue][parity::2]).eq(read.data),
                ]
        m.d.comb += self.taken.eq(choose(m, kept, self.line[:own_bits]))
        return m
