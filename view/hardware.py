"""A picture in hardware: code words, cycles, frames a second, and points left out."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from splatline.contract.presets import PRESETS
from splatline.flow.area.budgets import read_budgets
from splatline.flow.timing.clocks import read_clocks
from splatline.sim.cycles.cycles import count_cycles

from .draw import Drawing

__all__ = ["PRESET_TITLES", "picture_numbers", "preset_facts"]

PRESET_TITLES = {
    "paper": "the paper's machine: 9-bit colour",
    "rgb24": "24-bit colour in the same FPGA",
    "lanes8": "fewer cycles for large splats",
    "swift": "a code word a cycle",
    "plane": "a depth for every pixel",
    "swift-plane": "both: a word a cycle, a depth for every pixel",
}
"""Purpose of each preset, in a few words."""


def preset_facts() -> list[dict[str, Any]]:
    """Return name, title, area and routed clock of every preset.

    ``lut4``, ``ff``, ``bram`` and ``mult`` are those of ``splatline synth``; ``clock_mhz`` and
    ``device`` those of ``splatline pnr``, None if they are not known.
    """
    areas, clocks = read_budgets(), read_clocks()
    facts = []
    for name in PRESETS:
        clock = clocks.get(name, {})
        facts.append(
            {
                "name": name,
                "title": PRESET_TITLES[name],
                **areas[name],
                "clock_mhz": clock.get("median_mhz"),
                "device": clock.get("device"),
            }
        )
    return facts


def picture_numbers(drawing: Drawing, check: Callable[[], None] = lambda: None) -> dict[str, Any]:
    """Return what an engine needs for a picture, over all its samples and tiles.

    Parameters
    ----------
    drawing
        The picture.
    check
        Called before each frame's cycles are counted, which takes as long as drawing it twice. It
        may raise an exception, which ends the counting.

    Returns
    -------
    dict
        ``codewords``, ``elements``, ``points``; ``left_out``: points of the view that were not
        drawn, by reason, over the samples; ``cycles``: of all frames one after the other, the
        window clear before each; ``cycles_per_element``, ``clock_mhz``: the preset's routed clock,
        and ``fps``: pictures a second at it, each None if there is none; ``tiles``, ``samples``,
        ``width`` and ``height``; ``host_ms`` and ``golden_ms``: what host and golden renderer took.
    """
    counts = drawing.counts
    config = drawing.rasters[0].config
    cycles = 0
    for frame in drawing.frames:
        check()
        cycles += count_cycles(frame, after_reset=False)
    elements = int(counts["elements"])
    clock = read_clocks().get(config.name, {}).get("median_mhz")
    return {
        "codewords": int(counts["codewords"]),
        "elements": elements,
        "points": int(counts["points"]),
        "left_out": {name: int(count) for name, count in counts["culled"].items() if count},
        "cycles": cycles,
        "cycles_per_element": cycles / elements if elements else None,
        "clock_mhz": clock,
        "fps": 1e6 * clock / cycles if clock and cycles else None,
        "tiles": int(counts.get("tiles", 1)) + int(counts.get("tiles_empty", 0)),
        "samples": int(counts["samples"]),
        "host_ms": 1e3 * sum(counts["seconds"].values()),
        "golden_ms": 1e3 * drawing.golden_seconds,
        "width": drawing.view.width,
        "height": drawing.view.height,
    }
