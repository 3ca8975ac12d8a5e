"""Plots of ``bench accuracy``: cost against error with the Pareto front, and the error budget."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .pareto import front
from .sheet import FAINT, INK, PAPER, RULE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_pareto", "plot_pareto_scenes", "plot_waterfall"]

_Rows = Sequence[Mapping[str, Any]]

COLOURS = {"paper": "#ff9f6b", "fast": "#6cc5ff", "exact": "#7ddc9a"}
"""Colours of the qualities."""

MARKERS = "osD^vPX*"
"""Markers of the presets, in the order of the runs."""

LOSS, GAIN = "#ff7a70", "#7ddc9a"
"""Colours of a step that lowers, and that raises the PSNR."""

AXES = {
    "seconds": "host + golden, processor ms",
    "cycles_per_element": "clock cycles an element",
}
"""Costs, and the labels of their axes."""


def plot_pareto(points: _Rows) -> bytes:
    """Return the plot of cost against error over all scenes, as a PNG.

    Parameters
    ----------
    points
        One entry for each way and preset, with the keys ``quality``, ``samples``, ``way`` (the name
        of both), ``preset``, ``psnr_db``, ``seconds`` and ``cycles_per_element`` (or None). A cost
        that no point has gets no panel.
    """
    costs = [cost for cost in AXES if any(point.get(cost) is not None for point in points)]
    figure, axes = _figure(len(costs), 1, 6.6, 5.4)
    markers = _markers(points)
    for column, cost in enumerate(costs):
        _draw_front(axes[0][column], points, cost, markers, named=True)
        axes[0][column].set_xlabel(AXES[cost], color=INK)
    axes[0][0].set_ylabel("PSNR, dB, mean over the scenes", color=INK)
    _legend(figure, markers, points)
    return _save(figure)


def plot_pareto_scenes(scenes: Mapping[str, _Rows]) -> bytes:
    """Return the plot of run time against error, a panel for each scene, as a PNG."""
    columns = min(len(scenes), 4)
    lines = -(-len(scenes) // columns)
    figure, axes = _figure(columns, lines, 3.7, 3.5)
    panels = [panel for line in axes for panel in line]
    every = [point for points in scenes.values() for point in points]
    markers = _markers(every)
    for panel, (name, points) in zip(panels, scenes.items(), strict=False):
        _draw_front(panel, points, "seconds", markers, named=False)
        panel.set_title(name, color=INK, fontsize=11, loc="left")
    for panel in panels[len(scenes) :]:
        panel.set_visible(False)
    for line in axes:
        line[0].set_ylabel("PSNR, dB", color=INK)
    for panel in panels[max(len(scenes) - columns, 0) : len(scenes)]:
        panel.set_xlabel(AXES["seconds"], color=INK)
    _legend(figure, markers, every)
    return _save(figure)


def plot_waterfall(ladders: Sequence[tuple[str, Mapping[str, Sequence[float]]]]) -> bytes:
    """Return the plot of error budgets, a panel for each, as a PNG.

    Parameters
    ----------
    ladders
        Pairs of a title and a mapping from the name of each step to the PSNR in dB of every scene.
        The last step is the engine's picture.
    """
    from matplotlib.ticker import MaxNLocator

    columns = min(len(ladders), 2)
    lines = -(-len(ladders) // columns)
    figure, axes = _figure(columns, lines, 6.8, 4.6)
    panels = [panel for line in axes for panel in line]
    for panel in panels[len(ladders) :]:
        panel.set_visible(False)
    low = min(min(map(min, steps.values())) for _, steps in ladders)
    high = max(max(map(max, steps.values())) for _, steps in ladders)
    for panel, (title, steps) in zip(panels, ladders, strict=False):
        panel.set_title(title, color=INK, fontsize=11, loc="left")
        panel.set_ylim(math.floor(low) - 0.5, math.ceil(high) + 0.5)
        panel.yaxis.set_major_locator(MaxNLocator(integer=True))
        _draw_ladder(panel, steps, math.floor(low) - 0.5)
    for line in axes:
        line[0].set_ylabel("PSNR, dB", color=INK)
    return _save(figure)


def _draw_ladder(panel: Axes, steps: Mapping[str, Sequence[float]], floor: float) -> None:
    """Draw one error budget: full bars for its ends, and the change of each step between."""
    means = [math.fsum(values) / len(values) for values in steps.values()]
    last = len(means) - 1
    for step, (mean, values) in enumerate(zip(means, steps.values(), strict=True)):
        if step in (0, last):
            panel.bar(step, mean - floor, 0.7, floor, color="#5b6675")
            panel.text(step, mean + 0.2, f"{mean:.2f}", color=INK, ha="center", fontsize=9)
        else:
            change = mean - means[step - 1]
            colour = LOSS if change < 0.0 else GAIN
            panel.bar(step, change, 0.7, means[step - 1], color=colour)
            top = max(mean, means[step - 1])
            panel.text(step, top + 0.15, f"{change:+.2f}", color=INK, ha="center", fontsize=9)
        if step < last:
            panel.plot([step - 0.35, step + 1.35], [mean, mean], color=FAINT, linewidth=0.8)
        if len(values) > 1:
            aside = [step + 0.43] * len(values)
            panel.plot(aside, values, "o", color=INK, markersize=2.2, alpha=0.55)
    panel.set_xticks(range(len(means)), list(steps), rotation=35, ha="right", color=INK)
    panel.set_xlim(-0.6, last + 0.6)


def _draw_front(
    panel: Axes, points: _Rows, cost: str, markers: Mapping[str, str], *, named: bool
) -> None:
    """Draw the points of a panel and their Pareto front."""
    points = [point for point in points if point.get(cost) is not None]
    if not points:
        return
    factor = 1e3 if cost == "seconds" else 1.0
    costs = [factor * point[cost] for point in points]
    values = [point["psnr_db"] for point in points]
    members = front(costs, values)
    panel.plot(
        [costs[i] for i in members],
        [values[i] for i in members],
        color=INK,
        linewidth=1.2,
        drawstyle="steps-post",
        zorder=1,
    )
    for i, point in enumerate(points):
        panel.plot(
            costs[i],
            values[i],
            markers[point["preset"]],
            color=COLOURS[point["quality"]],
            markersize=_size(point["samples"]),
            markeredgecolor=INK if i in members else PAPER,
            markeredgewidth=1.2,
        )
    panel.set_xscale("log")
    _ticks(panel, costs)
    panel.margins(0.4 if named else 0.12, 0.12)
    if named:
        names = [f"{points[i]['way']} {points[i]['preset']}" for i in members]
        _name_front(panel, [costs[i] for i in members], [values[i] for i in members], names)


def _name_front(
    panel: Axes, costs: Sequence[float], values: Sequence[float], names: Sequence[str]
) -> None:
    """Write the names of the front's points to their left, where no point is, without overlap."""
    line, letter = 11.0, 5.4  # height of a line and width of a letter, in points
    figure = panel.get_figure(root=True)
    assert figure is not None
    figure.draw_without_rendering()  # settles the layout, and so the positions of the points
    before, lowest = -math.inf, -math.inf
    for cost, value, name in zip(costs, values, names, strict=True):
        x, y = panel.transData.transform((cost, value)) * 72.0 / figure.dpi
        base = max(y, lowest) if x < before + letter * len(name) else y
        panel.annotate(
            name, (cost, value), (-7, base - y), textcoords="offset points",
            color=INK, fontsize=8.5, ha="right", va="bottom",
        )  # fmt: skip
        before, lowest = x, base + line


def _ticks(panel: Axes, costs: Sequence[float]) -> None:
    """Set plain numbers as ticks of a logarithmic axis, denser if it spans less."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

    wide = max(costs) > 8.0 * min(costs)
    steps = (1.0, 2.0, 5.0) if wide else (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)
    panel.xaxis.set_major_locator(LogLocator(subs=steps))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    panel.xaxis.set_minor_locator(NullLocator())
    panel.xaxis.set_minor_formatter(NullFormatter())


def _size(samples: int) -> float:
    """Return the size of the marker for a number of samples a pixel."""
    return 7.5 + 1.5 * math.log2(samples)


def _markers(points: _Rows) -> dict[str, str]:
    """Return a marker for each preset."""
    presets = dict.fromkeys(point["preset"] for point in points)
    return {preset: MARKERS[n % len(MARKERS)] for n, preset in enumerate(presets)}


def _legend(figure: Figure, markers: Mapping[str, str], points: _Rows) -> None:
    """Add the legend of colours, markers and sizes, to the right of all panels."""
    from matplotlib.lines import Line2D

    entries = [
        Line2D([], [], color=colour, marker="o", linestyle="", label=f"quality {quality}")
        for quality, colour in COLOURS.items()
    ]
    entries += [
        Line2D([], [], color=FAINT, marker=marker, linestyle="", label=f"preset {preset}")
        for preset, marker in markers.items()
    ]
    entries += [
        Line2D([], [], color=FAINT, marker="o", linestyle="", markersize=_size(samples),
               label=f"{samples} samples a pixel")
        for samples in sorted({point["samples"] for point in points} - {1})
    ]  # fmt: skip
    entries.append(Line2D([], [], color=INK, linewidth=1.2, label="front"))
    figure.legend(
        handles=entries, loc="outside right center", frameon=False, labelcolor=INK, fontsize=9
    )


def _figure(columns: int, lines: int, wide: float, high: float) -> tuple[Figure, list[list[Axes]]]:
    """Return a figure and its panels, each ``wide`` x ``high`` inches."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(columns * wide, lines * high), facecolor=PAPER, layout="constrained")
    axes: list[list[Axes]] = figure.subplots(lines, columns, squeeze=False).tolist()
    for panel in (panel for line in axes for panel in line):
        panel.set_facecolor(PAPER)
        panel.grid(True, color=RULE, linewidth=0.7)
        panel.set_axisbelow(True)
        panel.tick_params(colors=FAINT, labelsize=9)
        for spine in panel.spines.values():
            spine.set_color(RULE)
    return figure, axes


def _save(figure: Figure) -> bytes:
    """Return a figure as a PNG."""
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=110, facecolor=PAPER)
    return data.getvalue()
