"""``make faults TOP=host``: what the host does when its files, views and surroundings are bad."""

import argparse
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from splatline.host.files.readers import FORMATS

from .compiled import damaged_functions, shared_functions
from .forker import ROOT, Forker
from .inputs import Found, corrupted_files, corrupted_frames, views
from .page import write_page
from .trials import KINDS, Bench

KEPT = ROOT / "build" / "faults"

WARM = ("render --out-dir", "render in tiles", "render in parts", "encode", "film gif")
"""Commands that load what all need."""

CHUNK = 500
"""Trials after which what is done is kept."""

Play = Callable[[range, Path], Found]


def plays(bench: Callable[[], Bench]) -> dict[str, tuple[Play, float]]:
    """Return what plays the trials of each kind, and the share of the count that it plays."""
    found: dict[str, tuple[Play, float]] = {
        f"corrupted {suffix}": (partial(corrupted_files, suffix), 1.0) for suffix in FORMATS
    }
    found["corrupted .frame"] = corrupted_frames, 1.0
    found["views"] = views, 1.0
    for kind, make in KINDS.items():
        found[kind] = partial(_commands, bench, make), 0.03
    found["damaged compiled functions"] = damaged_functions, 0.03
    found["compiled by two at once"] = shared_functions, 0.002
    return found


def _commands(bench: Callable[[], Bench], make: Callable, numbers: range, _: Path) -> Found:
    for number in numbers:
        outcome, wrong = bench().play(make, number)
        yield outcome, wrong


def main() -> int:
    """Play what is left of the campaign; write the page; return 1 if something was wrong."""
    parser = argparse.ArgumentParser(prog="make faults TOP=host", description=__doc__)
    parser.add_argument("--count", type=int, default=10_000, help="corrupted files of a format")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="where the table goes")
    parser.add_argument("--kept", type=Path, default=KEPT / "host.json")
    parser.add_argument("--only", help="kinds with this in their name, and no page")
    options = parser.parse_args()
    if options.count < 1:
        parser.error(f"--count must be at least 1, not {options.count}")
    tallies = _run(options.count, options.kept, options.only or "")
    wrong = [line for tally in tallies.values() for line in tally["wrong"]]
    print(*wrong[:20], sep="\n", end="\n" * bool(wrong))
    if options.only is None:
        write_page(options.docs, tallies)
    print(
        f"host: {sum(sum(t['outcomes'].values()) for t in tallies.values())} trials,"
        f" {len(wrong)} wrong"
    )
    return bool(wrong)


def _run(count: int, kept: Path, only: str) -> dict[str, dict]:
    """Return the tally of each kind; what an earlier run played is not played again."""
    kept.parent.mkdir(parents=True, exist_ok=True)
    done = json.loads(kept.read_text()) if kept.exists() else {}
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        for kind, (play, share) in plays(_once(stack, folder)).items():
            total = max(1, round(count * share))
            tally = done.setdefault(kind, {"outcomes": {}, "wrong": []})
            played = sum(tally["outcomes"].values())
            while only in kind and played < total:
                stop = min(played + CHUNK, total)
                with tempfile.TemporaryDirectory() as scratch:
                    found = list(play(range(played, stop), Path(scratch)))
                outcomes = Counter(tally["outcomes"]) + Counter(outcome for outcome, _ in found)
                tally["outcomes"] = dict(outcomes)
                tally["wrong"] += [wrong for _, wrong in found if wrong]
                played = stop
                part = kept.with_suffix(".part")
                part.write_text(json.dumps(done))
                part.replace(kept)
                print(f"host: {kind} {played}/{total}, {len(tally['wrong'])} wrong", flush=True)
    return done


def _once(stack: ExitStack, folder: Path) -> Callable[[], Bench]:
    """Return a function that makes the bench when it is first asked for it."""
    made: list[Bench] = []

    def bench() -> Bench:
        if not made:
            made.append(Bench(stack.enter_context(Forker(WARM)), folder))
        return made[0]

    return bench


if __name__ == "__main__":
    sys.exit(main())
