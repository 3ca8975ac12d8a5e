"""A floorplan: where the block RAMs of a window's lanes lie on an ECP5.

A lane reads its block RAM, compares depths and writes, all in one cycle, so the clock depends on
the wires between the block RAM and its comparison. nextpnr's placer puts some block RAMs far from
their comparison. Where their places are given, the placer brings the logic to them (decision 0112).
"""

import re
from collections.abc import Iterable, Mapping

from .ecp5 import Device

__all__ = ["floorplan", "floorplan_script"]

_LANE = re.compile(r"\blane_(\d+)_(\d+)\.ram\.(.+)$")


def floorplan(cells: Iterable[str], device: Device) -> dict[str, str]:
    """Return the site of each block RAM of a lane.

    Lanes of one column are neighbours, as a flushed word takes a pixel of one of them. Columns
    follow each other from the left, in as few rows of block RAMs as hold them, each with as many
    lanes.

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
    lanes = sorted((int(m[2]), int(m[1]), m[3], cell) for m, cell in found if m)
    if not lanes:
        return {}
    rows = -(-len(lanes) // device.row_length)
    each = -(-len(lanes) // rows)
    return {cell: device.site(*divmod(n, each)) for n, (*_, cell) in enumerate(lanes)}


def floorplan_script(sites: Mapping[str, str], device: Device) -> str:
    """Return a device's floorplan as a Yosys script, for designs that contain the engine.

    It is run after ``synth_ecp5`` with a flat design. It finds the cells by the end of their names.
    """
    lines = [
        f"# Block RAMs of Splatline's lanes on an {device.name[:9]}: run this after synth_ecp5."
    ]
    for cell, site in sites.items():
        end = cell[cell.rindex("lane_") :]
        lines.append(f'setattr -set BEL "{site}" c:*{end}')
    return "\n".join([*lines, ""])
