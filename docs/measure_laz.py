"""Measure how fast a LAZ file becomes a cloud, beside lazrs alone.

Run as ``.venv/bin/python docs/measure_laz.py [POINTS]``. It writes the terrain with noise, colours
and map coordinates as LAZ (LAS 1.4, point format 7) to a temporary folder, and reads it. It prints
seconds of processor time, the least of three runs, as other processes slow down the clock.
"""

import sys
import tempfile
import time
from pathlib import Path

import laspy
import numpy as np

from splatline.host import load_scene
from splatline.host.files.read_las import read_las
from splatline.host.files.source import open_source

FIELDS = ("XY_RETURNS_CHANNEL", "Z", "CLASSIFICATION", "FLAGS", "RGB")
"""The fields that ``read_las`` decompresses of a file with colours."""

PIECE = 1 << 20


def write_scan(path, count):
    """Write ``count`` points about those of the terrain, in strips as a scanner has them."""
    cloud, random = load_scene("terrain").cloud, np.random.default_rng(1)
    chosen = random.integers(0, len(cloud), count)
    size = float(np.ptp(cloud.positions, axis=0).max())
    places = cloud.positions[chosen] + random.normal(scale=1e-3 * size, size=(count, 3))
    order = np.lexsort((places[:, 0], np.floor(1000.0 * places[:, 2] / size)))
    places, colours = places[order] * (1000.0 / size), cloud.colours[chosen[order]]
    header = laspy.LasHeader(version="1.4", point_format=7)
    header.scales, header.offsets = np.full(3, 0.001), np.array([5e5, 5.4e6, 0.0])
    scan = laspy.LasData(header)
    scan.x, scan.y, scan.z = places[:, 0] + 5e5, 5.4e6 - places[:, 2], places[:, 1]
    scan.red, scan.green, scan.blue = (colours.astype(np.uint16) * 257).T
    scan.intensity = random.integers(0, 1 << 16, count)
    scan.gps_time = 1e-5 * np.arange(count)
    scan.write(path)


def decompress(path, selection):
    """Decompress all points with lazrs, and keep none."""
    with laspy.open(path, decompression_selection=selection) as scan:
        while scan.points_read < scan.header.point_count:
            scan.read_points(PIECE)


def read(path):
    """Read the columns of a cloud."""
    with open_source(path) as source:
        read_las(source)


def seconds(call):
    """Return the least processor time of three calls."""
    times = []
    for _ in range(3):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def main():
    """Print the table."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000
    chosen = laspy.DecompressionSelection.base()
    for field in FIELDS:
        chosen |= laspy.DecompressionSelection[field]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scan.laz"
        write_scan(path, count)
        print(f"{count:,} points, {path.stat().st_size:,} bytes\n")
        print("| | processor time, s |\n|---|---:|")
        for name, call in (
            ("lazrs, every field", lambda: decompress(path, laspy.DecompressionSelection.all())),
            ("lazrs, the fields that are drawn", lambda: decompress(path, chosen)),
            ("laspy.read", lambda: laspy.read(path)),
            ("**read_las, coordinates and colours as columns**", lambda: read(path)),
        ):
            print(f"| {name} | {seconds(call):.1f} |")


if __name__ == "__main__":
    main()
