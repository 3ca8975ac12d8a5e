"""Renames the wires, cells and modules of Amaranth's RTLIL to plain identifiers.

Amaranth gives unnamed signals a ``$`` and a number, and its module names have dots. Some tools
accept neither. ``$7`` becomes ``_7_`` here. Wires of no bits are removed.
"""

from __future__ import annotations

import re

__all__ = ["KEYWORDS", "is_identifier", "tidy"]

_WORDS = (
    "always and assign automatic begin buf bufif0 bufif1 case casex casez cell cmos config deassign"
    " default defparam design disable edge else end endcase endconfig endfunction endgenerate"
    " endmodule endprimitive endspecify endtable endtask event for force forever fork function"
    " generate genvar highz0 highz1 if ifnone incdir include initial inout input instance integer"
    " join large liblist library localparam macromodule medium module nand negedge nmos nor"
    " noshowcancelled not notif0 notif1 or output parameter pmos posedge primitive pull0 pull1"
    " pulldown pullup pulsestyle_onevent pulsestyle_ondetect rcmos real realtime reg release repeat"
    " rnmos rpmos rtran rtranif0 rtranif1 scalared showcancelled signed small specify specparam"
    " strong0 strong1 supply0 supply1 table task time tran tranif0 tranif1 tri tri0 tri1 triand"
    " trior trireg unsigned use uwire vectored wait wand weak0 weak1 while wire wor xnor xor"
    " alias always_comb always_ff always_latch assert assume before bind bins binsof bit break byte"
    " chandle class clocking const constraint context continue cover covergroup coverpoint cross"
    " dist do endclass endclocking endgroup endinterface endpackage endprogram endproperty"
    " endsequence enum expect export extends extern final first_match foreach forkjoin iff"
    " ignore_bins illegal_bins import inside int interface intersect join_any join_none local logic"
    " longint matches modport new null package packed priority program property protected pure rand"
    " randc randcase randsequence ref return sequence shortint shortreal solve static string struct"
    " super tagged this throughout timeprecision timeunit type typedef union unique var virtual"
    " void wait_order wildcard with within"
)

KEYWORDS = frozenset(_WORDS.split())
"""Keywords of Verilog and SystemVerilog."""

MODULE = re.compile(r"^module \\(\S+)\n(.*?)^end\n", re.MULTILINE | re.DOTALL)
WIRE = re.compile(r"^  wire width (\d+)(?: (input|output) \d+)?.* (\S+)$", re.MULTILINE)
CELL = re.compile(r"^  cell (\S+) (\S+)\n(.*?)^  end\n", re.MULTILINE | re.DOTALL)
CONNECT = re.compile(r"^connect (\S+) (.*)\n", re.MULTILINE)
PIN = re.compile(r"^(    connect )(\\\S+)( .*)$", re.MULTILINE)
NAME = re.compile(r"(?<=\s)[\\$]\S+")
NUMBERED = re.compile(r"(.*?)\$\d+(?=$|[.\[])")


def is_identifier(name: str) -> bool:
    """Return whether a name is an identifier in Verilog, without a backslash."""
    return re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII) is not None and name not in KEYWORDS


def tidy(text: str) -> str:
    """Return RTLIL of the same circuit with plain identifiers.

    The module ``top.part`` becomes ``top__part``.

    Parameters
    ----------
    text
        RTLIL of ``amaranth.back.rtlil.convert``.
    """
    bodies = {found[1]: found[2] for found in MODULE.finditer(text)}
    modules = _unique({name: name.replace(".", "__") for name in bodies}, set())
    bodies = {name: _without_empty_wires(body) for name, body in bodies.items()}
    ports = {name: _port_names(body) for name, body in bodies.items()}

    def rewrite(found: re.Match) -> str:
        body = _rename(bodies[found[1]], ports[found[1]])
        body = CELL.sub(lambda cell: _instance(cell, modules, ports), body)
        return f"module \\{modules[found[1]]}\n{body}end\n"

    return MODULE.sub(rewrite, text)


def _unique(wanted: dict[str, str], taken: set[str]) -> dict[str, str]:
    """Return unique names that are not taken.

    A keyword gets ``_`` appended, and a duplicate gets a number.
    """
    names = {}
    for key, name in wanted.items():
        name = f"{name}_" if name in KEYWORDS else name
        free, number = name, 2
        while free in taken or not is_identifier(free):
            free, number = f"{name}_{number}", number + 1
        taken.add(free)
        names[key] = free
    return names


def _without_empty_wires(body: str) -> str:
    """Remove wires of no bits, which Verilog does not have, unless they are read."""
    empty = {name for width, _, name in WIRE.findall(body) if width == "0"}
    for name in NAME.findall(CONNECT.sub(r" \2\n", WIRE.sub("", body))):
        empty.discard(name)
    body = CONNECT.sub(lambda found: "" if found[1] in empty else found[0], body)
    lines: list[str] = []
    for line in body.splitlines(keepends=True):
        if line.startswith("  wire ") and line.split()[-1] in empty:
            while lines and lines[-1].startswith("  attribute "):
                lines.pop()
        else:
            lines.append(line)
    return "".join(lines)


def _port_names(body: str) -> dict[str, str]:
    """Return new names of a module's wires and cells that are not plain identifiers.

    An expression gets its number between underscores, as in Yosys' own Verilog. A port that is a
    part of a longer signal is named after the module's signals that are parts of the port; or else
    after the signal that the port is part of.
    """
    wires, connects = WIRE.findall(body), CONNECT.findall(body)
    cells = [name for _, name, _ in CELL.findall(body)]
    names = [name for *_, name in wires] + [n for n in cells if n.startswith("\\")]
    wanted = {}
    for name in names:
        bare = name[1:]
        if bare.startswith("port$"):
            wanted[name] = _made_of(name, connects) or "port"
        elif name.startswith("$"):
            wanted[name] = f"_{bare}_"
        elif name.startswith("\\") and not is_identifier(bare):
            plain = NUMBERED.sub(r"\1", bare)
            wanted[name] = re.sub(r"\W+", "_", plain).strip("_") or "signal"
    taken = {name[1:] for name in names if name not in wanted}
    return {old: f"\\{new}" for old, new in _unique(wanted, taken).items()}


def _made_of(port: str, connects: list[tuple[str, str]]) -> str:
    """Return a port's name, made of the signals that are parts of it, or that it is part of."""
    parts: dict[int, str] = {}
    whole = ""
    inner = next((value.split()[0] for name, value in connects if name == port), port)
    for name, value in connects:
        if not is_identifier(name[1:]):
            continue
        found = re.fullmatch(rf"{re.escape(port)} \[(\d+)(?::(\d+))?\]", value)
        if found:
            parts.setdefault(int(found[2] or found[1]), name[1:])
        elif re.search(rf"(?<=\s){re.escape(inner)}(?=\s)", f" {value} "):
            whole = whole or name[1:]
    return "__".join(parts[place] for place in sorted(parts)) or whole


def _rename(body: str, names: dict[str, str]) -> str:
    """Return a module's body with new names of wires and cells."""
    head = {f"{old} ": f"{new} " for old, new in names.items()}
    pins: list[str] = []

    def keep(found: re.Match) -> str:
        pins.append(found[2])
        return f"{found[1]}@pin{found[3]}"

    # A pin of a cell may have the same name as a wire, and keeps it.
    held = PIN.sub(keep, body)
    held = NAME.sub(lambda found: head.get(f"{found[0]} ", found[0] + " ")[:-1], held)
    left = iter(pins)
    return re.sub(r"(?<=^    connect )@pin", lambda _: next(left), held, flags=re.MULTILINE)


def _instance(found: re.Match, modules: dict[str, str], ports: dict[str, dict[str, str]]) -> str:
    """Return an instance with the new names of its module and ports."""
    kind, name, pins = found.groups()
    if kind[1:] not in modules:
        return found[0]
    names = ports[kind[1:]]
    pins = PIN.sub(lambda pin: f"{pin[1]}{names.get(pin[2], pin[2])}{pin[3]}", pins)
    return f"  cell \\{modules[kind[1:]]} {name}\n{pins}  end\n"
