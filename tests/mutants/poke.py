"""Counters that can be set: what they do after hours is seen in a frame.

The registers of the AXI top count up to 2^32. A port of the mutated design, which its Verilog does
not have, sets all counters at once. So the benches see carries into the highest bits.
"""

import re

from splatline.contract.register_map import COUNTERS

__all__ = ["POKED", "add_pokes"]

POKED = tuple(name.lower() for name in COUNTERS)
"""Names of the counters."""

MODULE = "module \\splatline\n"
WIRES = (
    "  wire input 901 \\poke\n  wire width 32 input 902 \\poke_value\n"
    "  wire output 903 \\poke_ready\n"
)
READY = "\n  connect \\poke_ready 1'1\n"

MUX = """\
  cell $mux \\poke_{name}
    parameter \\WIDTH 32
    connect \\A {before}
    connect \\B \\poke_value
    connect \\S \\poke
    connect \\Y \\poked_{name}
  end
"""


def add_pokes(mutated: str, prepared: str) -> str:
    """Return the RTLIL of a mutated AXI top with the ports ``poke`` and ``poke_value``.

    Parameters
    ----------
    mutated
        RTLIL of all modules.
    prepared
        The same without mutants: there a counter is the output of its register.
    """
    before, top, after = _split(mutated)
    wires, cells = WIRES, ""
    for name in POKED:
        cell = _register(_split(prepared)[1], name)
        block = re.search(rf"  cell \$dff {re.escape(cell)}\n(?:    .*\n)*  end\n", top)[0]
        data = re.search(r"    connect \\D (.*)\n", block)
        poked = block.replace(data[0], f"    connect \\D \\poked_{name}\n")
        top = top.replace(block, poked)
        wires += f"  wire width 32 \\poked_{name}\n"
        cells += MUX.format(name=name, before=data[1])
    body = top.removeprefix(MODULE)
    return before + MODULE + wires + body + "\n" + cells.rstrip("\n") + READY.rstrip("\n") + after


def _split(text: str) -> tuple[str, str, str]:
    """Return what is before the top module, the module, and what is after it."""
    begin = text.index(MODULE)
    end = text.index("\nend\n", begin)
    return text[:begin], text[begin:end], text[end:]


def _register(top: str, name: str) -> str:
    """Return the cell whose output is a counter."""
    for cell, block in re.findall(r"  cell \$dff (\S+)\n((?:    .*\n)*)  end\n", top):
        if f"    connect \\Q \\{name}\n" in block:
            return cell
    raise ValueError(f"no register holds {name}")
