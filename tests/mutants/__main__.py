"""Judges mutants of the generated Verilog: how many do the benches notice?

python -m tests.mutants                                 1,200 of the five designs
python -m tests.mutants --preset paper --count 50       a sample
python -m tests.mutants --preset paper-axi --count 200 --page page.md

A run that was stopped goes on where it was. Builds and verdicts are in build/mutants.
"""

import argparse
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from splatline.sim.cosim.simulator import SimulationError

from .batch import Batch, Judged, judge_batch
from .page import page, score, summary
from .tops import DESIGNS

__all__ = ["main"]

COUNT, SEED, FRESH_SEED = 1200, 1, 271128
LEAST, LEAST_OF_SAMPLE = 0.95, 0.85
"""The least score, and that of fewer than ``SAMPLE`` mutants, where a few by chance count much."""

SAMPLE = 200

FRESH = 6
"""One mutant of so many comes from the second seed, drawn once all other frames were written."""


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """Return the options."""
    parser = argparse.ArgumentParser(
        prog="make mutants" if arguments is None else "mutants",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    names = [design.name for design in DESIGNS]
    parser.add_argument("--preset", default="all", help=f"{', '.join(names)}, or all")
    parser.add_argument("--count", default=str(COUNT), help="mutants of all designs together")
    parser.add_argument("--seed", type=int, default=SEED, help="seed of most mutants")
    parser.add_argument("--fresh-seed", type=int, default=FRESH_SEED, help="seed of the others")
    parser.add_argument("--jobs", type=int, default=2, help="designs at a time")
    parser.add_argument("--no-proofs", action="store_true", help="leave survivors as they are")
    parser.add_argument("--page", type=Path, metavar="FILE", help="write the tables as Markdown")
    options = parser.parse_args(arguments)
    options.designs = [d for d in DESIGNS if options.preset in ("all", d.name)]
    if not options.designs:
        sys.exit(_refuse(f"no preset named {options.preset!r}; there are: {', '.join(names)}, all"))
    if not options.count.isdecimal() or not 0 < int(options.count) <= 100_000:
        sys.exit(_refuse(f"the count must be a number in 1..100000, not {options.count!r}"))
    options.count = int(options.count)
    return options


def _refuse(text: str) -> int:
    """Say in a line what is wrong with an option; return the exit code."""
    print(f"mutants: {text}", file=sys.stderr)
    return 2


def batches(options: argparse.Namespace) -> list[Batch]:
    """Return what is judged: of each design a batch from each seed."""
    each = -(-options.count // len(options.designs))
    fresh = each // FRESH if each >= 60 else 0
    found = [Batch(design, options.seed, each - fresh) for design in options.designs]
    if fresh:
        found += [
            Batch(design, options.fresh_seed, fresh, fresh=True) for design in options.designs
        ]
    return found


def main(arguments: list[str] | None = None) -> int:
    """Judge; return 1 if a design fails without a mutant, or the score is too low."""
    options = parse(arguments)
    begin = time.monotonic()

    def told(batch: Batch, text: str) -> None:
        print(f"{time.monotonic() - begin:6.0f} s  {batch.design.name:10} {text}", flush=True)

    def run(batch: Batch) -> Judged:
        return judge_batch(batch, told, proofs=not options.no_proofs)

    try:
        with ThreadPoolExecutor(options.jobs) as pool:
            judged = list(pool.map(run, batches(options)))
    except SimulationError as error:
        print(f"mutants: {error}", file=sys.stderr)
        return 1
    print(summary(judged))
    if options.page:
        options.page.write_text(page(judged), encoding="utf-8")
    return int(score(judged) < (LEAST if options.count >= SAMPLE else LEAST_OF_SAMPLE))


if __name__ == "__main__":
    sys.exit(main())
