"""Lists mutants of a design with Yosys, and writes all of them into one Verilog with a choice."""

import re
import shlex
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

from splatline.flow.tools import run_yosys

from .tops import Design

__all__ = ["Mutant", "draw_mutants", "mutated_verilog", "select_bits"]

PREPARE = (
    "read_verilog design.v\nhierarchy -top splatline\nproc -norom\nopt_expr\nopt_clean\nopt_merge\n"
    "memory_collect\nopt_clean\n"
)
"""What Yosys does before it mutates. Modules stay apart; a memory is a cell, its contents are not
mutated."""


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
        """Name of the module without the design's, ``top`` for the top; lanes under one name."""
        name = self.module.removeprefix("splatline").strip("_") or "top"
        return re.sub(r"_\d+(_\d+)?(?=$|__)", "", name)

    def arguments(self) -> str:
        """Return the options of Yosys' ``mutate`` that make this change."""
        options = {k: v for k, v in asdict(self).items() if k != "wire" and v is not None}
        return " ".join(f"-{name} {value}" for name, value in options.items())


def select_bits(count: int) -> int:
    """Return the bits of a number of a mutant, 0 being none."""
    return count.bit_length()


def draw_mutants(design: Design, count: int, seed: int) -> list[Mutant]:
    """Return mutants, spread by Yosys over modules, cells, wires and kinds of change."""
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "design.v").write_text(design.verilog())
        run_yosys(f"{PREPARE}mutate -list {count} -seed {seed} -o list", folder)
        return [_parse(line) for line in (folder / "list").read_text().splitlines()]


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
    """Return a design with an input ``mutsel``: number n, from 1 on, is mutant n, 0 is none."""
    bits = select_bits(len(mutants))
    script = PREPARE + "".join(
        f"mutate -ctrl mutsel {bits} {number} {mutant.arguments()}\n"
        for number, mutant in enumerate(mutants, 1)
    )
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "design.v").write_text(design.verilog())
        (folder / "mutate.ys").write_text(f"{script}write_verilog -noattr -norename mutated.v\n")
        run_yosys("script mutate.ys", folder)
        return (folder / "mutated.v").read_text()
