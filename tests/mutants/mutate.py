"""Lists mutants of a design with Yosys, and writes all of them into one Verilog with a choice."""

import dataclasses
import re
import shlex
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

from splatline.flow.tools import run_yosys

from .keep import ROOT, digest, versions
from .poke import add_pokes
from .tops import ENGINE, Design

__all__ = ["Mutant", "draw_mutants", "mutated_verilog", "prepared", "select_bits"]

PREPARE = (
    "read_verilog design.v\nhierarchy -top splatline\nproc -norom\nopt_expr -mux_undef -undriven\n"
    "opt_clean\nopt_merge\nmemory_collect\nopt_clean\nwrite_rtlil prepared.il\n"
)
"""What Yosys does before it mutates. Modules stay apart. A memory is a cell, and its contents are
no mutants. A choice between a value and an undefined one is the value, as in hardware."""

TAKE = (
    f"read_rtlil outer.il\nhierarchy -top {ENGINE}\nrename {ENGINE} splatline\n"
    "write_rtlil prepared.il\n"
)
"""How Yosys takes the engine from an AXI top."""

FIXED = ("CLK", "RD_CLK", "WR_CLK", "RD_EN", "RD_ARST", "RD_SRST")
"""Ports that are not mutated. An inverted clock is a fault of a netlist, not of its design. The
reads of the memories' cells have no enable and no reset."""

SPARE = 1.1
"""More mutants are drawn, so that enough are left without those at these ports."""


@dataclass(frozen=True)
class Mutant:
    """A change of one bit at one port of one cell.

    Parameters
    ----------
    mode
        ``inv``, ``const0``, ``const1``, ``cnot0``, ``cnot1``: the bit is inverted, constant, or
        inverted where another bit of the port, number ``ctrlbit``, is 0 or 1.
    module, cell, port, portbit, ctrlbit
        Where.
    wire
        The wire at the port, with its bit, for reports.
    """

    mode: str
    module: str
    cell: str
    port: str
    portbit: int
    ctrlbit: int | None = None
    wire: str = ""

    @property
    def part(self) -> str:
        """Name of the module in the table; modules that differ by a number are one."""
        name = self.module.removeprefix("splatline").strip("_") or "top"
        return re.sub(r"_\d+(_\d+)?(?=$|__)", "", name).replace("__", ".")

    @property
    def in_engine(self) -> bool:
        """It is in the engine of an AXI top."""
        return f"{self.module}__".startswith(f"{ENGINE}__")

    def inside(self) -> "Mutant":
        """Return the mutant in the engine that was taken from an AXI top."""
        module = "splatline" if self.module == ENGINE else self.module
        return dataclasses.replace(self, module=module)

    def arguments(self) -> str:
        """Return the options of Yosys' ``mutate`` that make this change."""
        options = {k: v for k, v in asdict(self).items() if k != "wire" and v is not None}
        return " ".join(f"-{name} {value}" for name, value in options.items())

    def __str__(self) -> str:
        control = "" if self.ctrlbit is None else f" by {self.ctrlbit}"
        at = f"{self.cell} {self.port}[{self.portbit}]{control}"
        return f"{self.mode} {self.part} {self.wire or ''} {at}".replace("  ", " ")


def select_bits(count: int) -> int:
    """Return the bits of a number of a mutant, 0 being none."""
    return count.bit_length()


def prepared(design: Design) -> Path:
    """Return the file with a design's RTLIL as it is mutated."""
    path = ROOT / "prepared" / f"{design.name}-{digest(design.verilog(), PREPARE, versions())}.il"
    if not path.exists():
        with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
            folder = Path(scratch)
            if design.inside:
                (folder / "outer.il").write_bytes(prepared(design.outer).read_bytes())
                run_yosys(TAKE, folder)
            else:
                (folder / "design.v").write_text(design.verilog())
                run_yosys(PREPARE, folder)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes((folder / "prepared.il").read_bytes())
    return path


def draw_mutants(design: Design, count: int, seed: int) -> list[Mutant]:
    """Return mutants, spread by Yosys over modules, cells, wires and kinds of change."""
    path = ROOT / "lists" / f"{prepared(design).stem}-{count}-{seed}"
    if not path.exists():
        with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
            folder = Path(scratch)
            (folder / "prepared.il").write_bytes(prepared(design).read_bytes())
            listing = f"mutate -list {round(SPARE * count) + 5} -seed {seed} -o list"
            run_yosys(f"read_rtlil prepared.il\n{listing}", folder)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes((folder / "list").read_bytes())
    mutants = map(_parse, path.read_text().splitlines())
    return [mutant for mutant in mutants if mutant.port not in FIXED][:count]


def _parse(line: str) -> Mutant:
    """Return the mutant of a line of Yosys' list."""
    words = shlex.split(line.replace("\\", "\\\\"))[1:]
    options = dict(zip(words[::2], words[1::2], strict=True))
    ctrlbit = options.get("-ctrlbit")
    wire = options.get("-wire", "")
    return Mutant(
        *(options[f"-{name}"] for name in ("mode", "module", "cell", "port")),
        int(options["-portbit"]),
        None if ctrlbit is None else int(ctrlbit),
        f"{wire}[{options.get('-wirebit', 0)}]" if wire else "",
    )


def mutated_verilog(design: Design, mutants: list[Mutant]) -> str:
    """Return a design with an input ``mutsel``: number n, from 1 on, is mutant n, 0 is none.

    The counters of an AXI top can be set: see :mod:`.poke`.
    """
    bits = select_bits(len(mutants))
    script = "read_rtlil prepared.il\n" + "".join(
        f"mutate -ctrl mutsel {bits} {number} {mutant.arguments()}\n"
        for number, mutant in enumerate(mutants, 1)
    )
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        base = prepared(design).read_text()
        (folder / "prepared.il").write_text(base)
        (folder / "mutate.ys").write_text(f"{script}write_rtlil mutated.il\n")
        run_yosys("script mutate.ys", folder)
        if design.top == "axi":
            mutated = (folder / "mutated.il").read_text()
            (folder / "mutated.il").write_text(add_pokes(mutated, base))
        run_yosys("read_rtlil mutated.il\nwrite_verilog -noattr -norename mutated.v", folder)
        return (folder / "mutated.v").read_text()
