"""Finds the memories whose words a mutant renames: an address bit is inverted at every access.

Such a mutant is equal, as a memory does not care which word is where. The proof inverts the bit
once more, at all ports of those memories.
"""

import json
import tempfile
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from splatline.flow.tools import run_yosys

from .mutate import Mutant, prepared
from .tops import Design

__all__ = ["Renaming", "goes_into", "renaming_of"]

ALIGNED = ("$mux", "$dff", "$pmux", "$pos")
"""Cells whose outputs' bits depend on the same bits of their inputs."""

MODES = ("inv", "cnot0", "cnot1")
"""The kinds of mutants that rename: they can be undone."""


@dataclass(frozen=True)
class Renaming:
    """Memories, and what inverts a bit of their addresses once more.

    Parameters
    ----------
    memories
        Names of the cells in the flattened module of the mutant.
    bit, control
        Bit of the address that is inverted, and by which one.
    mode
        Kind of the mutant.
    """

    memories: tuple[str, ...]
    bit: int
    control: int
    mode: str

    def verilog(self, boxes: str) -> str:
        """Return ``memories.v`` for these memories."""
        text = boxes
        for port in ("RD_ADDR", "WR_ADDR"):
            control = f"{port}[n*ABITS+{self.control}]"
            inverts = {"inv": "1'b1", "cnot0": f"!{control}", "cnot1": control}[self.mode]
            before = f"{port}[n*ABITS +: ABITS] :"
            place = (
                f"({port}[n*ABITS +: ABITS] ^ ({{{{ABITS-1{{1'b0}}}}, {inverts}}} << {self.bit})) :"
            )
            if before not in text:
                raise ValueError(f"memories.v has no {before!r}")
            text = text.replace(before, place)
        return text


@cache
def _netlist(design: Design, module: str) -> dict:
    """Return a flattened module of a design as Yosys' JSON has it."""
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "prepared.il").write_bytes(prepared(design).read_bytes())
        script = (
            "read_rtlil prepared.il\nhierarchy -top {}\nflatten\nopt_clean\nwrite_json flat.json"
        )
        run_yosys(script.format(module), folder)
        return json.loads((folder / "flat.json").read_text())["modules"][module]


@cache
def _readers(design: Design, module: str) -> dict:
    """Return by bit the cells, ports and positions that it goes into."""
    readers = defaultdict(list)
    for name, cell in _netlist(design, module)["cells"].items():
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] == "input":
                for position, bit in enumerate(bits):
                    readers[bit].append((name, port, position))
    return readers


def goes_into(design: Design, module: str, signal: str) -> set[tuple[str, str]]:
    """Return the registers' and memories' cells and ports that a signal comes to within a cycle.

    An output of the module is a port of no cell.
    """
    netlist = _netlist(design, module)
    cells, bits = netlist["cells"], list(netlist["netnames"][signal]["bits"])
    leaves = {bit: name for name, port in netlist["ports"].items() for bit in port["bits"]}
    seen, found = set(bits), set()
    while bits:
        bit = bits.pop()
        if bit in leaves:
            found.add(("", leaves[bit]))
        for name, port, _ in _readers(design, module)[bit]:
            if cells[name]["type"] in ("$dff", "$mem_v2"):
                found.add((name, port))
                continue
            ways = cells[name]["port_directions"]
            for other, outputs in cells[name]["connections"].items():
                reached = set(outputs) - seen if ways[other] == "output" else set()
                bits += reached
                seen |= reached
    return found


def renaming_of(design: Design, mutant: Mutant) -> Renaming | None:
    """Return what a mutant may rename: the memories with addresses that its bit comes to."""
    if mutant.mode not in MODES:
        return None
    cells = _netlist(design, mutant.module)["cells"]
    bits = _bits_at(design, mutant, cells)
    seen, found = set(bits), {}
    own = cells.get(mutant.cell, {"port_directions": {}})["port_directions"]
    part = "" if mutant.port in own else mutant.cell
    while bits:
        for name, port, position in _readers(design, mutant.module)[bits.pop()]:
            cell = cells[name]
            if part and not name.removeprefix("$flatten\\").startswith(f"{part}."):
                continue  # the port of a part is mutated, and not what comes to it
            if cell["type"] == "$mem_v2":
                if port.endswith("_ADDR"):
                    width = int(cell["parameters"]["ABITS"], 2)
                    found.setdefault(name, (position % width, width))
                continue
            for other, outputs in cell["connections"].items():
                if cell["port_directions"][other] == "output":
                    size = len(outputs)
                    aligned = cell["type"] in ALIGNED and port not in ("S", "CLK")
                    reached = [outputs[position % size]] if aligned else outputs
                    bits += [bit for bit in reached if bit not in seen]
                    seen.update(reached)
    if len({*found.values()}) != 1:
        return None
    ((bit, width),), memories = {*found.values()}, tuple(sorted(found))
    if mutant.ctrlbit is None:
        return Renaming(memories, bit, 0, mutant.mode)
    control = bit + mutant.ctrlbit - mutant.portbit
    return Renaming(memories, bit, control, mutant.mode) if 0 <= control < width else None


def _bits_at(design: Design, mutant: Mutant, cells: dict) -> list:
    """Return the bits whose change is the mutant."""
    cell = cells.get(mutant.cell, {"port_directions": {}})
    if mutant.port in cell["port_directions"]:
        if cell["port_directions"][mutant.port] == "output":
            return [cell["connections"][mutant.port][mutant.portbit]]
        size = len(cell["connections"].get("Y", cell["connections"].get("Q", [])))
        if cell["type"] in ALIGNED and mutant.port != "S" and size:
            output = "Y" if "Y" in cell["connections"] else "Q"
            return [cell["connections"][output][mutant.portbit % size]]
        return []
    # A port of a part, which was flattened: the wire has its name.
    names = _netlist(design, mutant.module)["netnames"]
    wire = names.get(f"{mutant.cell}.{mutant.port}")
    return [wire["bits"][mutant.portbit]] if wire else []
