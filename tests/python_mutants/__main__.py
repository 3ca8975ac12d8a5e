"""Mutants of the Python code, judged by its tests: ``make python-mutants``.

python -m tests.python_mutants                      40 of each group; a page in docs
python -m tests.python_mutants golden --count 10    10 of one group; no page
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

from tests.python_mutants.choose import change, choose
from tests.python_mutants.groups import GROUPS, ROOT
from tests.python_mutants.judge import judge
from tests.python_mutants.page import write_page

KEPT = ROOT / "build" / "python_mutants"
PAGE = ROOT / "docs" / "python_mutants.md"


def main() -> int:
    """Judge mutants; return 1 if a group misses the goal.

    Verdicts of earlier runs are taken from ``build/python_mutants``.
    """
    parser = argparse.ArgumentParser(
        prog="make python-mutants",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("groups", nargs="*", help=f"of {', '.join(each.name for each in GROUPS)}")
    parser.add_argument("--count", type=int, default=40, help="mutants of each group")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--page", action="store_true", help="only write the page of what is kept")
    options = parser.parse_args()
    unknown = set(options.groups) - {group.name for group in GROUPS}
    if unknown:
        parser.error(f"there is no group {', '.join(sorted(unknown))}")
    if options.count < 1:
        parser.error("the count must be at least 1")
    chosen = [group for group in GROUPS if not options.groups or group.name in options.groups]
    for group in chosen if not options.page else []:
        _judge(group, options.count, options.seed, KEPT / f"{group.name}-{options.seed}.json")
    if not options.page and options.groups:
        return 0
    told = write_page(KEPT, PAGE)
    print(f"{PAGE.relative_to(ROOT)} is written.", *told, sep="\n")
    return bool(told)


def _judge(group, count: int, seed: int, file: Path) -> None:
    """Judge the mutants of a group that are not judged yet; keep each verdict at once."""
    file.parent.mkdir(parents=True, exist_ok=True)
    kept = json.loads(file.read_text()) if file.exists() else []
    known = {(each["file"], each["operator"], each["occurrence"]) for each in kept}
    mutants = [
        mutant
        for mutant in choose(group, count, seed)
        if (mutant.file, mutant.operator, mutant.occurrence) not in known
    ]
    begin = time.monotonic()
    judged = judge(group, mutants, os.cpu_count() or 1) if mutants else iter(())
    for number, (mutant, verdict, test) in enumerate(judged, 1):
        before, after = change(mutant)
        told = {"before": before, "after": after, "verdict": verdict, "test": test}
        kept.append({**vars(mutant), **told})
        file.write_text(json.dumps(kept, indent=1))
        taken = time.monotonic() - begin
        print(
            f"{group.name} {number}/{len(mutants)}: {verdict:8} {mutant.file}:{mutant.line}"
            f" {after} ({taken:.0f} s)",
            flush=True,
        )


if __name__ == "__main__":
    sys.exit(main())
