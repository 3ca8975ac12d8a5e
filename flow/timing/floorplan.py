"""A floorplan: where the block RAMs of a window's lanes lie on an ECP5.

A lane reads its block RAM, compares depths and writes, all in one cycle, so the clock depends on
the wires between the block RAM and its comparison. nextpnr's placer puts some block RAMs far from
their comparison. Where their places are given, the placer brings the logic to them (decision 0112).
"""

import re
from collections.abc import Iterable, Mapping

from .ecp5 import Device

__all__ = ["floorplan", "floorplan_script"]

_LANE = re.compile(
    r"\b(lane_(?P<line>\d+)_(?P<column>\d+)\.ram\.(?P<memory>.+)"
    r"|row_(?P<row>\d+)\.(?P<half>(even|odd)_(?P<place>\d+)\..+))$"
)
"""The end of a block RAM's name, of tiles and of blocks."""


def floorplan(cells: Iterable[str], device: Device) -> dict[str, str]:
    """Return the site of each block RAM of a lane.

    Lanes of one column are neighbours, as a flushed word takes a pixel of one of them. Columns
    follow each other from the left, in as few rows of block RAMs as hold them, each with as many
    lanes. Of an engine with blocks, whose columns have as many lanes as there are lines, all lanes
    of a column are in one row.

    Parameters
    ----------
    cells
        Names of a netlist's block RAMs. Others than those of lanes are left to the placer.
    device
        The device, with enough block RAMs.

    Returns
    -------
    dict
        Site by name of the cell, in the format of nextpnr's attribute ``BEL``.
    """
    found = [(_LANE.search(cell), cell) for cell in cells]
    lanes = sorted((*_place(m), cell) for m, cell in found if m)
    if not lanes:
        return {}
    rows = -(-len(lanes) // device.row_length)
    each = -(-len(lanes) // rows)
    if any(m and m["row"] for m, _ in found):
        size = sum(column == 0 for column, *_ in lanes)
        each = device.row_length // size * size
    return {cell: device.site(*divmod(n, each)) for n, (*_, cell) in enumerate(lanes)}


def _place(match: re.Match[str]) -> tuple[int, int, str]:
    """Return column and line of a block RAM's lane, and which of the lane's it is."""
    if match["row"]:
        return int(match["place"]), int(match["row"]), match["half"]
    return int(match["column"]), int(match["line"]), match["memory"]


def floorplan_script(sites: Mapping[str, str], device: Device) -> str:
    """Return a device's floorplan as a Yosys script, for designs that contain the engine.

    It is run after ``synth_ecp5`` with a flat design. It finds the cells by the end of their names.
    """
    lines = [
        f"# Block RAMs of Splatline's lanes on an {device.name[:9]}: run this after synth_ecp5."
    ]
    for cell, site in sites.items():
        match = _LANE.search(cell)
        end = match[0] if match else cell
        lines.append(f'setattr -set BEL "{site}" c:*{end}')
    return "\n".join([*lines, ""])
