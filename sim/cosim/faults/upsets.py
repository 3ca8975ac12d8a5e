"""Single-event upsets: Verilog in which any bit of state can be flipped between two clock edges.

Yosys' Verilog has a register or a memory for each name that a clocked block assigns with ``<=``.
Each module gets a block that inverts a bit of one of them at the edge of ``upset``, a further input
of the top module. The clock's own blocks stay as they are.
"""

from __future__ import annotations

import re
from typing import NamedTuple

__all__ = ["Register", "with_upsets"]

MODULE = re.compile(
    r"^module (?P<name>\w+)\((?P<ports>[^;]*)\);\n(?P<body>.*?)^endmodule", re.M | re.S
)
ASSIGNED = re.compile(r"^ +(\w+)(?:\[.*\])? <= ", re.M)
DECLARED = r"^ +(?:output )?reg (?:\[(\d+):0\] )?{name}(?: \[(\d+):0\])?(?: = [^;]*)?;"
INPUTS = {"upset": "", "upset_register": "[15:0] ", "upset_bit": "[15:0] ", "upset_row": "[15:0] "}
"""Further inputs of the top module, with their ranges."""


class Register(NamedTuple):
    """A register or a memory; its number is its place in the list.

    Parameters
    ----------
    module
        Name of the module, which is instantiated once.
    name
        Name in the module.
    bits
        Of a row.
    rows
        1 of a register.
    """

    module: str
    name: str
    bits: int
    rows: int


def with_upsets(text: str, top: str = "splatline") -> tuple[str, list[Register]]:
    """Return Verilog of ``splatline.flow.verilog.convert`` with upsets, and all of its state."""
    state: list[Register] = []

    def extend(found: re.Match[str]) -> str:
        module, ports, body = found["name"], found["ports"], found["body"]
        cases = []
        for name in dict.fromkeys(ASSIGNED.findall(body)):
            declared = re.search(DECLARED.format(name=re.escape(name)), body, re.M)
            if declared is None:
                raise ValueError(f"{module}.{name} is assigned, but is no register")
            high, last_row = declared[1], declared[2]
            bits, rows = int(high or 0) + 1, int(last_row or 0) + 1
            place = f"[{top}.upset_row]" * (last_row is not None)
            place += f"[{top}.upset_bit]" * (high is not None)
            cases.append(f"      {len(state)}: {name}{place} <= ~{name}{place};\n")
            state.append(Register(module, name, bits, rows))
        if module == top:
            ports = ", ".join([ports, *INPUTS])
            body = "".join(f"  input {size}{name};\n" for name, size in INPUTS.items()) + body
        if cases:
            body += f"  always @(posedge {top}.upset)\n    case ({top}.upset_register)\n"
            body += "".join(cases) + "    endcase\n"
        return f"module {module}({ports});\n{body}endmodule"

    return MODULE.sub(extend, text), state
