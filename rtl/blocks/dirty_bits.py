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
    look : In(1)
        A stretch may be taken. No line of its residue is written in this cycle.
    take : In(1)
        Clear the stretch; only with ``look``. It comes later in the cycle.
    line : In(slot_bits)
        Slot of the stretch's line.
    stretch : In(stretch_bits)
        Its number in the line.
    wipe : In(1)
        Clear the stretch for all residues, with ``take``.
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
                "look": In(1),
                "take": In(1),
                "line": In(config.slot_bits),
                "stretch": In(stretch_bits(config)),
                "wipe": In(1),
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
        # Beside the block: a stretch that is taken or wiped, or a beat that is loaded.
        aside = Signal.like(self.stretch)
        aside_bits = Signal(1 << mark_bits(config))
        m.d.comb += [
            aside.eq(Mux(self.look, self.stretch, loaded[1 + low_bits :])),
            aside_bits.eq(Mux(self.look, -1, 1 << loaded[: 1 + low_bits])),
        ]
        served, seen, taken = (Signal(len(residues), name=n) for n in ("served", "seen", "taken"))
        for residue in residues:
            mine = self.wipe | (self.line[:own_bits] == residue)
            m.d.comb += [
                seen[residue].eq(self.look & mine),
                taken[residue].eq(self.take & mine),
                served[residue].eq(taken[residue] | self.load[residue]),
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
                touched = Signal(name=f"touched_{residue}_{parity}")
                address = Cat(
                    Mux(self.lone[residue] | seen[residue], aside, beat[1 + low_bits :]),
                    Mux(seen[residue], self.line[own_bits:], self.group[residue]),
                )
                m.d.comb += [
                    touched.eq(Mux(own, odd | (even & ~apart), even & apart)),
                    read.addr.eq(Cat(self.stretch, self.line[own_bits:])),
                    write.addr.eq(address),
                    write.data.eq((~seen[residue]).replicate(1 << low_bits)),
                    write.en.eq(
                        Mux(
                            served[residue],
                            Cat(aside_bits[parity::2]),
                            Mux(touched, bits, 0),
                        )
                    ),
                    Cat(kept[residue][parity::2]).eq(read.data),
                ]
        m.d.comb += self.taken.eq(choose(m, kept, self.line[:own_bits]))
        return m
