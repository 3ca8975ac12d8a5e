"""A floorplan: where the block RAMs of a window's lanes lie on an ECP5.

A lane reads its block RAM, compares depths and writes, all in one cycle, so the clock depends on
the wires between the block RAM and its comparison. nextpnr's placer puts some block RAMs far from
their comparison. Where their places are given, the placer brings the logic to them (decision 0112).
"""

import itertools
import re
from collections.abc import Iterable, Mapping

from .ecp5 import Device

__all__ = ["floorplan", "floorplan_script"]

_LANE = re.compile(
    r"\b(lane_(?P<line>\d+)_(?P<column>\d+)\.ram\.(?P<memory>.+)"
    r"|row_(?P<row>\d+)\.(?P<half>(even|odd)_(?P<place>\d+)\..+))$"
)
"""The end of a block RAM's name, of tiles and of blocks."""

_SHARED = re.compile(r"\b(readout\.queue\.fifo\.storage|colour\.table_\.ram)(\.\d+)+$")
"""The same of those that all lanes send to, and of the material table."""

_MIDDLE, _BELOW, _ABOVE = range(3)
"""Rows of block RAMs about the middle of a device, by their place in ``Device.rows``."""


def floorplan(cells: Iterable[str], device: Device) -> dict[str, str]:
    """Return the site of each block RAM of a lane.

    Lanes of one column are neighbours, as a flushed word takes a pixel of one of them. Columns
    follow each other from the left, in as few rows of block RAMs as hold them, each with as many
    lanes.

    Of an engine with blocks the block RAMs that all lanes send to lie in the middle of the device.
    In their row columns lie on both sides of them, and the other columns above and below.

    Parameters
    ----------
    cells
        Names of a netlist's block RAMs. Others than the engine's are left to the placer.
    device
        The device, with enough block RAMs.

    Returns
    -------
    dict
        Site by name of the cell, in the format of nextpnr's attribute ``BEL``.
    """
    cells = list(cells)
    found = [(_LANE.search(cell), cell) for cell in cells]
    lanes = sorted((*_place(m), cell) for m, cell in found if m)
    if not lanes:
        return {}
    if any(m and m["row"] for m, _ in found):
        return _about_the_middle(lanes, [cell for cell in cells if _SHARED.search(cell)], device)
    rows = -(-len(lanes) // device.row_length)
    each = -(-len(lanes) // rows)
    return {cell: device.site(*divmod(n, each)) for n, (*_, cell) in enumerate(lanes)}


def _about_the_middle(
    lanes: list[tuple[int, int, str, str]], shared: list[str], device: Device
) -> dict[str, str]:
    """Return the sites of an engine with blocks; its lanes are sorted by column."""
    columns = [
        [cell for *_, cell in column] for _, column in itertools.groupby(lanes, key=lambda n: n[0])
    ]
    size = len(columns[0])
    beside = (device.row_length - len(shared)) // size // 2  # columns on either side
    apart = (len(columns) - 2 * beside) // 2  # columns above, at most as many as below
    above, left, right, below = (
        list(itertools.chain(*columns[first:last]))
        for first, last in itertools.pairwise(
            (0, apart, apart + beside, apart + 2 * beside, len(columns))
        )
    )
    middle = (device.row_length - len(shared)) // 2
    parts = [
        (_ABOVE, (device.row_length - len(above)) // 2, above),
        (_MIDDLE, middle - len(left), left),
        (_MIDDLE, middle, sorted(shared, key=lambda cell: (len(cell), cell))),
        (_MIDDLE, middle + len(shared), right),
        (_BELOW, (device.row_length - len(below)) // 2, below),
    ]
    return {
        cell: device.site(row, first + n)
        for row, first, part in parts
        for n, cell in enumerate(part)
    }


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
        match = _LANE.search(cell) or _SHARED.search(cell)
        end = match[0] if match else cell
        lines.append(f'setattr -set BEL "{site}" c:*{end}')
    return "\n".join([*lines, ""])
