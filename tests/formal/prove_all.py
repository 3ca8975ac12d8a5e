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
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tests.formal.prove import TIMEOUT, Outcome, Proof, run

__all__ = ["all_proofs", "main", "table"]

TAIL = 6
"""Of the log of a run that broke so many lines are told."""


def all_proofs() -> list[Proof]:
    """Return the proofs of every file here that is called ``*_proof.py``."""
    names = sorted(path.stem for path in Path(__file__).parent.glob("*_proof.py"))
    return [
        proof for name in names for proof in importlib.import_module(f"tests.formal.{name}").PROOFS
    ]


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
    parser.add_argument(
        "--ci", action="store_true", help="only those that CI runs beside those of `make test`"
    )
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
        and (not options.ci or (proof.slow and not proof.long))
    ]
    if not proofs:
        parser.error(f"no proof has {' or '.join(options.words)} in its name")
    if options.list:
        print(table(proofs), end="")
        return 0

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
        wholes = [pool.submit(job, proof, None) for proof in proofs]
        faults = [() if options.no_faults else proof.faults for proof in proofs]
        broken = [[pool.submit(job, proof, fault) for fault in faults[n]]
                  for n, proof in enumerate(proofs)]  # fmt: skip
        for n, proof in enumerate(proofs):
            outcome = wholes[n].result()
            if outcome is None:
                print(f"{proof.name:32} left out, for want of time", flush=True)
                continue
            told_of = zip(faults[n], broken[n], strict=True)
            ends = {fault.name: future.result() for fault, future in told_of}
            ends = {name: end for name, end in ends.items() if end is not None}
            found = [name for name, end in ends.items() if end.status == "fails"]
            line = f"{proof.name:32} {outcome.status:8} {proof.extent:22} {outcome.seconds:6.1f} s"
            if faults[n]:
                line += f"   {len(found)} of {len(ends)} faults found"
            if len(ends) < len(faults[n]):
                line += f", {len(faults[n]) - len(ends)} not tried for want of time"
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
    run_count = sum(whole.result() is not None for whole in wholes)
    print(f"{run_count} of {len(proofs)} proofs in {time.monotonic() - begin:.0f} s")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
