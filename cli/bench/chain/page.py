"""The Markdown page of ``splatline bench chain``, and the rates derived from its cycles."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from splatline.cli.bench.markdown import table
from splatline.host.encode.partition_methods import DEFAULT_METHOD, METHODS

__all__ = ["TARGETS", "page", "rate"]

TARGETS = {4: 3.8, 8: 7.0}
"""Target for the speed-up, by number of engines."""

PAPER_IDLE = 0.02
PAPER_RATE = 1e8
"""The paper's formula (3): an image of N elements takes max(0.02 s, N / 10^8)."""

_Run = dict[str, Any]


def rate(runs: Sequence[_Run], clocks_mhz: Mapping[str, float | None]) -> list[_Run]:
    """Return runs with the figures that follow from their cycles.

    ``speedup`` is over one engine that gets the elements in the same order, ``speedup_host`` over
    one engine that gets them in the host's order. ``bound`` is the largest possible ``speedup``,
    since one raster word leaves in a cycle. ``seconds`` and ``video_fps`` are at the preset's clock
    rate, ``paper_seconds`` by the paper's formula. A figure is None if its comparison or its clock
    rate is missing.
    """
    alone = {
        (run["scene"], run["preset"], run["method"]): run["cycles"]
        for run in runs
        if run["engines"] == 1
    }
    rated = []
    for run in runs:
        host = alone.get((run["scene"], run["preset"], "elements"))
        # Whole lines keep the host's order, so one engine takes the same time.
        same = alone.get((run["scene"], run["preset"], run["method"]), host)
        least = None if same is None else max(same / run["engines"], run["beats"])
        clock = clocks_mhz[run["preset"]]
        rated.append(
            {
                **run,
                "speedup": None if same is None else round(same / run["cycles"], 3),
                "speedup_host": None if host is None else round(host / run["cycles"], 3),
                "bound": None if same is None or least is None else round(same / least, 3),
                "seconds": None if clock is None else run["cycles"] / clock / 1e6,
                "paper_seconds": max(PAPER_IDLE, run["elements"] / PAPER_RATE),
                "video_fps": _fps(run["video_cycles"], clock),
                "video_table_fps": _fps(run["video_table_cycles"], clock),
            }
        )
    return rated


def _fps(cycles: int | None, clock_mhz: float | None) -> float | None:
    return None if cycles is None or clock_mhz is None else round(clock_mhz * 1e6 / cycles, 1)


def page(report: dict[str, Any]) -> str:
    """Return the report as Markdown."""
    runs = report["runs"]
    width, height = report["size"]
    versions = ", ".join(f"{name} {number}" for name, number in report["versions"].items())
    merged = [run for run in runs if run["link"] == "merge"]
    first = runs[0]["scene"]
    rates = ", ".join(
        f"{name} {'unknown' if clock is None else f'{clock:g} MHz'}"
        for name, clock in report["clock_mhz"].items()
    )
    parts = [
        "# Chains of engines",
        f"Made by `splatline bench chain`: {width} x {height} pixels, splats of 2.5 pixels;"
        f" {versions}. Verilator counts cycles from the first code word to the end beat. Every"
        " picture was compared with the golden renderer's:"
        f" {sum(run['mismatched_pixels'] for run in runs):,} pixels differ. Times are at"
        f" the clock rate of one engine routed on an ECP5 (`splatline pnr`): {rates};"
        " no chain was routed.",
        "Speed-up is relative to one engine that gets the elements in the same order, or in the"
        " host's own order. One raster word leaves in a cycle, which bounds the speed-up: a chain"
        " takes at least as many cycles as the raster has words, and at least the share of each"
        " engine in the cycles of one. A scene that fills the image reaches this bound.",
        "## Targets",
        table(
            ("engines", "preset", "scene", "speed-up", "at least", "bound", "met"),
            _verdicts(merged),
            words=("preset", "scene", "met"),
        ),
        "## Engines",
        f"Partition method `{DEFAULT_METHOD}`, link `merge`. The paper's time is by its formula"
        " (3), max(0.02 s, N / 10^8), for its four engines.",
        table(
            (
                *("scene", "preset", "engines", "elements", "raster words", "cycles", "speed-up"),
                *("over host's order", "bound", "ms", "paper, ms", "fill, cycles", "drain, cycles"),
            ),
            (_engines(run) for run in merged if run["method"] == DEFAULT_METHOD),
            words=("scene", "preset"),
        ),
        "Fill is the time from the first code word to the raster's first beat. Drain is the time"
        " from the last end word to the end beat.",
        "## Video",
        "Frames in succession, without table writes and with all tables written before each frame."
        " Table writes wait until the frame before has left the engine. Idle is the time from an"
        " engine's end word to its first code word of the next frame, the mean over the engines.",
        table(
            (
                *("scene", "preset", "engines", "cycles a frame", "frames/s", "idle, cycles"),
                *("with tables", "frames/s", "idle, cycles", "table writes"),
            ),
            (_video(run) for run in merged if run["method"] == DEFAULT_METHOD),
            words=("scene", "preset"),
        ),
        f"## Partition methods and links: {first}",
        "\n".join(f"- `{name}`: {meaning}." for name, meaning in METHODS.items())
        + "\n- Link `load`: each engine loads the picture so far and draws over it.",
        table(
            ("preset", "link", "method", "engines", "cycles", "speed-up", "over host's order"),
            (_method_row(run) for run in runs if run["scene"] == first),
            words=("preset", "link", "method"),
        ),
    ]
    return "\n\n".join(parts) + "\n"


def _verdicts(runs: Sequence[_Run]) -> Iterable[tuple[str, ...]]:
    for run in runs:
        least = TARGETS.get(run["engines"])
        if run["method"] == DEFAULT_METHOD and least is not None:
            yield (
                f"{run['engines']}",
                run["preset"],
                run["scene"],
                _number(run["speedup"]),
                f"{least:g}",
                _number(run["bound"]),
                "yes" if run["speedup"] >= least else "**no**",
            )


def _engines(run: _Run) -> tuple[str, ...]:
    return (
        run["scene"],
        run["preset"],
        f"{run['engines']}",
        f"{run['elements']:,}",
        f"{run['beats']:,}",
        f"{run['cycles']:,}",
        _number(run["speedup"]),
        _number(run["speedup_host"]),
        _number(run["bound"]),
        _number(None if run["seconds"] is None else 1e3 * run["seconds"]),
        f"{1e3 * run['paper_seconds']:.2f}",
        f"{run['fill_cycles']:,}",
        f"{run['drain_cycles']:,}",
    )


def _video(run: _Run) -> tuple[str, ...]:
    return (
        run["scene"],
        run["preset"],
        f"{run['engines']}",
        f"{run['video_cycles']:,}",
        _whole(run["video_fps"]),
        _whole(run["idle_cycles"]),
        f"{run['video_table_cycles']:,}",
        _whole(run["video_table_fps"]),
        _whole(run["idle_table_cycles"]),
        f"{run['table_writes']}",
    )


def _method_row(run: _Run) -> tuple[str, ...]:
    return (
        run["preset"],
        run["link"],
        run["method"],
        f"{run['engines']}",
        f"{run['cycles']:,}",
        _number(run["speedup"]),
        _number(run["speedup_host"]),
    )


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _whole(value: float | None) -> str:
    return "-" if value is None else f"{value:,.0f}"
