"""Shows that a mutant is equal to the design but for what the clearing after a reset overwrites.

The windows of both run in lockstep, with their memories as boxes (``cleared_ports.v``): until the
clearing is done, what goes into the cleared memories does not count, and what comes out may differ.
That both then hold the same words is shown by :mod:`.clearing`. A proof by induction shows the
rest, from any state in which a few invariants hold. Payloads count while they are valid, and of an
end beat the end bit alone.
"""

import itertools
import re
import tempfile
from collections.abc import Iterable
from pathlib import Path

from splatline.flow.tools import run_yosys

from .aig import Aig, read_aig
from .clearing import clear
from .invariants import invariants
from .keep import ROOT
from .lockstep import merged, stays_right
from .mutate import Mutant, prepared
from .prove import PAIR
from .renamed import Renaming, renaming_of
from .tops import ENGINE, Design
from .wrapper import ports_of, wrap

__all__ = [
    "AS_TEXT",
    "PAIRED",
    "TO_GATES",
    "may_be_cleared",
    "prove_cleared",
    "window_of",
]

LANE = re.compile(r"__lane_(\d)_(\d)$|^lane_(\d)_(\d)\.")
TO_GATES = "async2sync\ndffunmap\nsimplemap\ntechmap\nopt_clean\nsetundef -zero -init\naigmap\n"
AS_TEXT = "opt_clean\nwrite_aiger -ascii -symbols {name}.aag\n"
PAIRED = PAIR.partition("async2sync")[0].replace("miter -equiv", "miter -equiv -make_outputs")


def may_be_cleared(design: Design, mutant: Mutant) -> bool:
    """Return whether a mutant is one of a lane, of a lane's address or of the clearing's."""
    window = window_of(mutant)
    if not window or design.config.draws_blocks:
        return False
    if mutant.module != window:
        return bool(LANE.search(mutant.module))
    renaming = renaming_of(design, mutant)
    return mutant.wire.startswith("sweep[") or bool(renaming and len(renaming.memories) == 1)


def window_of(mutant: Mutant) -> str:
    """Return the module of the window that a mutant is in, or nothing."""
    window = f"{ENGINE if mutant.in_engine else 'splatline'}__window"
    return window if f"{mutant.module}__".startswith(f"{window}__") else ""


def prove_cleared(design: Design, mutant: Mutant) -> bool:
    """Return whether such a mutant is shown to be equal."""
    window = window_of(mutant)
    renaming = renaming_of(design, mutant) if mutant.module == window else None
    lanes = _lanes(mutant, renaming)
    memories = [f"w.lane_{i}_{j}.ram" for i, j in lanes]
    if len(lanes) > 1:
        memories += [f"w.flush_scan.dirty_bits.marks_{q}_{p}" for q in range(4) for p in range(2)]
    with tempfile.TemporaryDirectory(dir=ROOT, prefix="clearing-") as scratch:
        folder = Path(scratch)
        both = _graphs(folder, design, mutant, window, memories, renaming)
        cycles = {
            clear(read_aig(folder / f"{name}.aag"), memories, design.config.depth_bits)
            for name in ("gold", "gate")
        }
        if len(cycles) != 1 or None in cycles:
            return False
        wrong, apart, both = invariants(both, lanes, renaming)
        return stays_right(folder, merged(both, wrong, apart))


def _lanes(mutant: Mutant, renaming: Renaming | None) -> list[tuple[int, int]]:
    """Return the lanes whose memories may differ while they are cleared."""
    found = LANE.search(renaming.memories[0] if renaming else mutant.module)
    if found:
        return [tuple(int(digit) for digit in found.groups() if digit is not None)]
    return list(itertools.product(range(4), range(4)))


def _graphs(
    folder: Path,
    design: Design,
    mutant: Mutant,
    window: str,
    memories: Iterable[str],
    renaming: Renaming | None,
) -> Aig:
    """Return the graph of both windows; write that of each, with plain memories, as text."""
    here = Path(__file__)
    texts = {name: here.with_name(name).read_text() for name in (
        "memories.v", "memory_ports.v", "cleared_ports.v",
    )}  # fmt: skip
    il = prepared(design).read_text()
    boxes = {"gold": texts["memories.v"]}
    boxes["gate"] = renaming.verilog(boxes["gold"]) if renaming else boxes["gold"]
    texts["memory_ports.v"] = "(* keep_hierarchy *)\n" + texts["memory_ports.v"]
    texts["whole.v"] = _whole(il, window, design.config.raster_end.lsb)
    texts["prepared.il"] = il
    for gate, (name, text) in enumerate(boxes.items()):
        for kind, depth in (("lane", design.config.depth_bits), ("marks", 0)):
            ports = f"cleared_ports #(.DEPTH({depth}), .GATE({gate}), "
            texts[f"{kind}_{name}.v"] = text.replace("memory_ports #(", ports)
    for name, text in texts.items():
        (folder / name).write_text(text)
    script = "read_rtlil prepared.il\ndesign -save base\n"
    for name in boxes:
        change = f"mutate {mutant.arguments()}\n" if name == "gate" else ""
        begin = (
            f"design -load base\n{change}read_verilog whole.v\nhierarchy -top whole\nflatten\n"
            "opt_clean\nread_verilog memory_ports.v\nread_verilog cleared_ports.v\n"
        )
        plain = "techmap -map memories.v\n"
        maps = [f"techmap -map {_kind(one)}_{name}.v c:{one}\n" for one in memories]
        links = [
            f"connect -port {one} {flag} \\w.{flag}\n"
            for one in memories
            for flag in ("sweeping", "swept")
        ]
        linked = "".join([*maps, plain, "cd whole\n", *links, "cd ..\n"])
        end = "hierarchy -top whole\nflatten\nopt_clean\nexpose -evert c:*\nopt_clean\n"
        script += begin + plain + end + TO_GATES + AS_TEXT.format(name=name)
        script += begin + linked + end + f"rename whole {name}\ndesign -stash {name}\n"
    (folder / "both.ys").write_text(script + PAIRED + TO_GATES + AS_TEXT.format(name="both"))
    run_yosys("script both.ys", folder)
    return read_aig(folder / "both.aag")


def _kind(memory: str) -> str:
    return "lane" if ".lane_" in memory else "marks"


def _whole(il: str, window: str, end: int) -> str:
    """Return a module around a window whose payloads are 0 where they do not count."""
    ports = ports_of(il, window)
    names = {port.name for port in ports}
    inside, masks = {}, []
    for name, way, size in ports:
        valid = name.replace("payload", "valid")
        if way == "output" and name.endswith("payload") and valid in names:
            inside[name] = f"raw_{name}"
            last = f"{size}'d1 << {end}"
            masks += [
                f"wire [{size - 1}:0] raw_{name};",
                f"assign {name} = !{valid} ? 0 : raw_{name}[{end}] ? {last} : raw_{name};",
            ]
    return wrap(window, ports, inside, masks, "w")
