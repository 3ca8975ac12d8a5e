"""Who may use the window's banks in a cycle."""

from amaranth.hdl import Cat, Module, Mux, Signal, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from .bank import BankRequestLayout
from .bank_layout import bank_address_bits, residue_bits, turned
from .choose import pick
from .format import EngineConfig
from .layouts import DealLayout, FlushLayout, LoadLayout

__all__ = ["BankArbiter"]


class BankArbiter(wiring.Component):
    """Gives each bank an address a cycle: of the initial raster, of an element, or of a flush.

    The element goes first, and a flush or a word of the initial raster takes what banks are left,
    by turns where they are not. If six or seven lines wait to be flushed, with sixteen banks two or
    more, then the flush goes before the element; and the word, where it is ``behind``. No word is
    asked for that is still to be written: :class:`Scatter` sees to that among elements, all else is
    seen to here.

    After reset all words are cleared, which takes as many cycles as a bank has words.

    **Latency**: 0, combinational. **Throughput**: an element a cycle, and beside it a flush or a
    word of the initial raster while its banks are free; with further planes such a word takes two
    cycles.

    Members
    -------
    running : In(1)
        Low: the banks stand still, and nothing is taken.
    draw : In(stream of DealLayout)
        Words of an element.
    stale : In(banks)
        Banks in which the element's word is still to be written: it waits.
    taken : Out(banks)
        Banks that take their word of the element in this cycle.
    drawing : Out(1)
        The element's turn has come, though not all its banks need be free.
    load : In(stream of LoadLayout)
        A word of the initial raster, of a line that no element is offered for.
    behind : In(1)
        That word goes before the element.
    further : Out(1)
        Of a word with further planes these are loaded; its depths and plane 0 were.
    flush : In(stream of FlushLayout)
        Words that are to leave; of a line that nothing more is drawn into, in which nothing is on
        its way. While none are offered the line counts, which is the next one that leaves.
    early : In(1)
        Their place counts as free already: they go before the initial raster.
    may_flush : In(1)
        There is room for them.
    ahead : In(signed(line_bits + 2))
        So many lines are complete, as of the element that is offered.
    busy : In(banks)
        Banks that work on further planes.
    requests : Out(banks x BankRequestLayout)
        What the banks are to do.
    wiping : Out(1)
        The words that the banks were asked for one cycle before are cleared after a reset.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "running": In(1),
                "draw": In(stream.Signature(DealLayout(config))),
                "stale": In(config.banks),
                "taken": Out(config.banks),
                "drawing": Out(1),
                "load": In(stream.Signature(LoadLayout(config))),
                "behind": In(1),
                "further": Out(1),
                "flush": In(stream.Signature(FlushLayout(config))),
                "early": In(1),
                "may_flush": In(1),
                "ahead": In(signed(config.line_bits + 2)),
                "busy": In(config.banks),
                "requests": Out(data.ArrayLayout(BankRequestLayout(config), config.banks)),
                "wiping": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        deal, leaving = self.draw.payload, self.flush.payload
        banks, bits = self.config.banks, residue_bits(self.config)
        lines = banks // 2  # that lie in different banks

        sweeping = Signal(init=1)
        sweep = Signal(bank_address_bits(self.config))
        with m.If(sweeping):
            m.d.sync += [sweep.eq(sweep + 1), sweeping.eq(~sweep.all())]
        swept = Signal(init=1)  # in the cycle before: words are still to be written
        m.d.sync += swept.eq(sweeping)

        # What is served besides the element: the initial raster's word, or those that leave.
        word, line = self.load.payload.word, self.load.payload.line
        serving = Signal()  # the former
        refused = Signal()  # it was in vain, in the cycle before
        # It is behind and was refused: then it goes before an element that wants its bank. Known a
        # cycle ahead, as all before an element waits for it.
        pressing = Signal()
        m.d.comb += serving.eq(
            self.load.valid & (pressing | ~(self.flush.valid & (refused | self.early)))
        )
        upper = word[0] ^ turned(self.config, line)
        halves = Cat(~upper, upper)
        service = Signal(FlushLayout(self.config))
        address = Signal.like(sweep)
        m.d.comb += [
            service.eq(leaving),
            address.eq(Cat(service.pair, service.line[bits : self.config.slot_bits])),
        ]
        with m.If(serving):
            m.d.comb += [
                service.pair.eq(word[1:]),
                service.line.eq(line),
                service.halves.eq(halves),
            ]
        with m.If(sweeping):
            m.d.comb += address.eq(sweep)

        # Where complete lines wait, flushing goes before the element in the bank that it needs, or
        # keeps both of the oldest line, whose marks it waits for. Six lines with eight banks, as
        # splats of a few pixels then lie in other banks than the oldest line; four or eight lines
        # apart they are the same. Two with sixteen: closer to the splats no line is in their way.
        urgent = Signal()
        waiting = Signal()  # so many lines wait; known a cycle late
        m.d.comb += urgent.eq(waiting & self.may_flush)
        several = self.ahead[1:3].all() if banks == 8 else self.ahead[1:].any()
        m.d.sync += waiting.eq(~self.ahead[-1] & several)

        loading, flushing = Signal(), Signal()
        # For which line banks are kept from the element: that which leaves, or is loaded.
        first_line = Signal(bits)
        # Of each half of the banks, the one in which that line lies: whether it is kept, and
        # whether the element wants it. Chosen by the line first: to ask all banks what each of
        # them does would be the longest way of the engine.
        kept, sought = Signal(2), Signal(2)
        # The one that is to serve does something else.
        blocked, full = Signal(2), Signal(2)
        m.d.comb += [
            self.wiping.eq(swept),
            self.drawing.eq(self.draw.valid & ~swept),
            first_line.eq(Mux(pressing, line, leaving.line)),
            kept.eq(
                Mux(
                    pressing,
                    halves,
                    (leaving.halves | ~self.flush.valid.replicate(2)) & urgent.replicate(2),
                )
            ),
            sought.eq(self._of_halves(deal.want, first_line)),
            self.draw.ready.eq(
                self.drawing
                & self.running
                & ~(sought & kept).any()
                & ~(deal.want & (self.stale | self.busy)).any()
            ),
            blocked.eq(
                (sought & ~kept & self.drawing.replicate(2))
                | self._of_halves(self.busy, leaving.line)
            ),
            full.eq(
                (self._of_halves(deal.want, line) & (self.drawing & ~pressing).replicate(2))
                | self._of_halves(self.busy, line)
            ),
        ]
        for index in range(banks):
            share, request = deal.shares[index], self.requests[index]
            mine = Signal(name=f"mine_{index}")
            wanted = Signal(name=f"wanted_{index}")
            has_line = service.line[:bits] == index % lines
            half = index // lines
            held = kept[half] & (first_line == index % lines)
            # What leaves, or is loaded, is never a word that is being drawn into.
            m.d.comb += [
                wanted.eq(self.drawing & deal.want[index] & ~held),
                self.taken[index].eq(
                    wanted & ~self.stale[index] & ~self.busy[index] & self.running
                ),
                mine.eq(has_line & service.halves[half] & ~wanted),
                request.address.eq(Mux(wanted, share.address, address)),
                request.mask.eq(share.mask),
                request.draw.eq(self.taken[index]),
                request.load.eq(loading & mine),
                request.further.eq(self.further),
                request.clear.eq((flushing & mine) | sweeping),
            ]

        # A word of the line whose place it takes may have left just now, and is still cleared:
        # there the port that writes would meet the one that loads.
        left = Signal()  # in the cycle before
        place = Signal(self.config.slot_bits, reset_less=True)  # of which line
        again = Signal()
        m.d.comb += [
            again.eq(left & (place == line[: len(place)])),
            loading.eq(
                serving & self.running & ~sweeping & ~swept & ~again & ~(halves & full).any()
            ),
            self.flush.ready.eq(
                self.running
                & ~sweeping
                & ~serving
                & self.may_flush
                & ~(leaving.halves & blocked).any()
            ),
            flushing.eq(self.flush.valid & self.flush.ready),
        ]
        m.d.sync += [refused.eq(serving & ~loading), pressing.eq(serving & ~loading & self.behind)]
        if self.config.colour_planes == 1:
            m.d.comb += self.load.ready.eq(loading)
        else:
            m.d.comb += self.load.ready.eq(loading & self.further)
            with m.If(loading):
                m.d.sync += self.further.eq(~self.further)
        with m.If(self.running):
            m.d.sync += [left.eq(flushing), place.eq(leaving.line[: len(place)])]
        return m

    def _of_halves(self, banks, line):
        """Return the bits of the two of ``banks`` in which a line lies."""
        lines = self.config.banks // 2
        residue = line[: residue_bits(self.config)]
        return Cat(pick(list(banks[half : half + lines]), residue) for half in (0, lines))
