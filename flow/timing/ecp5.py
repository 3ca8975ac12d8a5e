"""Lattice ECP5 devices: their block RAMs and where these lie."""

from typing import NamedTuple

from splatline.flow.tools import ToolError

__all__ = ["DEVICES", "Device", "choose"]


class Device(NamedTuple):
    """An ECP5 in the package CABGA381, of the slowest speed grade.

    Parameters
    ----------
    name, option
        Its name, and nextpnr's option for it.
    rows
        Rows of the chip that have block RAMs, those about its middle first.
    groups
        First columns of groups of four block RAMs, which are two columns apart. Rows are alike.
    """

    name: str
    option: str
    rows: tuple[int, ...]
    groups: tuple[int, ...]

    @property
    def row_length(self) -> int:
        """Block RAMs of a row."""
        return 4 * len(self.groups)

    @property
    def block_rams(self) -> int:
        """Block RAMs of 18 kbit."""
        return len(self.rows) * self.row_length

    def site(self, row: int, place: int) -> str:
        """Return nextpnr's name of a block RAM: of a row of ``rows``, counted from the left."""
        group, within = divmod(place, 4)
        return f"X{self.groups[group] + 2 * within}/Y{self.rows[row]}/EBR{within}"


DEVICES = (
    Device("LFE5U-25F-6BG381", "--25k", (25, 37), (4, 13, 22, 33, 42, 51, 60)),
    Device("LFE5U-45F-6BG381", "--45k", (34, 58, 10), (4, 13, 22, 31, 42, 51, 60, 69, 78)),
    Device(
        "LFE5U-85F-6BG381",
        "--85k",
        (46, 70, 22, 82),
        (4, 13, 22, 31, 40, 49, 58, 69, 78, 87, 96, 105, 114),
    ),
)
"""Devices with 24, 44 and 84 thousand LUTs. Sites are those that nextpnr 0.11.1 fills with block
RAMs until there are no more."""


def choose(block_rams: int, name: str | None = None) -> Device:
    """Return the smallest device with so many block RAMs, or that of a name such as ``LFE5U-25F``.

    Raises
    ------
    ToolError
        If it has too few block RAMs, or the largest has.
    """
    found = [device for device in DEVICES if name is None or device.name.startswith(name)]
    for device in found:
        if device.block_rams >= block_rams:
            return device
    most = found[-1]
    which = "the largest ECP5" if name is None else most.name
    raise ToolError(f"the engine needs {block_rams} block RAMs, and {which} has {most.block_rams}")
