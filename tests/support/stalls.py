"""Random stalls on streams inside a circuit, which a bench cannot reach."""

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import Out

__all__ = ["Stalled"]


class Stalled(wiring.Component):
    """A component with random stalls on each of its streams.

    A stream is blocked in two cycles of three. A payload that is offered stays until it is taken.
    Outputs that are not streams are connected unchanged.
    """

    def __init__(self, part, seed):
        self.part = part
        self.seed = seed
        super().__init__(part.signature)

    def elaborate(self, platform):
        m = Module()
        m.submodules.part = self.part
        for number, (name, member) in enumerate(self.signature.members.items()):
            inner, outer = getattr(self.part, name), getattr(self, name)
            if member.is_port and member.flow is Out:
                m.d.comb += outer.eq(inner)
                continue
            if not (member.is_signature and isinstance(member.signature, stream.Signature)):
                raise TypeError(f"{name} is no stream")
            source, sink = (inner, outer) if member.flow is Out else (outer, inner)
            bits = Signal(31, init=(1 + self.seed * 7919 + number * 104729) % (1 << 31))
            kept, flows = Signal(name=f"kept_{name}"), Signal(name=f"flows_{name}")
            m.d.sync += [
                bits.eq(Cat(bits[30] ^ bits[27], bits)),
                kept.eq(sink.valid & ~sink.ready),
            ]
            m.d.comb += [
                flows.eq(kept | (bits[:2] == 0) | (bits[4:8] == 0)),
                sink.payload.eq(source.payload),
                sink.valid.eq(source.valid & flows),
                source.ready.eq(sink.ready & flows),
            ]
        return m
