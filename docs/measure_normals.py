"""Measure how far estimated normals of scans and of samples of them are off.

Run as ``.venv/bin/python docs/measure_normals.py SCAN ...``. A scan has normals. A dense sample has
points of its discs, with the normals of these, and a noisy one the same points with noise; both are
those of ``splatline bench surface``. The first row is the built-in terrain as an aeroplane scans
it, in lines (``cli/bench/large/make_scan.py``), compared with the terrain.

Normals are estimated from the positions alone, and compared with those that were there. Printed are
the share of those more than 45 degrees off, and the mean angle. The sign of a normal does not
count.
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np

from splatline.cli.bench.large import make_scan
from splatline.cli.bench.machine import described
from splatline.cli.bench.surface.measure import samples_of
from splatline.host import read_cloud
from splatline.host.cloud.normals import estimate_normals
from splatline.host.scenes.terrain import terrain_patches

LINES = 2_000_000
"""Points of the scan in lines."""


def judged(positions, normals):
    """Return a cell: the share of wrong normals in percent, and the mean angle in degrees."""
    cosines = np.abs(np.einsum("ij,ij->i", estimate_normals(positions), normals))
    angles = np.degrees(np.arccos(np.minimum(cosines, 1.0)))
    return f"{100.0 * np.mean(angles > 45.0):.2f}, {angles.mean():.1f}"


def judged_lines():
    """Return the cell of the scan in lines."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "lines.laz"
        make_scan.make_scan(file, LINES)
        positions = read_cloud(file).positions
    (terrain,) = terrain_patches()
    _, normals, _ = terrain.at(*make_scan._places(np.arange(LINES), LINES))
    return judged(positions, normals)


def main():
    """Print a row for each scan."""
    parser = argparse.ArgumentParser()
    parser.add_argument("scans", nargs="*", type=Path)
    options = parser.parse_args()
    print(f"{described()}\n")
    print("| scan | its points: %, degrees | dense | noisy |\n|---|---:|---:|---:|")
    print(f"| terrain, in lines | {judged_lines()} | | |", flush=True)
    for path in options.scans:
        scan, dense, noisy = (cloud for _, cloud in samples_of(read_cloud(path)))
        cells = judged(scan.positions, scan.normals), judged(dense.positions, dense.normals)
        print(f"| {path.stem} | {' | '.join(cells)} | {judged(noisy.positions, dense.normals)} |")


if __name__ == "__main__":
    main()
