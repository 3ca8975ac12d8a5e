"""Planted faults in the guards, the register file and the top: the cases must notice them."""

import functools

import pytest

from splatline.contract.presets import PAPER
from splatline.flow.verilog import convert
from splatline.host.device.device import DeviceLostError, DeviceTimeoutError
from splatline.host.device.driver import EngineError
from splatline.rtl.bus.axi_registers import RegisterFile
from splatline.rtl.bus.axi_stream import RegisterSlice, ReverseSlice
from splatline.rtl.bus.axi_top import AxiTop
from splatline.rtl.bus.stream_guard import StreamGuard
from splatline.sim.cosim import simulator
from splatline.sim.cosim.axi.axi_device import SimulatedDevice
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl.bus import axi_cases
from tests.rtl.bus.axi_abort_cases import ABORTS
from tests.rtl.bus.axi_bus_cases import BUS
from tests.rtl.bus.axi_cases import STREAMS
from tests.support.faults import switched
from tests.support.planted import plant

pytestmark = pytest.mark.planted

NOTICED = (
    *(AssertionError, DeviceLostError, DeviceTimeoutError, EngineError),
    *(SimulationError, ValueError),
)

SIGNALS = [
    (STREAMS, "an_end_word_without_last", "codewords", "dropped", "1'h0", "never done dropping"),
    (ABORTS, "in_the_middle_of_the_code_words", "codewords", "cut", "1'h0", "no end by an abort"),
    (STREAMS, "an_element_in_the_last_column", "check", "x_outside", "element", "all is outside"),
    (BUS, "writes_of_some_bytes", "registers", "whole", "1'h1", "strobes are not looked at"),
    (BUS, "tables_written_in_mid_frame", None, "busy", "1'h0", "tables change in mid-frame"),
]

PARTS = [
    (
        *(STREAMS, "a_frame_that_ends_early", StreamGuard, "elaborate"),
        *(r"\(word\.last \| cut\)", "cut", "no end is put in"),
    ),
    (
        *(STREAMS, "partial_words", StreamGuard, "elaborate"),
        *(r"\(passing & word\.whole\)", "passing", "partial words are drawn"),
    ),
    (
        *(BUS, "nothing_at_an_address", RegisterFile, "_store"),
        *(r" & ~bits\)", ")", "a bit of ERROR stays"),
    ),
    (
        *(BUS, "bits_that_a_register_lacks", RegisterFile, "_write"),
        *(r" & ~extra\.any\(\)\)", ")", "bits are not looked at"),
    ),
    (
        *(BUS, "an_interrupt_is_acknowledged_with_what_was_read", RegisterFile, "_write"),
        *(r"~register\.accepted", "~register.writable", "an acknowledge is refused"),
    ),
    (
        *(BUS, "nothing_passes_within_a_cycle", AxiTop, "_interrupt"),
        *(r"irq\.eq\(irq\)", "irq.eq(irq ^ self.s_axi_ctrl_awprot[0])", "a path across the chip"),
    ),
    (
        *(BUS, "a_frame_is_open_behind_others_that_wait", AxiTop, "elaborate"),
        *(r"~drawing & ~values", "~values", "two frames are open at once"),
    ),
    (
        *(ABORTS, "before_the_engine_has_a_word", AxiTop, "elaborate"),
        *(r"aborting & loading & ~released", "abort & loading", "an abort that comes too soon"),
    ),
    (
        *(ABORTS, "in_any_of_its_last_cycles", AxiTop, "elaborate"),
        *(r"busy & ~end_taken\)", "busy)", "an abort that comes too late"),
    ),
    (
        *(ABORTS, "while_the_raster_waits", AxiTop, "_raster"),
        *(r"aborting & ~raster", "0 & ~raster", "beats of an aborted frame"),
    ),
    (
        *(STREAMS, "any_packets_at_all", RegisterSlice, "elaborate"),
        *(r"with m\.If\(~spare\)", "with m.If(1)", "the word that waits is lost"),
    ),
    (
        *(STREAMS, "any_packets_at_all", ReverseSlice, "elaborate"),
        *(r"with m\.If\(~full\)", "with m.If(1)", "the word that the engine left is lost"),
    ),
]


FAULTS = [*PARTS, *SIGNALS]
"""In the order of their numbers: a row begins with the case that must notice it."""


@functools.cache
def built():
    """A build with all faults. Icarus builds it sooner, and takes longer for each of them."""
    with pytest.MonkeyPatch.context() as patch:
        edit = plant(patch, [row[2:6] for row in PARTS])
        text = edit(convert(AxiTop(PAPER), "splatline"))
    signals = [
        ("splatline" if part is None else f"splatline.{part}", signal, value)
        for _, _, part, signal, value, _ in SIGNALS
    ]
    text = switched("splatline", signals, first=1 + len(PARTS))(text)
    return simulator.build({"splatline.v": text}, "splatline")


def device_with(number):
    """A device with the fault of that number, or without one."""
    return SimulatedDevice(PAPER, limit=2500, built=built(), plusargs=[f"+fault={number}"])


def play(device, table, name):
    axi_cases.fresh(device)
    if table is STREAMS:
        device.command("stall", 0.3, 1)
    table[name](device)
    assert device.command("rules") == []


@pytest.mark.parametrize(
    ("number", "table", "name"),
    [pytest.param(n, *row[:2], id=row[-1]) for n, row in enumerate(FAULTS, 1)],
)
def test_a_fault_is_noticed(number, table, name):
    with device_with(number) as device, pytest.raises(NOTICED):
        play(device, table, name)


def test_without_a_fault_nothing_is_noticed():
    """By the cases of the buses, which meet undefined wires in Icarus, and one of the streams."""
    with device_with(0) as device:
        play(device, STREAMS, "partial_words")
        for table, name, *_ in FAULTS:
            if table is BUS:
                play(device, table, name)
