"""Plays the fast bench to every mutant of a design, and keeps what it says of each."""

import json
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from splatline.sim.cosim.simulator import SimulationError

from .acts import acts_of
from .build import build
from .keep import ROOT, digest
from .mutate import Mutant
from .program import write_program
from .tops import Design

__all__ = ["Verdict", "judge", "judge_engine"]


@dataclass(frozen=True)
class Verdict:
    """What the fast bench says of a mutant.

    Parameters
    ----------
    kind
        The kind of the frames by which it was noticed; empty if it survived.
    reason
        ``value``, ``early``, ``surplus``, ``withdrawn``, ``level``, ``cycles``, ``hang``: what is
        wrong. ``stopped``: the simulator did not come to rest in a cycle.
    cycles
        Cycles that were played.
    alone
        The bench is that of the engine of an AXI top, alone.
    """

    kind: str
    reason: str
    cycles: int
    alone: bool = False

    @property
    def noticed(self) -> bool:
        """The mutant differs from what the contract says."""
        return bool(self.kind)


def judge(
    design: Design, mutants: list[Mutant], told: Callable[[int], None] = lambda count: None
) -> list[Verdict]:
    """Return the verdict on each mutant. The design itself is played first.

    Verdicts are kept one by one, so that a run that was stopped goes on where it was.

    Parameters
    ----------
    design, mutants
        What is judged.
    told
        Called with the number of verdicts so far.

    Raises
    ------
    SimulationError
        If the bench cannot be built, or the design without a mutant does not pass.
    """
    program = build(design, mutants)
    acts = acts_of(design)
    with tempfile.TemporaryDirectory(dir=ROOT, prefix="playing-") as scratch:
        file = Path(scratch) / "program"
        write_program(file, design, acts)
        kept = ROOT / "verdicts" / f"{program.name}-{digest(file.read_bytes())}"
        kept.parent.mkdir(parents=True, exist_ok=True)
        lines = kept.read_text().splitlines() if kept.exists() else []
        verdicts = [Verdict(**json.loads(line)) for line in lines]
        while len(verdicts) <= len(mutants):
            for verdict in _play(program, file, len(verdicts), len(mutants), acts):
                if not verdicts and verdict.noticed:
                    raise SimulationError(
                        f"{design.name} without a mutant fails: {verdict.reason} in {verdict.kind}"
                    )
                verdicts.append(verdict)
                with kept.open("a") as out:
                    out.write(json.dumps(asdict(verdict)) + "\n")
                told(len(verdicts) - 1)
    return verdicts[1:]


def judge_engine(design: Design, mutants: list[Mutant], verdicts: list[Verdict]) -> list[Verdict]:
    """Return the verdicts on mutants of an AXI top once survivors in its engine are played alone.

    The bench of the engine has more frames, and counts their cycles.
    """
    left = [n for n, verdict in enumerate(verdicts) if not verdict.noticed and mutants[n].in_engine]
    if design.top != "axi" or not left:
        return verdicts
    result = list(verdicts)
    for n, verdict in zip(
        left, judge(design.engine, [mutants[n].inside() for n in left]), strict=True
    ):
        result[n] = replace(verdict, alone=verdict.noticed)
    return result


def _play(program: Path, file: Path, first: int, last: int, acts):
    """Yield verdicts on mutants from ``first`` on; a simulator that stops is one, the last."""
    command = [program, file, str(first), str(last)]
    found = first
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as run:
        for line in run.stdout:
            if not line[0].isdigit():
                continue  # what Verilator says as it stops
            number, act, reason, cycles = line.split()
            if int(number) != found:
                raise SimulationError(f"the bench came to mutant {number}, not {found}")
            found += 1
            yield Verdict(acts[int(act)].kind if int(act) >= 0 else "", reason, int(cycles))
    if run.returncode and found <= last:
        yield Verdict("any", "stopped", 0)
