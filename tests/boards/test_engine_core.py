"""The engine's LiteX core."""

import gc
import warnings

import pytest
from amaranth.hdl import UnusedElaboratable

from splatline.contract.presets import PAPER, PLANE, RGB24

pytest.importorskip("litex", reason="pip install '.[board-test]'")

from litedram.common import LiteDRAMNativeWritePort
from litex.build.lattice import LatticeECP5Platform
from migen import Constant, Instance, Module

from splatline.boards import engine_core
from splatline.boards.engine_core import EngineCore
from splatline.rtl.bus.axi_top import AxiTop
from splatline.rtl.framebuffer.top import FrameBufferTop

UNUSED = {
    *("m_axis_raster_tkeep", "m_axi_awid"),
    *(f"m_axi_aw{name}" for name in ("lock", "cache", "prot", "qos")),
}
"""Outputs that nobody may need."""


@pytest.fixture
def platform(tmp_path):
    platform = LatticeECP5Platform("LFE5U-85F-6BG381C", [], toolchain="trellis")
    platform.output_dir = str(tmp_path)
    return platform


def wires_of(core):
    """Return the wires of the engine's instance by the names of its ports."""
    (instance,) = (part for part in core._fragment.specials if isinstance(part, Instance))
    return {
        (type(item).__name__, item.name): item.expr
        for item in instance.items
        if hasattr(item, "expr")
    }


def ports_of(top, *arguments):
    """Return the widths of a top's ports by direction and name, and the bits of an address."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnusedElaboratable)
        made = top(*arguments)
        bits = made.registers.address_bits
        ports = {
            ("Input" if member.flow.name == "In" else "Output", name): member.shape
            for name, member in made.signature.members.items()
        }
        del made
        gc.collect()
    return ports, bits


@pytest.mark.parametrize("config", [PAPER, RGB24, PLANE], ids=lambda config: config.name)
@pytest.mark.parametrize("data_bits", [None, 32, 64])
def test_every_port_is_connected_in_its_direction_and_width(platform, config, data_bits):
    port = data_bits and LiteDRAMNativeWritePort(address_width=24, data_width=data_bits)
    core = EngineCore(platform, config, port, initial=True)
    top = (AxiTop, config) if port is None else (FrameBufferTop, config, data_bits)
    ports, bits = ports_of(*top)
    wires = wires_of(core)
    assert set(wires) <= set(ports)
    assert {name for _, name in set(ports) - set(wires)} <= UNUSED
    for place, wire in wires.items():
        fits = (
            len(wire) <= ports[place] if isinstance(wire, Constant) else len(wire) == ports[place]
        )
        assert fits, place
    assert core.bus_bytes == 1 << bits


def test_without_an_initial_raster_its_port_is_idle(platform):
    wires = wires_of(EngineCore(platform, PAPER))
    assert wires["Input", "s_axis_initial_tvalid"].value == 0


def test_it_writes_its_verilog_and_adds_it(platform, tmp_path, monkeypatch):
    monkeypatch.setattr(
        engine_core, "generate_axi", lambda config, name: (f"module {name} {config.name}", {})
    )
    soc = Module()
    for name, config in ("one", PAPER), ("two", RGB24), ("two", RGB24):
        soc.submodules += EngineCore(platform, config, name=name)
    soc.finalize()
    made = {source: (tmp_path / "gateware" / source).read_text() for source in ("one.v", "two.v")}
    assert made == {"one.v": "module one paper", "two.v": "module two rgb24"}
    assert [path for path, *_ in platform.sources] == [
        str(tmp_path / "gateware" / name) for name in made
    ]


def test_engines_that_differ_need_two_names(platform, monkeypatch):
    monkeypatch.setattr(engine_core, "generate_axi", lambda config, name: (config.name, {}))
    soc = Module()
    soc.submodules += EngineCore(platform, PAPER), EngineCore(platform, RGB24)
    with pytest.raises(ValueError, match="have the name 'splatline'"):
        soc.finalize()
