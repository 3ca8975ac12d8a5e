"""How far Yosys and nextpnr are, judged by the lines that they print."""

from __future__ import annotations

import re
from collections.abc import Callable

from splatline.contract.progress import Share, part_of

__all__ = ["follow_nextpnr", "follow_yosys", "part_of"]

PASS = re.compile(r"[\d.]+ Executing ")
"""Begin of Yosys' line about a pass."""

PASSES = 180
"""Passes of a synthesis. Those of engines have 175 to 185."""

LAST_PASS = 0.25
"""Share of a synthesis' time that its last pass takes, the mapping to LUTs."""

ITERATION = re.compile(r"Info: +at iteration #(\d+), ")
"""nextpnr's line about its placer."""

ITERATIONS = 40
"""Iterations of the placer. Some designs need a few more, some fewer."""

ARCS = re.compile(r"Info: +\d+ \|(?: +\d+){2} \|(?: +\d+){2} \| *(\d+)\|")
"""nextpnr's line about its router, with the connections that are left."""


def follow_yosys(progress: Share) -> Callable[[str], None]:
    """Return what takes the lines of a synthesis, and tells the share that is done."""
    passes = 0

    def hear(line: str) -> None:
        nonlocal passes
        if PASS.match(line):
            passes += 1
            progress((1.0 - LAST_PASS) * min(1.0, passes / PASSES))

    return hear


def follow_nextpnr(progress: Share) -> Callable[[str], None]:
    """Return what takes nextpnr's lines, and tells the share that is done.

    The placer counts as one half, and the router as the other.
    """
    most = 0

    def hear(line: str) -> None:
        nonlocal most
        if found := ITERATION.match(line):
            progress(0.5 * min(1.0, int(found[1]) / ITERATIONS))
        elif found := ARCS.match(line):
            most = max(most, int(found[1]))
            progress(1.0 - 0.5 * int(found[1]) / max(most, 1))

    return hear
