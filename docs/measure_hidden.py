"""Measure how many nodes of a COPC file are hidden behind others, at most.

Run as ``.venv/bin/python docs/measure_hidden.py [COPC]``. It looks at a scan of the terrain, which
it makes if there is none, and at ten walls behind one another, from some elevations. All points
that a view reads are the occluders, in blocks of 2 x 2 pixels, as if they were known before a node
is read, and each filled its block. So what is saved is a bound from above.
"""

from __future__ import annotations

import functools
import sys
import tempfile
from pathlib import Path

import laspy
import numpy as np

from splatline.cli.bench.large.make_copc import make_copc
from splatline.cli.bench.large.make_scan import make_scan
from splatline.host.large.nodes import CORNERS, choose_nodes
from splatline.host.large.plan import Plan, make_plan
from splatline.host.large.thin import CELLS, grid_of
from splatline.host.visibility.view import fit_view

BLOCK = 2
"""Pixels along the side of a block of the depth image."""

SCAN_POINTS = 2_000_000
WALLS, WALL_POINTS = 10, 100_000
VIEWS = ((30, 20), (30, 5), (0, 5))
"""Azimuth and elevation."""


def make_walls(folder: Path) -> Path:
    """Write walls of 10 x 10 metres, a metre from one another, that face along y."""
    rng = np.random.default_rng(1)
    x, z = rng.uniform(0, 10, (2, WALLS * WALL_POINTS))
    y = np.repeat(np.arange(float(WALLS)), WALL_POINTS)
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales, header.offsets = [0.001] * 3, [0.0] * 3
    las = laspy.LasData(header)
    las.x, las.y, las.z = x, y, z
    las.red = las.green = las.blue = np.full(len(x), 40_000)
    las.gps_time = np.arange(len(x), dtype=float)
    plain, octree = folder / "walls.laz", folder / "walls.copc.laz"
    las.write(plain)
    make_copc(plain, octree)
    return octree


def seen(plan: Plan, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return points' places in pixels, shape (..., 2), and their distances along the view."""
    view = plan.view
    along = (points - plan.origin - view.eye) @ view.axes.T
    ahead = np.maximum(along[..., 2], view.near)
    return np.array(view.middle) + view.focal * along[..., :2] / ahead[..., np.newaxis], ahead


def measure(name: str, path: Path, pixels: int, orbit: tuple[float, float]) -> str:
    """Return a row of the table: a square picture with ``pixels`` along its side."""
    fit = functools.partial(fit_view, size=(pixels, pixels), up="z", orbit=orbit)
    plan = make_plan([path], None, fit, 128)
    file = plan.files[0]
    octree = file.octree
    assert octree is not None
    needed = choose_nodes(octree, plan.view, plan.origin, grid_of(plan.view, CELLS, plan.farthest))
    nodes = octree.nodes[needed.needed]
    side = pixels // BLOCK
    depth = np.full((side, side), np.inf)
    read = []
    for node in range(len(nodes)):
        found = [
            seen(plan, columns.positions.astype(float))
            for columns in file.pieces(nodes=nodes[node : node + 1])
        ]
        places = np.floor(np.concatenate([each[0] for each in found]) / BLOCK).astype(int)
        ahead = np.concatenate([each[1] for each in found])
        inside = ((places >= 0) & (places < side)).all(axis=1)
        read.append((places[inside], ahead[inside]))
        np.minimum.at(depth, (places[inside, 1], places[inside, 0]), ahead[inside])
    points = sum(len(ahead) for _, ahead in read)
    # A point counts as hidden if it lies clearly behind its block's nearest.
    hidden_points = sum(
        int(np.count_nonzero(ahead > 1.01 * depth[places[:, 1], places[:, 0]]))
        for places, ahead in read
    )
    corners, sides = octree.cubes()
    corners, sides = corners[needed.needed], sides[needed.needed]
    cubes = corners[:, np.newaxis] + CORNERS * sides[:, np.newaxis, np.newaxis]
    places, ahead = seen(plan, cubes)
    low = np.clip(np.floor(places.min(axis=1) / BLOCK), 0, side - 1).astype(int)
    high = np.clip(np.floor(places.max(axis=1) / BLOCK), 0, side - 1).astype(int)
    by_cube = by_points = nodes_by_cube = nodes_by_points = 0
    for number, (own, distances) in enumerate(read):
        (x, y), (to_x, to_y) = low[number], high[number]
        if depth[y : to_y + 1, x : to_x + 1].max() < ahead[number].min():
            by_cube += len(distances)
            nodes_by_cube += 1
        if len(own) and (distances > 1.01 * depth[own[:, 1], own[:, 0]]).all():
            by_points += len(distances)
            nodes_by_points += 1
    return (
        f"| {name}, {orbit[0]}, {orbit[1]} | {len(nodes)} | {points:,} |"
        f" {hidden_points / points:.0%} | {nodes_by_points}, {by_points / points:.1%} |"
        f" {nodes_by_cube}, {by_cube / points:.1%} |"
    )


def main() -> None:
    """Print the table."""
    with tempfile.TemporaryDirectory() as folder:
        if len(sys.argv) > 1:
            scan = Path(sys.argv[1])
        else:
            plain, scan = Path(folder) / "scan.laz", Path(folder) / "scan.copc.laz"
            make_scan(plain, SCAN_POINTS)
            make_copc(plain, scan)
        walls = make_walls(Path(folder))
        print("| cloud, azimuth, elevation | nodes read | points in view | hidden points"
              " | nodes of hidden points | nodes with hidden cubes |")  # fmt: skip
        print("|---|---:|---:|---:|---:|---:|")
        for orbit in VIEWS:
            print(measure("terrain", scan, 1024, orbit), flush=True)
        for orbit in VIEWS:
            print(measure("walls", walls, 512, orbit), flush=True)


if __name__ == "__main__":
    main()
