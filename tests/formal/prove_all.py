"""Every proof of the hardware, with its planted faults: a line each.

python -m tests.formal.prove_all                as ``make formal`` does
python -m tests.formal.prove_all tiler --keep DIR  those with tiler in the name
"""

import argparse
import importlib
import os
import re
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tests.formal.prove import TIMEOUT, Fault, Outcome, Proof, run

__all__ = ["all_proofs", "in_order", "main", "table"]

TAIL = 6
"""Of the log of a run that broke so many lines are told."""


def all_proofs() -> list[Proof]:
    """Return the proofs of every file here that is called ``*_proof.py``."""
    names = sorted(path.stem for path in Path(__file__).parent.glob("*_proof.py"))
    return [
        proof for name in names for proof in importlib.import_module(f"tests.formal.{name}").PROOFS
    ]


def in_order(proofs: list[Proof], *, faults: bool) -> Iterator[tuple[Proof, Fault | None]]:
    """Yield what to run: the quick proofs, a fault of each, the other proofs, the other faults."""
    quick = [proof for proof in proofs if not proof.slow]
    yield from ((proof, None) for proof in quick)
    if faults:
        yield from ((proof, fault) for proof in quick for fault in proof.faults[:1])
    yield from ((proof, None) for proof in proofs if proof.slow)
    if faults:
        rest = ((proof, proof.faults[0 if proof.slow else 1 :]) for proof in proofs)
        yield from ((proof, fault) for proof, left in rest for fault in left)


def table(proofs: list[Proof]) -> str:
    """Return what there is as Markdown."""
    rows = [
        f"| {proof.name} | {proof.shows} | {proof.extent} | {proof.engine} | {len(proof.faults)} |"
        for proof in proofs
    ]
    head = "| proof | shows | extent | engine | planted faults |\n|---|---|---|---|---:|"
    return "\n".join([head, *rows]) + "\n"


def told(outcome: Outcome) -> str:
    """Return in a line what became of a run: its status, or how its log ends if it has none."""
    if outcome.status != "broken":
        return outcome.status
    return "broken: " + " / ".join(outcome.log.split("\n")[-TAIL:])


def main() -> int:
    """Prove; return 1 if a proof does not hold or a fault is not found."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("words", nargs="*", help="run the proofs with one of these in their name")
    parser.add_argument("--no-faults", action="store_true", help="leave the planted faults out")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep RTLIL, logs and traces")
    parser.add_argument("--ci", action="store_true", help="all but those that take minutes")
    parser.add_argument(
        "--within", type=float, metavar="S", default=float("inf"),
        help="stop after so many seconds; proofs come before planted faults",
    )  # fmt: skip
    parser.add_argument("--list", action="store_true", help="say what there is, as Markdown")
    options = parser.parse_args()
    proofs = [
        proof
        for proof in all_proofs()
        if (not options.words or any(word in proof.name for word in options.words))
        and not (options.ci and proof.long)
    ]
    if not proofs:
        parser.error(f"no proof has {' or '.join(options.words)} in its name")
    if options.list:
        print(table(proofs), end="")
        return 0
    proofs.sort(key=lambda proof: (proof.long, proof.slow))

    begin = time.monotonic()
    wrong = []

    def job(proof, fault):
        left = min(begin + options.within - time.monotonic(), TIMEOUT)
        if left <= 0:
            return None
        folder = None
        if options.keep:
            folder = options.keep / re.sub(
                r"\W+", "_", f"{proof.name} {fault.name if fault else ''}"
            )
        try:
            outcome = run(proof, fault, folder, left)
            stopped = outcome.status == "too slow" and left < TIMEOUT
            return None if stopped else outcome
        except Exception as error:  # one that cannot be run must not keep the others from it
            return Outcome("broken", 0.0, f"{type(error).__name__}: {error}")

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        futures = {
            (proof.name, fault and fault.name): pool.submit(job, proof, fault)
            for proof, fault in in_order(proofs, faults=not options.no_faults)
        }
        for proof in proofs:
            outcome = futures[proof.name, None].result()
            if outcome is None:
                print(f"{proof.name:32} left out, for want of time", flush=True)
                continue
            faults = () if options.no_faults else proof.faults
            ends = {fault.name: futures[proof.name, fault.name].result() for fault in faults}
            ends = {name: end for name, end in ends.items() if end is not None}
            found = [name for name, end in ends.items() if end.status == "fails"]
            line = f"{proof.name:32} {outcome.status:8} {proof.extent:22} {outcome.seconds:6.1f} s"
            if faults:
                line += f"   {len(found)} of {len(ends)} faults found"
            if len(ends) < len(faults):
                line += f", {len(faults) - len(ends)} not tried for want of time"
            print(f"{line}\n    {proof.shows}", flush=True)
            if outcome.status != "holds":
                wrong.append(f"{proof.name} {told(outcome)}")
            wrong += [
                f"{proof.name} does not find: {name} ({told(end)})"
                for name, end in ends.items()
                if name not in found
            ]
    for text in wrong:
        print(text, file=sys.stderr)
    run_count = sum(futures[proof.name, None].result() is not None for proof in proofs)
    print(f"{run_count} of {len(proofs)} proofs in {time.monotonic() - begin:.0f} s")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
