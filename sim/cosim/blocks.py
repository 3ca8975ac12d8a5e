"""Simulation of a single component's Verilog with cocotb tests."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from amaranth.hdl import Shape
from amaranth.lib import data, wiring

from . import simulator

__all__ = ["pack", "run_bench", "unpack"]


def run_bench(
    component: wiring.Component,
    bench: str | Path,
    *,
    simulator_name: str = "verilator",
    test: str | None = None,
    edit: Callable[[str], str] | None = None,
) -> None:
    """Run the cocotb tests of a file on a component's Verilog.

    Parameters
    ----------
    component
        Component under test; its top module is called ``dut``.
    bench
        Python file with cocotb tests.
    simulator_name
        One of ``simulator.SIMULATORS``.
    test
        Name of one test; all tests if not given.
    edit
        Function that plants a fault in the Verilog, which the tests must then notice.

    Raises
    ------
    SimulationError
        If a test fails.
    """
    from splatline.flow.verilog import convert

    text = convert(component, "dut")
    if edit is not None:
        changed = edit(text)
        if changed == text:
            raise ValueError("the edit found nothing to change")
        text = changed
    built = simulator.build({"dut.v": text}, "dut", simulator=simulator_name)
    simulator.run(built, Path(bench), test=test)


def pack(layout: data.Layout, **values: Any) -> int:
    """Return the bits of a layout as an integer: ``pack(layout, x=3, rows=[...])``."""
    return _codec(layout)[0](values)


def unpack(layout: data.Layout, bits: int) -> Any:
    """Return the values of a layout's bits: namespaces for structs, lists for arrays, numbers."""
    return _codec(layout)[1](bits)


_CODECS: dict[int, tuple[Callable[[Any], int], Callable[[int], Any], data.Layout]] = {}
"""Packers and unpackers by the layout's ``id``; the layout is kept, so that its id stays unique."""


def _codec(layout: data.Layout) -> tuple[Callable[[Any], int], Callable[[int], Any], data.Layout]:
    """Return the functions that pack and unpack a layout.

    They replace Amaranth's ``const`` and ``from_bits``, which look up every field in every call and
    take longer than the simulation.
    """
    if id(layout) not in _CODECS:
        _CODECS[id(layout)] = _packer(layout), _unpacker(layout), layout
    return _CODECS[id(layout)]


def _packer(shape: Any) -> Callable[[Any], int]:
    """Return a function from a number, or a dict or list of a layout's numbers, to its bits."""
    if not isinstance(shape, data.Layout):
        mask = (1 << Shape.cast(shape).width) - 1
        return lambda value: int(value) & mask
    fields = {name: (field.offset, _packer(field.shape)) for name, field in shape}

    def join(values: Any) -> int:
        bits = 0
        for name, value in values.items() if isinstance(values, dict) else enumerate(values):
            offset, make = fields[name]
            bits |= make(value) << offset
        return bits

    return join


def _unpacker(shape: Any) -> Callable[[int], Any]:
    """Return a function from bits to a number, or to a layout's numbers."""
    if not isinstance(shape, data.Layout):
        cast = Shape.cast(shape)
        mask, sign = (1 << cast.width) - 1, 1 << cast.width - 1 if cast.signed else 0
        return lambda bits: ((bits & mask) ^ sign) - sign
    fields = [(name, field.offset, _unpacker(field.shape)) for name, field in shape]
    if isinstance(shape, data.ArrayLayout):
        return lambda bits: [read(bits >> offset) for _, offset, read in fields]
    return lambda bits: SimpleNamespace(**{name: read(bits >> at) for name, at, read in fields})
