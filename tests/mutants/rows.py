"""Shows that a mutant is equal which renames the words of a row of lanes, clearing aside.

Three things together. The window, simulated from a reset on with an unknown state and unknown
inputs, requests of the row to clear word after word, and lets no beat leave meanwhile. The row's
pixels go nowhere but into the beats of the readout. The row of the design and that of the mutant,
in lockstep with such requests, clear the same words and are the same later, by induction from any
state in which a few invariants hold; see :mod:`.lockstep`.
"""

import dataclasses
import re
import tempfile
from pathlib import Path

from splatline.flow.tools import run_yosys
from splatline.rtl.blocks.lane_row import HALVES, RowRequestLayout, row_address_bits

from .aig import Aig, read_aig
from .cleared import AS_TEXT, PAIRED, TO_GATES
from .clearing import Clearing, bits_of
from .keep import ROOT
from .lockstep import merged, stays_right
from .mutate import Mutant, prepared
from .renamed import Renaming, goes_into, renaming_of
from .row_invariants import FLUSHES, WRITES, row_invariants
from .tops import Design
from .wrapper import ports_of, wrap

__all__ = ["prove_row", "row_of", "same_row"]

INSIDE = {"request": "asked", "leaving": "left"}
"""What the row has in the place of a port."""

ROW = re.compile(r"row_\d")


def row_of(design: Design, mutant: Mutant) -> str:
    """Return the row of lanes whose words a mutant may rename, or nothing."""
    window = "splatline__window"
    if not design.config.draws_blocks or design.config.plane or mutant.in_engine:
        return ""
    name = mutant.cell if mutant.module == window else mutant.module.removeprefix(f"{window}__")
    return name if ROW.fullmatch(name) and renaming_of(design, mutant) else ""


def prove_row(design: Design, mutant: Mutant) -> bool:
    """Return whether such a mutant is shown to be equal."""
    row = row_of(design, mutant)
    return (
        _goes_to_the_queue(design, row)
        and _window_clears(design, row)
        and same_row(design, mutant, row, renaming_of(design, mutant))
    )


def same_row(design: Design, mutant: Mutant, row: str, renaming: Renaming) -> bool:
    """Return whether a row is the same but for the places of words, once it is cleared."""
    with tempfile.TemporaryDirectory(dir=ROOT, prefix="row-") as scratch:
        folder = Path(scratch)
        both = _pair(folder, design, mutant, row, renaming)
        wrong, apart, both = row_invariants(both, renaming, design)
        return stays_right(folder, merged(both, wrong, apart))


def _window_graph(design: Design) -> Aig:
    """Return the graph of the window, with the memories as boxes."""
    with tempfile.TemporaryDirectory(dir=ROOT, prefix="row-") as scratch:
        folder = Path(scratch)
        (folder / "prepared.il").write_bytes(prepared(design).read_bytes())
        for name in ("memories.v", "memory_ports.v"):
            (folder / name).write_text(Path(__file__).with_name(name).read_text())
        top = "hierarchy -top splatline__window\n"
        run_yosys(
            f"read_rtlil prepared.il\n{top}flatten\nopt_clean\nread_verilog memory_ports.v\n"
            f"techmap -map memories.v\n{top}expose -evert c:*\nopt_clean\n{TO_GATES}"
            f"{AS_TEXT.format(name='window')}",
            folder,
        )
        return read_aig(folder / "window.aag")


def _window_clears(design: Design, row: str) -> bool:
    """Return whether a window requests the clearing of a row, and lets no beat leave meanwhile."""
    aig, sweep = _window_graph(design), 1 << row_address_bits(design.config)
    request, valid = bits_of(aig, row.replace("row", "request")), bits_of(aig, "readout.valid")
    run = Clearing(aig, [*request, *valid])
    fields = _fields(design)
    run.settle(1)
    for age in range(sweep + FLUSHES):
        run.cycle(0)
        found = {name: [run.values[request[n]] for n in bits] for name, bits in fields.items()}
        clear = 1 <= age <= sweep
        flags = found["draw"] + found["store"] + found["clear"]
        if 1 <= age < sweep + WRITES and flags != [0, clear, clear]:
            return False
        place = [(age - 1) >> n & 1 for n in range(len(fields["even"]))]
        if clear and not found["even"] == found["odd"] == place:
            return False
        if any(run.values[bit] for bit in valid):
            return False
    return True


def _goes_to_the_queue(design: Design, row: str) -> bool:
    """Return whether a row's pixels go nowhere but into the data of the readout's queue."""
    found = goes_into(design, "splatline__window", f"{row}.leaving")
    return {(name.partition(".fifo")[0], port) for name, port in found} == {
        ("readout.queue", "WR_DATA")
    }


def _fields(design: Design) -> dict[str, range]:
    """Return which bits of a row's request its fields have."""
    layout = RowRequestLayout(design.config)
    found = {name: range(field.offset, field.offset + field.width) for name, field in layout}
    size = row_address_bits(design.config)
    return {**found, "even": found["addresses"][:size], "odd": found["addresses"][size:]}


def _age_bits(sweep: int) -> int:
    """Return the bits of the cycles since a reset, as far as they are counted."""
    return (sweep + FLUSHES).bit_length()


def _whole(il: str, module: str, design: Design) -> str:
    """Return a module around a row that gives it the window's requests after a reset."""
    ports = ports_of(il, module)
    sizes = {port.name: port.size for port in ports}
    fields, sweep = _fields(design), 1 << row_address_bits(design.config)
    bit = {name: fields[name].start for name in ("draw", "store", "clear")}
    place = [f"asked[{fields[half].start} +: {len(fields[half])}]" for half in HALVES]
    lines = [
        f"reg [{_age_bits(sweep) - 1}:0] age = 0;",
        f"always @(posedge clk) age <= rst ? 0 : age + (age < {sweep + FLUSHES});",
        f"reg [{sizes['request'] - 1}:0] asked;",
        f"wire [{sizes['leaving'] - 1}:0] left;",
        "always @* begin",
        "asked = request;",
        f"if (age >= 1 & age < {sweep + WRITES}) begin",
        f"asked[{bit['draw']}] = 0;",
        *(f"asked[{bit[flag]}] = age <= {sweep};" for flag in ("store", "clear")),
        f"if (age <= {sweep}) begin {' '.join(f'{one} = age - 1;' for one in place)} end",
        "end",
        "end",
        f"assign leaving = age < {sweep + FLUSHES - 1} ? 0 : left;",
    ]
    return wrap(module, ports, INSIDE, lines, "row")


def _pair(folder: Path, design: Design, mutant: Mutant, row: str, renaming: Renaming) -> Aig:
    """Return the graph of the row of the design and of the mutant, with memories as boxes."""
    il, module = prepared(design).read_text(), f"splatline__window__{row}"
    (folder / "whole.v").write_text(_whole(il, module, design))
    plain = Path(__file__).with_name("memories.v").read_text()
    (folder / "prepared.il").write_text(il)
    depth, sweep = design.config.depth_bits, 1 << row_address_bits(design.config)
    for name, gate, text in (
        ("gold", 0, plain), ("gate", 1, plain), ("renamed", 1, renaming.verilog(plain)),
    ):  # fmt: skip
        sizes = f".DEPTH({depth}), .SWEEP({sweep}), .AGE({_age_bits(sweep)})"
        ports = f"row_ports #({sizes}, .GATE({gate}), "
        (folder / f"{name}.v").write_text(text.replace("memory_ports #(", ports))
    (folder / "row_ports.v").write_text(Path(__file__).with_name("row_ports.v").read_text())
    inside = mutant
    if mutant.module != module:  # at the row's port
        inside = dataclasses.replace(mutant, module="whole", cell="row")
    columns = range(design.config.pixels_per_word)
    memories = [f"row.{half}_{column}" for half in HALVES for column in columns]
    renamed = [f"row.{name.removeprefix(f'{row}.')}" for name in renaming.memories]
    chosen = {"gold": [("gold", memories)], "gate": [("renamed", renamed), ("gate", memories)]}
    script = "read_rtlil prepared.il\ndesign -save base\n"
    for name in ("gold", "gate"):
        change = f"mutate {inside.arguments()}\n" if name == "gate" else ""
        maps = "".join(
            f"techmap -map {kind}.v {' '.join(f'c:{one}' for one in parts)}\n"
            for kind, parts in chosen[name]
        )
        links = "".join(f"connect -port {memory} age \\age\n" for memory in memories)
        script += (
            f"design -load base\nread_verilog whole.v\nhierarchy -top whole\nproc\n{change}"
            f"flatten\nopt_clean\nread_verilog row_ports.v\n{maps}cd whole\n{links}cd ..\n"
            "hierarchy -top whole\nflatten\nopt_clean\nexpose -evert c:*\nopt_clean\n"
            f"rename whole {name}\ndesign -stash {name}\n"
        )
    (folder / "both.ys").write_text(script + PAIRED + TO_GATES + AS_TEXT.format(name="both"))
    run_yosys("script both.ys", folder)
    return read_aig(folder / "both.aag")
