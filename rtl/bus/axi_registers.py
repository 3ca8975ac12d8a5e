"""The register file behind the AXI4-Lite port, made from the register map."""

from __future__ import annotations

from collections.abc import Callable

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.register_types import (
    REGISTER_BYTES,
    Access,
    BusField,
    BusRegister,
    RegisterMap,
)
from splatline.rtl.layouts import TableWriteLayout

from .axi_lite import AxiLiteFront, AxiLiteSignature, Response

__all__ = ["EventsLayout", "LiveLayout", "PulsesLayout", "RegisterFile", "ValuesLayout"]

FULL = 0xFFFF_FFFF

REGISTERS_END = (REGISTER_BYTES - 1).bit_length()
"""Address bits of the registers."""


def _is_stored(register: BusRegister, field: BusField) -> bool:
    return field.access in (Access.READ_WRITE, Access.CLEAR)


def _is_pulse(register: BusRegister, field: BusField) -> bool:
    return field.access is Access.WRITE_ONLY and register.table is None


class _FieldsLayout(data.StructLayout):
    """The fields of a map that fulfil a condition, by name: ``control_hold``."""

    def __init__(self, registers: RegisterMap, has: Callable[[BusRegister, BusField], bool]):
        super().__init__(
            {
                name: field.place.width
                for name, register, field in registers.fields()
                if has(register, field)
            }
        )


class ValuesLayout(_FieldsLayout):
    """Stored fields, which can be written and read."""

    def __init__(self, registers: RegisterMap):
        super().__init__(registers, _is_stored)


class EventsLayout(_FieldsLayout):
    """Events, which set the fields that a written 1 clears."""

    def __init__(self, registers: RegisterMap):
        super().__init__(registers, lambda _, field: field.access is Access.CLEAR)


class LiveLayout(_FieldsLayout):
    """Live fields, which show a state of the hardware."""

    def __init__(self, registers: RegisterMap):
        super().__init__(registers, lambda _, field: field.live)


class PulsesLayout(_FieldsLayout):
    """Pulses, which a written 1 causes."""

    def __init__(self, registers: RegisterMap):
        super().__init__(registers, _is_pulse)


class RegisterFile(wiring.Component):
    """Holds the fields of a map, and turns writes to tables into the engine's table writes.

    A write is done or refused as a whole. DECERR: there is no register at its address. SLVERR: the
    register is read-only; or not all four bytes are written; or a bit is set that the register does
    not have; or the register is written between frames only, and ``busy`` is high. A read gives
    DECERR if there is no register, and SLVERR if the register is write-only; its data are 0. A
    refused access sets its bit of ERROR. Its response is OKAY if CONTROL.QUIET is set. The two
    lowest bits of an address are ignored.

    One register, which all entries share, holds the low words of a material until the last word of
    the entry is written.

    **Latency**, **Throughput**: those of :class:`AxiLiteFront`. A write to a table is answered once
    the engine has taken it. A field has its new value in the cycle after the write. If the hardware
    sets a field in the cycle in which a 1 clears it, it stays set.

    Parameters
    ----------
    registers
        The map.

    Members
    -------
    bus : In(AxiLiteSignature)
        The port.
    busy : In(1)
        A frame is open.
    values : Out(ValuesLayout)
        Stored fields.
    events : In(EventsLayout)
        A 1 sets the field. Those of the file itself, ``error_bus_*``, are ignored.
    live : In(LiveLayout)
        Live fields.
    pulses : Out(PulsesLayout)
        High for the cycle in which a 1 is written.
    tables : Out(stream of TableWriteLayout)
        Table writes. None is offered while ``busy``.
    """

    def __init__(self, registers: RegisterMap):
        self.registers = registers
        super().__init__(
            {
                "bus": In(AxiLiteSignature(registers.address_bits)),
                "busy": In(1),
                "values": Out(ValuesLayout(registers)),
                "events": In(EventsLayout(registers)),
                "live": In(LiveLayout(registers)),
                "pulses": Out(PulsesLayout(registers)),
                "tables": Out(stream.Signature(TableWriteLayout(registers.config))),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        m.submodules.front = front = AxiLiteFront(self.registers.address_bits)
        connect(m, flipped(self.bus), front.bus)
        fields = list(self.registers.fields())
        values = Signal(
            ValuesLayout(self.registers),
            init={
                name: field.reset for name, register, field in fields if _is_stored(register, field)
            },
        )
        m.d.comb += self.values.eq(values)
        refusals = self._write(m, front, values)
        for name, seen in self._read(m, front, values).items():
            refusals[name] = refusals[name] | seen

        for name, _, field in fields:
            if field.access is Access.CLEAR:
                with m.If(refusals.get(name, self.events[name])):
                    m.d.sync += values[name].eq(1)
        return m

    def _write(self, m, front, values):
        """Do a write, or refuse it; return the reasons, by the fields of ERROR."""
        valid, address, payload = front.write_valid, front.write.address, front.write.data
        known = Signal()
        writable = Signal()
        between = Signal()
        table = Signal()
        extra = Signal(32)  # bits that the register does not accept
        whole = Signal()
        right = Signal()
        refused = Signal()
        commit = Signal()
        table_write = self.tables.payload
        window = self.registers.materials
        held = Signal(32 * (window.words - 1), reset_less=True)

        number, place, in_window, in_registers = self._split(address)
        with m.If(in_window), m.Switch(place):
            for word, mask in enumerate(window.writable):
                with m.Case(word):
                    m.d.comb += [
                        known.eq(1),
                        writable.eq(1),
                        between.eq(1),
                        extra.eq(payload & ~mask & FULL),
                        table.eq(word == window.words - 1),
                        table_write.address.eq(number),
                        table_write.data.eq(Cat(held, payload)),
                    ]
                    if word < window.words - 1:
                        with m.If(commit):
                            m.d.sync += held[32 * word :][:32].eq(payload)
        with m.Elif(in_registers), m.Switch(address[2:REGISTERS_END]):
            for register in self.registers.registers:
                with m.Case(register.offset >> 2):
                    m.d.comb += known.eq(1)
                    if register.writable:
                        m.d.comb += [
                            writable.eq(1),
                            between.eq(register.between_frames),
                            extra.eq(payload & ~register.accepted & FULL),
                        ]
                        with m.If(commit):
                            self._store(m, register, values, payload)
                    if register.table is not None:
                        m.d.comb += [
                            table.eq(1),
                            table_write.address.eq(register.table),
                            table_write.data.eq(payload),
                        ]

        m.d.comb += [
            whole.eq(front.write.strobe.all()),
            right.eq(valid & writable & whole & ~extra.any()),
            refused.eq(between & self.busy),
            self.tables.valid.eq(right & ~refused & table),
            commit.eq(right & ~refused & (~table | self.tables.ready)),
            front.write_done.eq(~right | refused | commit),
            front.write_response.eq(self._response(known, right & ~refused, values)),
        ]
        return {
            "error_bus_address": valid & ~known,
            "error_bus_access": valid & known & ~writable,
            "error_bus_strobe": valid & writable & ~whole,
            "error_bus_value": valid & writable & extra.any(),
            "error_bus_busy": right & refused,
        }

    def _store(self, m, register, values, payload):
        """Write a register's fields: store, clear or pulse them."""
        for field in register.fields:
            name = f"{register.name}_{field.name}".lower()
            bits = payload[field.place.lsb : field.place.end]
            if field.access is Access.READ_WRITE:
                m.d.sync += values[name].eq(bits)
            elif field.access is Access.CLEAR:
                m.d.sync += values[name].eq(values[name] & ~bits)
            elif _is_pulse(register, field):
                m.d.comb += self.pulses[name].eq(bits)

    def _read(self, m, front, values):
        """Answer a read; return the reasons to refuse it, by the fields of ERROR."""
        known = Signal(name="read_known")
        allowed = Signal(name="read_allowed")
        _, place, in_window, in_registers = self._split(front.read)
        with m.If(in_window):
            m.d.comb += known.eq(place < self.registers.materials.words)
        with m.Elif(in_registers), m.Switch(front.read[2:REGISTERS_END]):
            for register in self.registers.registers:
                with m.Case(register.offset >> 2):
                    m.d.comb += [
                        known.eq(1),
                        allowed.eq(register.readable),
                        front.read_data.eq(self._shown(register, values)),
                    ]
        m.d.comb += front.read_response.eq(self._response(known, allowed, values))
        return {
            "error_bus_address": front.read_valid & ~known,
            "error_bus_access": front.read_valid & known & ~allowed,
        }

    def _shown(self, register, values):
        """Return the value that a read of a register gives."""
        bits = []
        for field in register.fields:
            name = f"{register.name}_{field.name}".lower()
            if field.live:
                bits.append(self.live[name])
            elif _is_stored(register, field):
                bits.append(values[name])
            else:
                shown = field.reset if field.access.readable else 0
                bits.append(Const(shown, field.place.width))
        return Cat(bits)

    def _split(self, address):
        """Split an address.

        Return the entry and the word in the window of materials, whether the address lies there,
        and whether it lies among the registers.
        """
        window = self.registers.materials
        low = window.stride.bit_length() - 1
        high = low + (window.entries - 1).bit_length()
        materials = window.offset.bit_length() - 1  # the address bit that is set there
        assert high <= materials < self.registers.address_bits == materials + 1
        return (
            address[low:high],
            address[2:low],
            address[materials] & ~address[high:materials].any(),
            ~address[REGISTERS_END:].any(),
        )

    @staticmethod
    def _response(known, done, values):
        """Return the response on the bus."""
        okay = done | values.control_quiet
        return Mux(okay, Response.OKAY, Mux(known, Response.SLVERR, Response.DECERR))
