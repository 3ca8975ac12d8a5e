"""The frame buffer top against golden, and its description."""

import pytest

from splatline.contract.presets import PAPER
from splatline.flow.axi_verilog import generate_axi
from splatline.flow.framebuffer_verilog import generate_framebuffer
from splatline.rtl.framebuffer.top import FrameBufferTop
from tests.rtl.framebuffer import top_bench
from tests.support.bench_config import run_bench


def test_pictures_in_memory_are_golden_s():
    run_bench(PAPER, FrameBufferTop, top_bench.__file__)


@pytest.mark.parametrize("data_bits", [32])
def test_its_ports_are_those_of_the_axi_top_and_of_the_writer(data_bits):
    text, described = generate_framebuffer(PAPER, "screen", data_bits=data_bits)
    _, axi = generate_axi(PAPER, "screen")
    ports = {port["name"]: (port["direction"], port["width"]) for port in described["ports"]}
    before = {port["name"]: (port["direction"], port["width"]) for port in axi["ports"]}
    kept = {name: port for name, port in before.items() if not name.startswith("m_axis_raster")}
    assert kept.items() <= ports.items()
    added = {name: port for name, port in ports.items() if name not in kept}
    wires = {name: port for name, port in added.items() if not name.startswith("m_axi_")}
    assert wires == {
        "buffer_0": ("input", 32),
        "buffer_1": ("input", 32),
        "stride": ("input", 16),
        "background": ("input", 24),
        "swap_valid": ("output", 1),
        "swap_index": ("output", 1),
        "swapped": ("input", 1),
        "writer_error": ("output", 1),
    }
    assert added["m_axi_wdata"] == ("output", data_bits)
    assert added["m_axi_wstrb"] == ("output", data_bits // 8)
    assert added["m_axi_awready"] == ("input", 1)
    assert described["framebuffer"] == {"data_bits": data_bits, "burst": 64, "outstanding": 8}
    assert described["registers"] == axi["registers"]
    assert text.startswith("// Splatline ")
    assert all(port["meaning"] for port in described["ports"])
