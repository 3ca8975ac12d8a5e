"""The material table, in one block RAM even where a material is wider than its ports."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig

from .tables import MaterialWriteLayout

__all__ = ["MaterialTable"]

PORT_BITS = 36
"""Widest port of a block RAM; it has two."""


class MaterialTable(wiring.Component):
    """Holds the coefficients of each material.

    A material of up to 36 bits, and any with simple memories, is written through one port and read
    through the other. A wider one is cut into halves, which lie in one block RAM at different
    addresses. Each port writes and reads one half, so one block RAM is enough. A port has one
    address for both, so a write excludes a read. Tables are written between frames, when no
    material is read.

    In the blocks engine the block RAM reads in every cycle, and a register holds what was read
    while ``enable`` was high: ``enable`` comes late, and a block RAM lies far away.

    **Latency**: 1 cycle. **Throughput**: one material a cycle.

    Members
    -------
    write : In(MaterialWriteLayout)
        A write into the table. With materials of over 36 bits it disturbs ``data``.
    enable : In(1)
        High: ``data`` changes to the material at ``address``. Low: ``data`` stays.
    address : In(material_bits)
        The material.
    data : Out(6 * coefficient_bits)
        Its coefficients.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "write": In(MaterialWriteLayout(config)),
                "enable": In(1),
                "address": In(config.material_bits),
                "data": Out(6 * config.coefficient_bits),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        bits = len(self.data)
        parts = 1 if bits <= PORT_BITS or self.config.memory == "simple" else 2
        width = bits // parts
        m.submodules.ram = ram = memory.Memory(
            shape=width,
            depth=parts << self.config.material_bits,
            init=[],
            # No material is read while one is written, because writes happen between frames.
            attrs={"ram_style": "block", "no_rw_check": 1},
        )
        if parts == 1:
            ports = [(self.write.address, self.address, self.enable)]
        else:
            shared = Signal(self.config.material_bits)
            # A port of a block RAM reads in every cycle of a write.
            enable = Signal()
            m.d.comb += [
                shared.eq(Mux(self.write.enable, self.write.address, self.address)),
                enable.eq(self.enable | self.write.enable),
            ]
            ports = [
                (Cat(shared, Const(part, 1)), Cat(shared, Const(part, 1)), enable)
                for part in range(parts)
            ]
        found = Signal.like(self.data) if self.config.draws_blocks else self.data
        for part, (write_address, read_address, enable) in enumerate(ports):
            write, read = ram.write_port(), ram.read_port()
            chosen = slice(part * width, (part + 1) * width)
            m.d.comb += [
                write.en.eq(self.write.enable),
                write.addr.eq(write_address),
                write.data.eq(self.write.data[chosen]),
                read.en.eq(1 if self.config.draws_blocks else enable),
                read.addr.eq(read_address),
                found[chosen].eq(read.data),
            ]
        if self.config.draws_blocks:
            m.d.comb += self.data.eq(self._hold(m, found))
        return m

    def _hold(self, m, found):
        """Return the material that was read when ``enable`` was last high."""
        is_new = Signal()
        held = Signal.like(found)
        m.d.sync += is_new.eq(self.enable)
        with m.If(is_new):
            m.d.sync += held.eq(found)
        return Mux(is_new, found, held)
