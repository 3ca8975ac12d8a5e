"""Table writes: the frame registers, and the write port of the material table."""

from amaranth.hdl import Module, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.contract.fields import Register
from splatline.rtl.layouts import TableWriteLayout

__all__ = ["MaterialWriteLayout", "RegistersLayout", "Tables"]


class RegistersLayout(data.StructLayout):
    """The frame registers, which are constant during a frame."""

    def __init__(self, config: EngineConfig):
        super().__init__(
            {
                "ambient": data.ArrayLayout(config.ambient_bits, 3),
                "last_column": config.x_bits,
                "last_line": config.line_bits,
                "load": 1,
            }
        )


class MaterialWriteLayout(data.StructLayout):
    """A write into the material table."""

    def __init__(self, config: EngineConfig):
        super().__init__(
            {"enable": 1, "address": config.material_bits, "data": 6 * config.coefficient_bits}
        )


class Tables(wiring.Component):
    """Takes table writes while the engine is between frames.

    **Latency**: a register shows its new value in the next cycle; the material table's write port
    sees the write at once. **Throughput**: one write a cycle while ``idle``.

    Members
    -------
    i : In(stream of TableWriteLayout)
        The writes. A write to an unknown address is taken and ignored.
    idle : In(1)
        The engine is between frames; writes wait otherwise.
    registers : Out(RegistersLayout)
        The frame registers.
    material : Out(MaterialWriteLayout)
        Write port of the material table.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(TableWriteLayout(config))),
                "idle": In(1),
                "registers": Out(RegistersLayout(config)),
                "material": Out(MaterialWriteLayout(config)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        write = self.i.payload
        width, height = config.reset_size
        registers = Signal(
            RegistersLayout(config), init={"last_column": width - 1, "last_line": height - 1}
        )
        m.d.comb += [
            self.i.ready.eq(self.idle),
            self.registers.eq(registers),
            self.material.enable.eq(
                self.i.valid & self.i.ready & ~write.address[config.material_bits]
            ),
            self.material.address.eq(write.address),
            self.material.data.eq(write.data),
        ]

        with m.If(self.i.valid & self.i.ready), m.Switch(write.address):
            base = config.register_base
            for channel in range(3):
                with m.Case(base + Register.AMBIENT_RED + channel):
                    m.d.sync += registers.ambient[channel].eq(write.data)
            with m.Case(base + Register.LAST_COLUMN):
                m.d.sync += registers.last_column.eq(write.data)
            with m.Case(base + Register.LAST_LINE):
                m.d.sync += registers.last_line.eq(write.data)
            with m.Case(base + Register.CONTROL):
                m.d.sync += registers.load.eq(write.data[Register.CONTROL_LOAD])
        return m
