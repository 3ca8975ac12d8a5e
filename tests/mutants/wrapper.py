"""A module around a module of a design, which stands between it and the outside."""

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

__all__ = ["Port", "ports_of", "wrap"]

PORT = re.compile(r"  wire (?:width (\d+) )?(input|output) \d+ (?:signed )?\\(\S+)")


class Port(NamedTuple):
    """A port of a module: its name, ``input`` or ``output``, and its bits."""

    name: str
    way: str
    size: int


def ports_of(il: str, module: str) -> list[Port]:
    """Return the ports of a module in an RTLIL text."""
    body = il[il.index(f"module \\{module}\n") :]
    found = PORT.findall(body[: body.index("\nend\n")])
    return [Port(name, way, int(size or 1)) for size, way, name in found]


def wrap(
    module: str, ports: Iterable[Port], inside: Mapping[str, str], lines: Iterable[str], cell: str
) -> str:
    """Return the Verilog of ``whole``, which has the ports of a module and the module as a cell.

    Parameters
    ----------
    module, ports
        The module and its ports.
    inside
        By name of a port, what it is connected to, if not the port of the same name.
    lines
        What stands between.
    cell
        Name of the cell.
    """
    declared = ", ".join(f"{port.way} [{port.size - 1}:0] {port.name}" for port in ports)
    links = ", ".join(f".{port.name}({inside.get(port.name, port.name)})" for port in ports)
    body = "\n".join(lines)
    return f"module whole({declared});\n{body}\n{module} {cell}({links});\nendmodule\n"
