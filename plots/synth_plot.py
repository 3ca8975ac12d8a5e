"""The plot of ``splatline synth``: resources of the engine, of the paper's, and of each module."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .sheet import FAINT, INK, PAPER, RULE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["plot_synthesis"]

PANELS = {"lut4": "4-input LUTs", "ff": "flip-flops"}
"""Kinds of resource that have a panel, and their names."""

OURS, THEIRS, PART = "#7ddc9a", "#ff9f6b", "#6cc5ff"
"""Colours of this engine, the paper's engine, and a module."""

LIMIT = "#ff7a70"
"""Colour of the device's limit."""

SMALLEST = 0.01
"""Least share of the largest bar for a module to get a row, in either panel."""


def plot_synthesis(report: Mapping[str, Any]) -> bytes:
    """Return the plot of an engine's resources, as a PNG.

    Parameters
    ----------
    report
        Result of ``flow.area.synth.synthesise``.
    """
    from matplotlib.figure import Figure

    rows = _rows(report)
    height = 1.6 + 0.32 * len(rows)
    figure = Figure(figsize=(12.0, height), facecolor=PAPER, layout="constrained")
    axes: list[Axes] = figure.subplots(1, len(PANELS), sharey=True).tolist()
    for panel, (kind, title) in zip(axes, PANELS.items(), strict=True):
        _draw(panel, rows, kind, report["device"][kind])
        device = report["device"]
        limit = f"{device[kind]:,} in an {device['name']} (dashed)"
        panel.set_title(f"{title}, of {limit}", color=INK, loc="left", fontsize=11)
    names = [row["name"] for row in rows]
    axes[0].set_yticks(range(len(rows)), names, color=INK)
    axes[0].invert_yaxis()
    figure.supxlabel(
        "Modules are counted with the hierarchy kept; the engine is optimised as a whole, so that"
        " they do not sum up to it.",
        color=FAINT,
        fontsize=9,
    )
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=110, facecolor=PAPER)
    return data.getvalue()


def _rows(report: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the rows from the top: engine, paper's engine, then modules, the largest first."""
    most = max(report[kind] for kind in PANELS)
    parts = [
        {**group, "colour": PART}
        for group in report["groups"]
        if max(group[kind] for kind in PANELS) >= SMALLEST * most
    ]
    parts.sort(key=lambda group: -group["lut4"])
    whole = {kind: report[kind] for kind in PANELS}
    return [
        {"name": f"{report['top']}, preset {report['preset']}", "colour": OURS, **whole},
        {"name": "the paper's engine", "colour": THEIRS, **report["paper"]},
        *parts,
    ]


def _draw(panel: Axes, rows: Sequence[Mapping[str, Any]], kind: str, available: int) -> None:
    """Draw the bar and the number of each row, and a line at the device's limit."""
    values = [row[kind] for row in rows]
    panel.barh(range(len(rows)), values, 0.68, color=[row["colour"] for row in rows])
    for row, value in enumerate(values):
        inside = value > 0.9 * available
        panel.text(
            value + (-0.008 if inside else 0.008) * available,
            row,
            f"{value:,}",
            color=PAPER if inside else INK,
            fontsize=9,
            va="center",
            ha="right" if inside else "left",
        )
    panel.axvline(available, color=LIMIT, linewidth=1.0, linestyle="--")
    panel.axhline(1.5, color=RULE, linewidth=1.0)
    panel.set_xlim(0.0, 1.06 * max(available, *values))
    panel.set_facecolor(PAPER)
    panel.grid(True, axis="x", color=RULE, linewidth=0.7)
    panel.set_axisbelow(True)
    panel.tick_params(colors=FAINT, labelsize=9, length=0)
    for spine in panel.spines.values():
        spine.set_color(RULE)
