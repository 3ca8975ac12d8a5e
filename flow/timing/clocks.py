"""The routed clock of each preset, recorded in ``clocks.json``.

``splatline pnr --preset NAME --record`` records one: of the narrow top, or with ``--top axi`` of
the AXI top as ``NAME, axi``. A clock needs minutes of routing, and depends
on the seeds and the tools' versions; the file says which.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from splatline.flow.records import read_records, record_row

__all__ = ["CLOCKS", "read_clocks", "record"]

CLOCKS = Path(__file__).with_name("clocks.json")
"""Of each preset ``device``, ``seeds``, ``median_mhz``, ``low_mhz``, ``high_mhz`` and ``command``;
``device`` is null if the preset is not known to fit an ECP5. Clocks are null if four seeds were not
routed."""


def read_clocks() -> dict[str, dict[str, Any]]:
    """Return the recorded clocks, by preset."""
    return read_records(CLOCKS)


def record(result: dict[str, Any]) -> None:
    """Record the clock of a preset.

    Parameters
    ----------
    result
        As of ``place_and_route``.
    """
    rates = result["rates_mhz"]
    top = "" if result["top"] == "pins" else f" --top {result['top']}"
    seeds = [int(seed) for seed in rates]
    clock = {
        "device": result["device"],
        "seeds": seeds,
        "median_mhz": round(result["median_mhz"], 1),
        "low_mhz": round(min(rates.values()), 1),
        "high_mhz": round(max(rates.values()), 1),
        "command": f"splatline pnr --preset {result['preset']}{top} --seed {seeds[0]}"
        f" --tries {len(seeds)} --record",
    }
    name = result["preset"] if result["top"] == "pins" else f"{result['preset']}, {result['top']}"
    record_row(CLOCKS, name, clock)
