"""Count the pixels in which the Verilog differs from golden, over scans, presets and stalls.

Run as ``.venv/bin/python docs/measure_mismatches.py SCAN...``. Each line is one
``splatline render --engine rtl`` of 512 x 512 pixels: a scan or a built-in scene, a preset, samples
a pixel, and the share of cycles in which each port stalls. It prints the clock cycles and the
pixels unlike golden, and ends with 1 if there is one. It takes about a minute a scan and preset.
"""

import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from splatline.cli.bench.machine import described

PLAIN = ("paper", "rgb24", "lanes8", "swift")
"""Presets that draw one sample, without stalls and with them."""

PLANES = ("plane", "swift-plane")
"""Presets that draw four samples as well."""

SPLATLINE = Path(sys.executable).with_name("splatline")


def main(scans):
    """Draw, and print a line each; return whether a pixel differs."""
    print(described())
    print("| cloud | preset | samples | stall | clock cycles | pixels unlike golden |")
    print("|---|---|---:|---:|---:|---:|")
    ways = [
        *itertools.product(PLAIN, (1,), (0.0, 0.3)),
        *itertools.product(PLANES, (1, 4), (0.0, 0.3)),
    ]
    clouds = [("--scene", "terrain"), ("--scene", "knot"), *((scan,) for scan in scans)]
    total = 0
    for cloud, (preset, samples, stall) in itertools.product(clouds, ways):
        counted = draw(cloud, preset, samples, stall)
        unlike = counted["mismatched_pixels"]
        total += unlike
        name = Path(cloud[-1]).stem
        print(
            f"| {name} | {preset} | {samples} | {stall:g} | {counted['cycles']:,} | {unlike} |",
            flush=True,
        )
    print(f"\n{total} pixels unlike golden in {len(clouds) * len(ways)} pictures")
    return total > 0


def draw(cloud, preset, samples, stall):
    """Draw a picture by the Verilog; return its statistics."""
    with tempfile.TemporaryDirectory() as folder:
        stats = Path(folder) / "stats.json"
        command = [SPLATLINE, "render", *cloud, "--engine", "rtl", "--preset", preset]
        command += ["--samples", samples, "--stall", stall, "--stats", stats]
        command += ["-o", Path(folder) / "picture.png"]
        subprocess.run(list(map(str, command)), check=True, capture_output=True)
        return json.loads(stats.read_text())


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
