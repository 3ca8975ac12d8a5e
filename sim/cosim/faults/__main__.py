"""``make faults``: runs the campaign of a preset and writes its table."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from splatline.contract.errors import InputError
from splatline.contract.presets import get_preset

from .campaign import CHUNK, Campaign, kinds_of
from .page import write_page
from .tally import Tally, from_json, to_json

__all__: list[str] = []


def main() -> int:
    """Play what is left of a campaign; return 1 if something was wrong."""
    parser = argparse.ArgumentParser(prog="make faults", description=__doc__)
    parser.add_argument("--preset", default="paper")
    parser.add_argument("--top", default="engine", choices=("engine", "axi"))
    parser.add_argument("--count", type=int, default=100_000, help="trials of all kinds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--kept", type=Path, default=Path("build/faults"), help="what is done so far"
    )
    parser.add_argument("--docs", type=Path, default=Path("docs"), help="where the table goes")
    options = parser.parse_args()
    if options.count < 1:
        raise InputError(f"--count must be at least 1, not {options.count}")
    try:
        config = get_preset(options.preset)
    except ValueError as error:
        raise InputError(str(error)) from error
    subject = options.preset + "-axi" * (options.top == "axi")
    print(f"{subject}: building", flush=True)
    campaign = Campaign(config, options.seed, top=options.top)
    tallies = _run(campaign, subject, options.count, options.kept)
    write_page(options.docs, subject, tallies, seed=options.seed)
    wrong = [line for tally in tallies.values() for line in tally.wrong]
    print(*wrong[:20], sep="\n", end="\n" * bool(wrong))
    print(f"{subject}: {sum(t.trials for t in tallies.values())} trials, {len(wrong)} wrong")
    return bool(wrong)


def _run(campaign: Campaign, subject: str, count: int, kept: Path) -> dict[str, Tally]:
    """Return the tally of each kind; an earlier run of the same campaign goes on."""
    kept.mkdir(parents=True, exist_ok=True)
    file = kept / f"{subject}.json"
    key = [campaign.seed, count, campaign.model.name]
    before = json.loads(file.read_text()) if file.exists() else {}
    done = before["kinds"] if before.get("key") == key else {}
    tallies = {}
    for kind, share in kinds_of(campaign.top).items():
        total = max(1, round(count * share))
        played, numbers = done.get(kind, [0, to_json(Tally())])
        tally = from_json(numbers)
        while played < total:
            stop = min(played + CHUNK, total)
            tally.add(campaign.play(kind, range(played, stop), total))
            played = stop
            done[kind] = [played, to_json(tally)]
            scratch = file.with_suffix(".part")
            scratch.write_text(json.dumps({"key": key, "kinds": done}))
            scratch.replace(file)
            print(
                f"\r{subject}: {kind} {played}/{total}, {len(tally.wrong)} wrong ",
                end="",
                flush=True,
            )
        print()
        tallies[kind] = tally
    return tallies


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        print(f"faults: {error}", file=sys.stderr)
        sys.exit(2)
