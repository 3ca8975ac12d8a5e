"""Planted faults in what differs on AXI with planes: the cases of streams must notice them."""

import functools

import pytest

from splatline.contract.presets import PLANE
from splatline.flow.verilog import convert
from splatline.rtl.bus.axi_top import AxiTop
from splatline.rtl.bus.codeword_check import CodeWordCheck
from splatline.sim.cosim import simulator
from splatline.sim.cosim.axi.axi_device import SimulatedDevice
from tests.rtl.bus.axi_cases import STREAMS
from tests.rtl.bus.test_axi_faults import NOTICED, play
from tests.support.planted import plant

pytestmark = pytest.mark.planted

FAULTS = {
    "the high half is lost": (
        *("a_frame_that_ends_early", AxiTop, "_enter"),
        *(r'wires\["tdata"\]', 'wires["tdata"][:64]'),
    ),
    "bytes of the padding may be missing": (
        *("partial_words", AxiTop, "_enter"),
        *(r'wires\["tkeep"\]\.all', 'wires["tkeep"][:12].all'),
    ),
    "bits without a meaning count": (
        *("steps_past_the_frame", CodeWordCheck, "elaborate"),
        *(
            r"is_control\(self\.codeword\)",
            "is_control(self.codeword) & ~self.codeword.sides.any()",
        ),
    ),
    "a depth is a column": (
        *("an_element_beyond_the_last_column", CodeWordCheck, "elaborate"),
        *(r"x\.eq\(self\.codeword\.x\)", "x.eq(self.codeword.z)"),
    ),
}


@functools.cache
def built():
    """A build with all faults. Icarus builds it sooner, and takes longer for each of them."""
    with pytest.MonkeyPatch.context() as patch:
        edit = plant(patch, [row[1:] for row in FAULTS.values()])
        text = edit(convert(AxiTop(PLANE), "splatline"))
    return simulator.build({"splatline.v": text}, "splatline")


def device_with(number):
    """A device with the fault of that number, or without one."""
    return SimulatedDevice(PLANE, limit=2500, built=built(), plusargs=[f"+fault={number}"])


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_noticed(name):
    number = list(FAULTS).index(name) + 1
    with device_with(number) as device, pytest.raises(NOTICED):
        play(device, STREAMS, FAULTS[name][0])


def test_without_a_fault_nothing_is_noticed():
    with device_with(0) as device:
        for case, *_ in FAULTS.values():
            play(device, STREAMS, case)
