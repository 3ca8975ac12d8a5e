"""Print how many pictures a second a board can show, by scene: from cycles that were counted.

Run as ``.venv/bin/python docs/board_rates.py``. It reads ``docs/bench/engine.json``: splats of each
scene's own spacing, quality ``fast`` (``exact`` with planes), 512 x 512 pixels, of which the screen
shows 480 lines. Engine and memory have the board's clock. The memory moves a 32-bit word a cycle:
two for a code word, four for a plane word, one for each pixel that is written (all of them, at
worst) and one for each that the screen reads. A picture takes whole refreshes of the screen.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

CLOCKS = {"ULX3S": 50e6, "Colorlight": 45e6}
REFRESH = 25e6 / (800 * 525)
SIZE, LINES = 512, 480
PRESETS = {"rgb24": "fast", "plane": "exact"}


def main() -> None:
    """Print a row for each scene and preset."""
    runs = json.loads(Path(__file__).with_name("bench").joinpath("engine.json").read_text())["runs"]
    heads = ["scene", "preset", "code words"]
    for board in CLOCKS:
        heads += [f"{board}: engine, ms", "memory, share", "pictures a second"]
    print("| " + " | ".join(heads) + " |\n|---|---|" + "---:|" * (len(heads) - 2))
    for run in runs:
        preset = run["preset"]
        if run["splats"] != "auto" or PRESETS.get(preset) != run["quality"]:
            continue
        row = [run["scene"], preset, f"{run['codewords']:,}"]
        for clock in CLOCKS.values():
            row += rates(run, clock)
        print("| " + " | ".join(row) + " |")


def rates(run: dict, clock: float) -> list[str]:
    """Return the engine's milliseconds, the memory's share and pictures a second, as text."""
    cycles = clock / REFRESH
    words = run["codewords"] * (4 if run["preset"] == "plane" else 2) + SIZE * SIZE
    free = cycles - SIZE * LINES
    refreshes = max(math.ceil(run["cycles"] / cycles), math.ceil(words / free))
    busy = (words / refreshes + SIZE * LINES) / cycles
    return [f"{1e3 * run['cycles'] / clock:.1f}", f"{busy:.0%}", f"{REFRESH / refreshes:.1f}"]


if __name__ == "__main__":
    main()
