"""Printed tables of a synthesis report; the JSON report has the same numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.table import Table

__all__ = ["RESOURCES", "describe_excess", "print_synthesis"]

RESOURCES = {
    "lut4": "4-input LUTs",
    "ff": "flip-flops",
    "bram": "block RAMs",
    "mult": "multipliers",
}
"""Names of the kinds of resource."""

COLUMNS = {"instances": "instances", "lut4": "LUTs", "ff": "FFs", "bram": "RAMs", "mult": "mult."}
"""Headings of the modules' table, short enough for 80 characters."""


def print_synthesis(report: Mapping[str, Any]) -> None:
    """Print an engine's resources beside the paper's Table 1, its modules and its longest path."""
    from rich.console import Console

    console = Console()
    console.print(_whole(report))
    fitting = (
        f"{name or 'none'} ({family})" for family, name in report["smallest_devices"].items()
    )
    console.print(f"Smallest devices: {', '.join(fitting)}", highlight=False)
    console.print(_modules(report["groups"]))
    path = report["longest_path"]
    parts = [(path["luts"], "LUTs"), (path["carries"], "carries")]
    parts += [(path["multipliers"], "multipliers")] if path["multipliers"] else []
    through = ", ".join(f"{number} {name}" for number, name in parts)
    console.print(
        f"Longest logic path: {path['levels']} levels ({through}; a chain of carries is one level)"
        f"\n  from {path['start']}\n  to   {path['end']}",
        highlight=False,
        markup=False,
        soft_wrap=True,
    )


def describe_excess(report: Mapping[str, Any]) -> str:
    """Return a line with the resources that exceed the budget, and by how much."""
    parts = [
        f"{report[kind]:,} {RESOURCES[kind]}, {excess:,} more than recorded"
        for kind, excess in report["over_budget"].items()
    ]
    return "; ".join(parts)


def _whole(report: Mapping[str, Any]) -> Table:
    """Return the table of the whole engine."""
    from rich.table import Table

    device = report["device"]
    top = {"engine": "", "pins": " with pins"}.get(report["top"], f" with {report['top']}")
    table = Table(
        title=f"Preset {report['preset']}{top} on {device['name']}",
        title_justify="left",
        caption=report["command"],
        caption_justify="left",
    )
    table.add_column("resource", style="bold")
    for heading in ("this design", "paper, Table 1", "difference", "budget", "device"):
        table.add_column(heading, justify="right")
    for kind, label in RESOURCES.items():
        used, available, paper = report[kind], device[kind], report["paper"].get(kind)
        apart, budget = report["difference"].get(kind), (report["budget"] or {}).get(kind)
        table.add_row(
            label,
            f"{used:,} ({used / available:.0%})",
            "-" if paper is None else f"{paper:,}",
            "-" if apart is None else f"{apart['absolute']:+,} ({apart['percent']:+.0f}%)",
            "-" if budget is None else f"{budget:,}",
            f"{available:,}",
            style="red" if used > available or kind in report["over_budget"] else "",
        )
    return table


def _modules(groups: Iterable[Mapping[str, Any]]) -> Table:
    """Return the table of the modules and their sum."""
    from rich.table import Table

    groups = list(groups)
    table = Table(
        title="By module, each without its submodules",
        title_justify="left",
        caption="Counted with the hierarchy kept; the engine itself is optimised flat",
        caption_justify="left",
        show_footer=True,
    )
    table.add_column("module", "sum", style="bold", no_wrap=True)
    for key, label in COLUMNS.items():
        table.add_column(label, f"{sum(group[key] for group in groups):,}", justify="right")
    for group in groups:
        table.add_row(group["name"], *(f"{group[key]:,}" for key in COLUMNS))
    return table
