"""Which words of the window's banks were drawn into: a bit for each, or for a few."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from .bank_layout import bank_address_bits, column_bits, residue_bits, stretch_bits
from .choose import choose
from .format import EngineConfig

__all__ = ["BankMarks"]


class BankMarks(wiring.Component):
    """Marks words that are drawn into, and hands out a stretch of a line's marks at a time.

    A bank is drawn into at one address a cycle, so a memory beside each with one port is enough:
    its rows are addressed as the bank, but for the lowest bits, which choose a column. Memories of
    up to 32 rows and one bit are what the LUTs of a Virtex-II hold. A line lies in two banks, its
    words by turns in one and the other. So many words of a bank as ``mark_words`` share a bit.

    **Latency**: 1 cycle from a word to its mark, 0 from ``line`` and ``stretch`` to ``bits``.
    **Throughput**: a word a bank and cycle; a stretch a cycle, while its banks mark nothing.

    Members
    -------
    drawn : In(banks)
        The bank's word at ``addresses`` is drawn into: mark it.
    addresses : In(banks x bank_address_bits)
        Which word.
    line : In(4)
        Place in the window of a line.
    stretch : In(stretch_bits)
        A stretch of it.
    busy : Out(1)
        A bank of that line is marking: ``bits`` mean nothing.
    take : In(1)
        Clear that stretch; not while ``busy``.
    wipe : In(1)
        Clear the marks of all words that share a row with those at ``addresses``; nothing is drawn
        in that cycle.
    bits : Out(2 ** (column_bits + 1))
        The words' marks, two neighbours after the other. Of two neighbours the one in the lower
        half of the banks comes first, whichever lies left.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "drawn": In(config.banks),
                "addresses": In(data.ArrayLayout(bank_address_bits(config), config.banks)),
                "line": In(4),
                "stretch": In(stretch_bits(config)),
                "busy": Out(1),
                "take": In(1),
                "wipe": In(1),
                "bits": Out(2 << column_bits(config)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        low = column_bits(self.config)
        shared = min(self.config.mark_words.bit_length() - 1, low)  # bits of an address left out
        banks, residue = self.config.banks, self.line[: residue_bits(self.config)]
        group = self.line[len(residue) :]
        row = Signal(stretch_bits(self.config) + len(group))
        m.d.comb += row.eq(Cat(self.stretch, group))

        kept = [Signal(1 << low, name=f"kept_{bank}") for bank in range(banks)]
        for bank in range(banks):
            drawn, address = self.drawn[bank], self.addresses[bank]
            clear = Signal(name=f"clear_{bank}")
            mark_row = Signal.like(row, name=f"mark_row_{bank}")
            m.d.comb += [
                clear.eq(self.wipe | (self.take & (residue == bank % (banks // 2)))),
                mark_row.eq(Mux(drawn | self.wipe, address[low:], row)),
            ]
            for column in range(1 << low - shared):
                ram = memory.Memory(
                    shape=1,
                    depth=1 << len(row),
                    init=[],
                    attrs={"ram_style": "distributed"},
                )
                m.submodules[f"marks_{bank}_{column}"] = ram
                read, write = ram.read_port(domain="comb"), ram.write_port()
                m.d.comb += [
                    read.addr.eq(mark_row),
                    write.addr.eq(mark_row),
                    write.en.eq((drawn & (address[shared:low] == column)) | clear),
                    write.data.eq(drawn),
                    kept[bank][column << shared : column + 1 << shared].eq(
                        read.data.replicate(1 << shared)
                    ),
                ]

        halves = [Signal(1 << low, name=f"half_{n}") for n in range(2)]
        for half, side in zip(halves, (kept[: banks // 2], kept[banks // 2 :]), strict=True):
            m.d.comb += half.eq(choose(m, side, residue))
        for column in range(1 << low):
            m.d.comb += self.bits[2 * column : 2 * column + 2].eq(
                Cat(halves[0][column], halves[1][column])
            )
        m.d.comb += self.busy.eq(
            choose(m, self.drawn[: banks // 2] | self.drawn[banks // 2 :], residue)
        )
        return m
