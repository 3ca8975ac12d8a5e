"""Measure the golden renderer's rate on one core.

Run as ``taskset -c 0 .venv/bin/python docs/measure_golden.py``. Splats of 2 to 4 pixels at random
places of a 512 x 512 image, and the built-in scenes. Prints a table.
"""

import os
import time

import numpy as np

from splatline.host import fit_view, load_scene, make_frame, splat_radii
from splatline.host.encode import encode
from splatline.host.frame import Frame
from splatline.host.order import sort_by_line
from splatline.host.project import Splats
from splatline.host.scenes import SCENES
from splatline.rtl.format import PAPER
from splatline.sim import golden


def random_frame(count, tables):
    """Return a frame of ``count`` small ellipses."""
    rng = np.random.default_rng(1)
    column, line = rng.uniform(4, 508, (2, count)).astype(np.float32)
    splats = Splats(
        point=np.arange(count),
        column=column,
        line=line,
        depth=np.ones(count),
        diameter=rng.uniform(1.01, 4.0, count).astype(np.float32),
        shape=rng.integers(0, 4096, count).astype(np.uint16),
        shade=np.zeros(count, np.uint16),
        culled={},
    )
    z = rng.integers(0, 511, count).astype(np.uint16)
    light = rng.integers(0, 128, count).astype(np.uint16)
    material = rng.integers(0, 127, count).astype(np.uint8)
    encoded = encode(splats, z, light, light, material, 512, 512, PAPER)
    stream, _ = sort_by_line(encoded.words, encoded.lines, PAPER)
    return Frame(stream, tables, 512, 512)


def rate(frame, repeats=7):
    """Return the best rate of some runs in millions of code words a second, compiled before."""
    golden.render(frame)
    best = min(timed(frame) for _ in range(repeats))
    return len(frame.codewords) / best / 1e6


def timed(frame):
    """Return the seconds that a frame takes."""
    begin = time.perf_counter()
    golden.render(frame)
    return time.perf_counter() - begin


def main():
    """Measure and print."""
    print(f"cores in use: {len(os.sched_getaffinity(0))}")
    print("| frame | code words | million a second |")
    print("|---|---:|---:|")
    frames = {}
    for name in SCENES:
        scene = load_scene(name)
        view = fit_view(scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up)
        frames[name] = make_frame(scene.cloud, view, radii=splat_radii(scene.cloud))
    tables = frames[SCENES[0]].tables
    for count in (100_000, 1_000_000, 4_000_000):
        frames[f"random, {count:,}"] = random_frame(count, tables)
    for name, frame in frames.items():
        print(f"| {name} | {len(frame.codewords):,} | {rate(frame):.1f} |")


if __name__ == "__main__":
    main()
