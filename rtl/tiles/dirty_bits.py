"""The dirty bits of the tiles engine: one for each pair of neighbouring words of a line."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig

__all__ = ["TileDirtyBits", "mark_bits", "stretches"]

RESIDUES = 4
"""Lines that are marked in a cycle: one of each residue modulo 4."""


def mark_bits(config: EngineConfig) -> int:
    """Return the bits of a pair's number within its stretch of up to 32 words."""
    return min(4, config.word_bits - 1)


def stretches(config: EngineConfig) -> int:
    """Return the stretches of a line."""
    return 1 << (config.word_bits - 1 - mark_bits(config))


class TileDirtyBits(wiring.Component):
    """Marks pairs of words as dirty, and gives and clears the dirty bits of a stretch.

    A row of a memory is a stretch of a line. Each residue of a line modulo 4 has two memories, for
    even and for odd pairs. A tile can therefore mark all its words in one cycle: those of its first
    word's pair, and those of the next pair. The memories have up to 16 rows of up to 8 bits, which
    suits the distributed RAM of a Virtex-II.

    **Latency**: 1 cycle from a touch to the dirty bit, 0 from ``take`` to ``taken``.
    **Throughput**: a tile or a stretch a cycle.

    Members
    -------
    touch : In(4 x 2)
        By residue of the line: the first and the second of ``words`` are written.
    group : In(4 x group_bits)
        Slots of those lines, without the two lowest bits.
    words : In(2 x word_bits)
        Two neighbouring words. The second is one more than the first.
    load : In(4)
        By residue of the line: ``load_word`` is written.
    load_word : In(word_bits)
        A third word, of one line.
    lone : In(4)
        By residue of the line: neither of ``words`` is written, but ``load_word`` may be. It comes
        earlier in the cycle than ``load``, because ``taken`` waits for the address.
    take : In(1)
        Give and clear a stretch. No line is touched in that cycle, or with ``flush_words`` 2 none
        of the residue of ``line``.
    line : In(slot_bits)
        Slot of the stretch's line.
    stretch : In
        Its number in the line.
    wipe : In(1)
        Clear the stretch for all four residues, with ``take``.
    taken : Out(2 ** mark_bits)
        Its dirty bits, from left to right.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "touch": In(data.ArrayLayout(2, RESIDUES)),
                "group": In(data.ArrayLayout(config.group_bits, RESIDUES)),
                "words": In(data.ArrayLayout(config.word_bits, 2)),
                "load": In(RESIDUES),
                "load_word": In(config.word_bits),
                "lone": In(RESIDUES),
                "take": In(1),
                "line": In(config.slot_bits),
                "stretch": In(range(stretches(config))),
                "wipe": In(1),
                "taken": Out(1 << mark_bits(config)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        low_bits = mark_bits(config) - 1  # of a pair's number among the even, or the odd, ones
        pairs = [word[1:] for word in self.words]
        # An odd first word has its neighbour in the next pair.
        apart = self.words[0][0]
        other = self.load_word[1:]
        other_bit = Signal(1 << low_bits)
        m.d.comb += other_bit.eq(1 << other[1 : 1 + low_bits])

        # An iCE40 has none, and Yosys does not make flip-flops of what asks for it.
        styles = {"ram_style": "distributed"} if config.memory == "dual" else {}
        # Kept, so that one LUT lies between the memory's outputs and its inputs.
        keep = {"keep": 1} if config.memory == "dual" else {}
        kept = [Signal(2 << low_bits, name=f"kept_{q}") for q in range(RESIDUES)]
        for parity in range(2):
            # The pair of this parity: the first word's, or the next one.
            own = Signal(name=f"own_{parity}")
            pair = Signal.like(pairs[0], name=f"pair_{parity}")
            bit = Signal(1 << low_bits, name=f"bit_{parity}")
            stretch = Signal.like(self.stretch, name=f"stretch_{parity}")
            m.d.comb += [
                own.eq(pairs[0][0] == parity),
                pair.eq(Mux(own, pairs[0], pairs[1])),
                bit.eq(1 << pair[1 : 1 + low_bits]),
                stretch.eq(pair[1 + low_bits :]),
            ]
            for residue in range(RESIDUES):
                name = f"marks_{residue}_{parity}"
                ram = memory.Memory(
                    shape=1 << low_bits,
                    depth=stretches(config) << config.group_bits,
                    init=[],
                    attrs=styles,
                )
                m.submodules[name] = ram
                read, write = ram.read_port(domain="comb"), ram.write_port()
                first, second = self.touch[residue][0], self.touch[residue][1]
                touched = Mux(own, first | (second & ~apart), second & apart)
                lone = self.lone[residue]
                touched |= self.load[residue] & (other[0] == parity)
                mine = self.wipe | (self.line[:2] == residue)
                take = self.take & mine if config.flush_words == 2 else self.take
                address = Mux(
                    take,
                    Cat(self.stretch, self.line[2:]),
                    Cat(Mux(lone, other[1 + low_bits :], stretch), self.group[residue]),
                )
                mark = Signal(1 << low_bits, name=f"mark_{residue}_{parity}", attrs=keep)
                m.d.comb += [
                    read.addr.eq(address),
                    write.addr.eq(address),
                    write.en.eq(Mux(take, mine, touched)),
                    mark.eq(Mux(lone, other_bit, bit)),
                    write.data.eq(Mux(take, 0, read.data | mark)),
                    Cat(kept[residue][parity::2]).eq(read.data),
                ]
        m.d.comb += self.taken.eq(
            Mux(
                self.line[1],
                Mux(self.line[0], kept[3], kept[2]),
                Mux(self.line[0], kept[1], kept[0]),
            )
        )
        return m
