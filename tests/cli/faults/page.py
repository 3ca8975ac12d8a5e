"""The host's part of ``docs/faults.md``, and the numbers behind it, ``docs/host_faults.json``."""

import json
import platform
from importlib import metadata
from pathlib import Path

__all__ = ["write_page"]

BEGIN, END = "<!-- host -->", "<!-- end of host -->"
"""Lines of the page between which the table stands."""

TOOLS = ("splatline", "numpy", "numba", "pillow", "laspy")


def write_page(folder: Path, tallies: dict[str, dict]) -> None:
    """Write the numbers, and put the table into the page."""
    numbers = {
        "tools": {
            "python": platform.python_version(),
            **{tool: metadata.version(tool) for tool in TOOLS},
        },
        "kinds": tallies,
    }
    (folder / "host_faults.json").write_text(json.dumps(numbers, indent=1) + "\n")
    page = folder / "faults.md"
    before, rest = page.read_text().split(BEGIN)
    _, after = rest.split(END)
    page.write_text(f"{before}{BEGIN}\n{_table(numbers)}{END}{after}")


def _table(numbers: dict) -> str:
    rows = [
        "| trials of | trials | done | refused | killed | wrong |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for kind, tally in numbers["kinds"].items():
        found = tally["outcomes"]
        if not found:
            continue
        counts = [
            sum(found.values()),
            *(found.get(each, 0) for each in ("done", "refused", "killed")),
        ]
        cells = [*(f"{count:,}" if count else "" for count in counts), str(len(tally["wrong"]))]
        rows.append(f"| {kind} | {' | '.join(cells)} |")
    made = ", ".join(f"{tool} {version}" for tool, version in numbers["tools"].items())
    return "\n".join([*rows, "", f"A trial's number is its seed. Made with {made}.", ""])
