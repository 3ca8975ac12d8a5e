"""Running one component's Verilog under cocotb."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import simulator

if TYPE_CHECKING:
    from amaranth.lib import data, wiring

__all__ = ["pack", "run_bench"]


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
        What to test; its top module is called ``dut``.
    bench
        Python file with cocotb tests.
    simulator_name
        One of ``simulator.SIMULATORS``.
    test
        One test's name; all if not given.
    edit
        Changes the Verilog first, to show that the tests notice a fault.

    Raises
    ------
    SimulationError
        If a test fails.
    """
    from ...rtl.verilog import convert

    text = convert(component, "dut")
    if edit is not None:
        changed = edit(text)
        if changed == text:
            raise ValueError("the edit found nothing to change")
        text = changed
    built = simulator.build({"dut.v": text}, "dut", simulator=simulator_name)
    simulator.run(built, Path(bench).stem, test=test, module_folder=Path(bench).parent)


def pack(layout: data.Layout, **values: Any) -> int:
    """Return the bits of a layout as an integer: ``pack(layout, x=3, rows=[...])``."""
    return int(layout.const(values).as_value().value)
