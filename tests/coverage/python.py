"""What the tests reach of the Python code: by coverage.py, and by the compiled functions."""

import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

__all__ = ["ROOMS", "Room", "measure"]

ROOT = Path(__file__).parents[2]
ROOMS = ("contract", "rtl", "flow", "host", "sim", "view", "plots", "cli", "boards")


@dataclass
class Room:
    """What is reached of a room.

    Parameters
    ----------
    lines, branches, compiled
        Those reached, and all: of Python, and statements of compiled functions.
    missed
        Compiled statements that are not reached: file and line.
    """

    lines: tuple[int, int]
    branches: tuple[int, int]
    compiled: tuple[int, int]
    missed: list[str]


def measure(report: Path, counts: Path) -> dict[str, Room]:
    """Return what is reached by room.

    Parameters
    ----------
    report
        What ``coverage json`` writes.
    counts
        Folder with the ``*.lines`` of compiled functions.
    """
    summed = {room: Counter[str]() for room in ROOMS}
    for name, file in json.loads(report.read_text())["files"].items():
        room = Path(name).parts[0]
        if room in summed:
            summed[room].update(
                {key: value for key, value in file["summary"].items() if isinstance(value, int)}
            )
    statements: dict[tuple[str, int], bool] = {}
    for listed in counts.glob("*.lines"):
        for line in listed.read_text().splitlines():
            name, number, hit = line.rsplit(" ", 2)
            place = Path(name).relative_to(ROOT).as_posix(), int(number)
            statements[place] = statements.get(place, False) or hit == "1"
    rooms = {}
    for room, sums in summed.items():
        own = {place: hit for place, hit in statements.items() if place[0].startswith(f"{room}/")}
        rooms[room] = Room(
            (sums["covered_lines"], sums["num_statements"]),
            (sums["covered_branches"], sums["num_branches"]),
            (sum(own.values()), len(own)),
            [f"{name}:{line}" for (name, line), hit in sorted(own.items()) if not hit],
        )
    return rooms
