"""The engine on AXI: AXI4-Stream for code words and rasters, AXI4-Lite for the registers."""

from __future__ import annotations

from amaranth.hdl import Cat, ClockDomain, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.contract.register_map import register_map
from splatline.rtl.engine import Engine
from splatline.rtl.layouts import CodeWordLayout, RasterLayout, TableWriteLayout

from .axi_lite import AxiLiteSignature
from .axi_registers import RegisterFile
from .axi_stream import AxiStreamSignature, HalfSlice, PacketLayout, RegisterSlice, ReverseSlice
from .codeword_check import CodeWordCheck, end_word, is_end
from .stream_guard import StreamGuard

__all__ = ["AxiTop"]


class AxiTop(wiring.Component):
    """An engine with AXI ports, for a block design.

    Its ports have the names by which vendors' tools find buses: ``aclk``, ``aresetn``,
    ``s_axi_ctrl_*`` (AXI4-Lite), ``s_axis_codewords_*``, ``s_axis_initial_*``, ``m_axis_raster_*``
    (AXI4-Stream) and ``irq``. The registers are in ``docs/registers.md``.

    - A packet of code words is a frame; TLAST comes with its end word. A code word is 8 bytes; a
      plane word is 12 bytes, filled up with zeros to 16.
    - A packet of the raster is a frame as well: its beats, filled up with zeros to a power of two
      of bytes, and then the end beat, with TLAST. A packet is therefore never empty, and there is
      one for each packet of code words.
    - An initial raster is a packet of the same kind.

    Anything else sets a bit of the register ERROR and does no harm (see :class:`StreamGuard` and
    :class:`RegisterFile`).

    CONTROL.ABORT ends the open frame. An end is inserted behind the words that were taken. An
    initial raster that has not ended yet ends. The rest of both packets is dropped up to TLAST. Of
    the picture only the end beat still leaves. The engine is not reset, so its tables stay.

    All inputs and outputs of the buses are registered: no combinational path leads from an input
    to an output. The engine says late in a cycle whether it takes a code word. That answer ends in
    one flip-flop behind the guard, and in one that counts stalls. Beats of the initial raster and
    table writes reach the engine from registers, and so do the pulses of CONTROL their targets.

    **Latency**: 1 cycle from a code word's acceptance to the engine, 2 for a frame's first; then
    that of the engine; 1 from the engine to the raster port. 2 cycles from an initial beat's
    acceptance to the engine, 3 for a packet's first. **Throughput**: within a frame that of the
    engine. There is no frame overlap: the next frame opens once the end beat of this one has
    left the engine.

    Parameters
    ----------
    config
        The engine's configuration.
    engine
        A component with the ports of :class:`Engine`; an engine of that configuration if not given.

    Members
    -------
    aclk, aresetn : In(1)
        Clock, and synchronous reset, active low.
    s_axi_ctrl_* : AxiLiteSignature
        The registers.
    s_axis_codewords_*, s_axis_initial_* : AxiStreamSignature
        Code words, and the initial raster.
    m_axis_raster_* : AxiStreamSignature
        The picture.
    irq : Out(1)
        An enabled bit of IRQ_STATUS is set. High until the bit is cleared.
    """

    def __init__(self, config: EngineConfig = PAPER, engine: wiring.Component | None = None):
        self.config = config
        self.engine = Engine(config) if engine is None else engine
        self.registers = register_map(config)
        picture = self._picture_members()
        self.buses = {
            "s_axi_ctrl": In(AxiLiteSignature(self.registers.address_bits)),
            "s_axis_codewords": In(AxiStreamSignature(codeword_stream_bytes(config))),
            "s_axis_initial": In(AxiStreamSignature(raster_stream_bytes(config))),
            **{name: member for name, member in picture.items() if not member.is_port},
        }
        super().__init__(
            {
                "aclk": In(1),
                "aresetn": In(1),
                **{
                    f"{bus}_{name}": wire
                    for bus, member in self.buses.items()
                    for name, wire in member.signature.members.items()
                },
                "irq": Out(1),
                **{name: member for name, member in picture.items() if member.is_port},
            }
        )

    @property
    def latency(self) -> int:
        """Cycles from a code word's acceptance to the one that writes its first pixels."""
        return self.engine.latency + 1

    @property
    def clear_cycles(self) -> int:
        """Cycles after reset in which the engine clears its memory; code words wait."""
        return self.engine.clear_cycles

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        m.domains.sync = sync = ClockDomain("sync")
        m.d.comb += [sync.clk.eq(self.aclk), sync.rst.eq(~self.aresetn)]

        m.submodules.engine = engine = self.engine
        registers = self._registers(m)
        writing = self._tables(m, registers)

        m.submodules.codewords = codewords = self._codewords(m)
        m.submodules.initial = initial = self._initial(m)
        beats = self._loaded(m, initial)
        stalled = self._drawn(m, codewords)
        values = registers.values
        # Registers first, because writes are decoded late in a cycle and clear many registers.
        pulses = Signal.like(registers.pulses)
        m.d.sync += pulses.eq(registers.pulses)

        # One frame is open at a time, from its first code word in the guard to its end beat. The
        # engine alone would take the next frame while this one's end beat still waits.
        word_taken = Signal()
        end_taken = Signal()
        drawing = Signal()
        loading = Signal()  # the initial raster has not ended yet
        aborting = Signal()
        released = Signal()  # its guard was told to end it
        busy = Signal()
        abort = Signal()
        m.d.comb += [
            word_taken.eq(codewords.o.valid & codewords.o.ready),
            end_taken.eq(engine.raster.valid & engine.raster.ready & engine.raster.payload.end),
            busy.eq(codewords.open | drawing),
            # Not in the cycle in which the end beat is taken: the frame is complete then.
            abort.eq(pulses.control_abort & busy & ~end_taken),
            registers.busy.eq(busy),
            # A table write has priority over a new frame, as in the engine.
            codewords.admit.eq(~drawing & ~values.control_hold & ~writing),
            codewords.cut.eq(abort & codewords.open),
            codewords.forget.eq(pulses.control_resync),
            initial.admit.eq(1),
            # Not if its end has passed the guard and waits for the engine.
            initial.cut.eq(aborting & loading & ~released & ~(beats.valid & beats.payload.end)),
            initial.forget.eq(pulses.control_resync),
        ]
        with m.If(end_taken):
            m.d.sync += [drawing.eq(0), aborting.eq(0), released.eq(0)]
        with m.If(word_taken):
            m.d.sync += drawing.eq(1)
            with m.If(~drawing):
                m.d.sync += loading.eq(values.start_load)
        with m.If(initial.cut):
            m.d.sync += released.eq(1)
        with m.If(beats.valid & beats.ready & beats.payload.end):
            m.d.sync += loading.eq(0)
        with m.If(abort):
            m.d.sync += aborting.eq(1)

        end_left, word_left, output_stalls = self._raster(m, values, aborting)

        check = self._check(m, registers, codewords.o.payload, word_taken)
        self._report_packets(m, registers.events, codewords, initial)
        events, live = registers.events, registers.live
        m.d.comb += [events.error_aborted.eq(abort), events.irq_status_frame_done.eq(end_left)]
        m.d.comb += [
            live.status_busy.eq(busy),
            live.status_dropping.eq(codewords.dropping),
            live.status_dropping_initial.eq(initial.dropping),
            live.status_aborting.eq(aborting),
            live.irq_status_error.eq(_errors(self.registers, values).any()),
        ]
        counted = {
            "frames": end_left,
            "elements": check.element,
            "cycles": word_taken | drawing,
            "input_stalls": stalled,
            "output_stalls": output_stalls,
            "words": word_left,
        }
        self._count(m, registers.live, pulses.control_clear, counted)
        self._interrupt(m, values, live)
        return m

    def _interrupt(self, m, values, live):
        """Raise the interrupt while an enabled bit of IRQ_STATUS is set."""
        irq = Signal()
        m.d.sync += irq.eq(
            (values.irq_status_frame_done & values.irq_enable_frame_done)
            | (live.irq_status_error & values.irq_enable_error)
        )
        m.d.comb += self.irq.eq(irq)

    def _registers(self, m):
        """Return the register file behind the AXI4-Lite port."""
        m.submodules.registers = registers = RegisterFile(self.registers)
        self._join(m, "s_axi_ctrl", registers.bus)
        return registers

    def _join(self, m, bus, part):
        """Connect the ports of a bus to those of a part."""
        for name, wire in self.buses[bus].signature.members.items():
            port, inner = getattr(self, f"{bus}_{name}"), getattr(part, name)
            m.d.comb += inner.eq(port) if wire.flow is In else port.eq(inner)

    def _check(self, m, registers, codeword, word_taken):
        """Return the check of code words, which sets bits of ERROR."""
        m.submodules.check = check = CodeWordCheck(self.config)
        values, events = registers.values, registers.events
        m.d.comb += [
            check.codeword.eq(codeword),
            check.taken.eq(word_taken),
            check.last_column.eq(values.last_column_value),
            check.last_line.eq(values.last_line_value),
            events.error_x_outside.eq(check.x_outside),
            events.error_line_past.eq(check.line_past),
        ]
        return check

    def _report_packets(self, m, events, codewords, initial):
        """Set the bits of ERROR for packets that the guards correct."""
        m.d.comb += [
            events.error_frame_ended_early.eq(codewords.early),
            events.error_end_without_last.eq(codewords.late),
            events.error_partial_word.eq(codewords.partial),
            events.error_initial_ended_early.eq(initial.early),
            events.error_initial_without_last.eq(initial.late),
            events.error_initial_partial.eq(initial.partial),
        ]

    def _count(self, m, live, clear, counted):
        """Count the cycles of each event, by its register's name, until CONTROL.CLEAR."""
        for name, event in counted.items():
            counter = Signal(32, name=name)
            m.d.comb += live[f"{name}_value"].eq(counter)
            with m.If(clear):
                m.d.sync += counter.eq(0)
            with m.Elif(event):
                m.d.sync += counter.eq(counter + 1)

    def _codewords(self, m):
        """Return the guard of the code words, behind the port's registers."""
        layout = CodeWordLayout(self.config)
        m.submodules.codeword_slice = slice_ = RegisterSlice(PacketLayout(layout))
        guard = StreamGuard(layout, end_word(self.config), is_end)
        self._enter(m, "s_axis_codewords", slice_)
        connect(m, slice_.o, guard.i)
        return guard

    def _initial(self, m):
        """Return the guard of the initial raster, behind registers at the rate of the loader."""
        layout = RasterLayout(self.config)
        m.submodules.initial_slice = slice_ = HalfSlice(PacketLayout(layout))
        guard = StreamGuard(layout, layout.const({"end": 1}), lambda beat: beat.end)
        self._enter(m, "s_axis_initial", slice_)
        connect(m, slice_.o, guard.i)
        return guard

    def _tables(self, m, registers):
        """Connect table writes to the engine by registers; return whether one is on its way."""
        m.submodules.table_slice = slice_ = HalfSlice(TableWriteLayout(self.config))
        connect(m, registers.tables, slice_.i)
        connect(m, slice_.o, self.engine.tables)
        writing = Signal()
        m.d.comb += writing.eq(registers.tables.valid | slice_.o.valid)
        return writing

    def _loaded(self, m, initial):
        """Connect a guard to the engine by registers; return the beats that the engine takes."""
        m.submodules.loaded_slice = slice_ = HalfSlice(RasterLayout(self.config))
        connect(m, initial.o, slice_.i)
        connect(m, slice_.o, self.engine.initial)
        return slice_.o

    def _drawn(self, m, codewords):
        """Connect a guard to the engine; return whether a code word waited a cycle ago.

        Whether the engine takes a word depends on the window, and is known late in a cycle.
        """
        m.submodules.engine_slice = slice_ = ReverseSlice(CodeWordLayout(self.config))
        connect(m, codewords.o, slice_.i)
        connect(m, slice_.o, self.engine.codewords)
        stalled = Signal()
        m.d.sync += stalled.eq(slice_.o.valid & ~slice_.o.ready)
        return stalled

    def _enter(self, m, port, slice_):
        """Connect a port to its registers; bits of TDATA above a word's are ignored."""
        wires = {
            name: getattr(self, f"{port}_{name}") for name in self.buses[port].signature.members
        }
        word = slice_.i.payload
        m.d.comb += [
            word.data.as_value().eq(wires["tdata"]),
            word.whole.eq(wires["tkeep"].all()),
            word.last.eq(wires["tlast"]),
            slice_.i.valid.eq(wires["tvalid"]),
            wires["tready"].eq(slice_.i.ready),
        ]

    def _picture_members(self):
        """Return the buses and wires of the picture, by name."""
        return {"m_axis_raster": Out(AxiStreamSignature(raster_stream_bytes(self.config)))}

    def _raster(self, m, values, aborting):
        """Connect the engine's beats to their port; of an aborted frame only the end beat.

        Return whether an end beat leaves in this cycle, whether another beat does, and whether one
        waits.
        """
        beat = RasterLayout(self.config)
        m.submodules.raster_slice = slice_ = RegisterSlice(beat)
        raster = self.engine.raster
        dropped = aborting & ~raster.payload.end
        m.d.comb += [
            slice_.i.payload.eq(raster.payload),
            slice_.i.valid.eq(raster.valid & ~dropped),
            raster.ready.eq(slice_.i.ready),
            self.m_axis_raster_tdata.eq(slice_.o.payload),
            self.m_axis_raster_tkeep.eq(~0),
            self.m_axis_raster_tlast.eq(slice_.o.payload.end),
            self.m_axis_raster_tvalid.eq(slice_.o.valid),
            slice_.o.ready.eq(self.m_axis_raster_tready),
        ]
        left = slice_.o.valid & slice_.o.ready
        waits = self.m_axis_raster_tvalid & ~self.m_axis_raster_tready
        return left & slice_.o.payload.end, left & ~slice_.o.payload.end, waits


def _errors(registers, values):
    """Return all bits of ERROR."""
    return Cat(values[f"error_{field.name}".lower()] for field in registers["ERROR"].fields)
