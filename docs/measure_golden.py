"""Measure the golden renderer's rate on one core and on two.

Run as ``.venv/bin/python docs/measure_golden.py``. It draws splats of 1 to 4 pixels at random
positions of a 512 x 512 image, and the built-in scenes. It prints a table with the fastest of many
runs, as other processes slow down the rest.
"""

import os
import time

import numba
import numpy as np

from splatline.host import Cloud, View, fit_view, load_scene, make_frame, splat_radii
from splatline.host.scenes.scenes import SCENES
from splatline.sim import golden

SIZE = 512
REPEATS = 25


def random_frame(count):
    """Return a frame of ``count`` small ellipses with random positions, normals and colours."""
    rng = np.random.default_rng(1)
    depth = rng.uniform(1.0, 1.001, count)
    column, line = rng.uniform(4 - SIZE / 2, SIZE / 2 - 4, (2, count))
    normals = rng.normal(size=(count, 3))
    normals[:, 2] = -np.abs(normals[:, 2]) - 0.3  # towards the eye
    cloud = Cloud(
        positions=np.stack([column * depth / SIZE, line * depth / SIZE, depth], axis=1),
        normals=(normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32),
        colours=rng.integers(0, 256, (count, 3)).astype(np.uint8),
        two_sided=np.zeros(count, np.bool_),
        origin=np.zeros(3),
        name="random",
        dropped={},
    )
    view = View(np.zeros(3), np.eye(3), float(SIZE), SIZE, SIZE, 0.1)
    radii = rng.uniform(1.01, 4.0, count) / 2 / SIZE
    return make_frame(cloud, view, radii=radii.astype(np.float32))


def seconds(frame, threads):
    """Return the least time of a frame in seconds with a number of threads, after compilation."""
    numba.set_num_threads(threads)
    golden.render(frame)
    return min(timed(frame) for _ in range(REPEATS))


def timed(frame):
    """Return the time of a frame in seconds."""
    begin = time.perf_counter()
    golden.render(frame)
    return time.perf_counter() - begin


def main():
    """Measure and print."""
    cores = len(os.sched_getaffinity(0))
    counts = [threads for threads in (1, 2) if threads <= min(cores, numba.get_num_threads())]
    print(f"cores: {cores}")
    heads = [f"{threads} thread{'s' * (threads > 1)}: ms | million a second" for threads in counts]
    print("| frame | code words | " + " | ".join(heads) + " |")
    print("|---|---:|" + "---:|---:|" * len(counts))
    frames = {}
    for name in SCENES:
        scene = load_scene(name)
        view = fit_view(scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up)
        frames[name] = make_frame(scene.cloud, view, radii=splat_radii(scene.cloud))
    for count in (100_000, 1_000_000, 4_000_000):
        frames[f"random, {count:,}"] = random_frame(count)
    for name, frame in frames.items():
        words = len(frame.codewords)
        row = []
        for threads in counts:
            least = seconds(frame, threads)
            row += [f"{1e3 * least:.2f}", f"{words / least / 1e6:.1f}"]
        print(f"| {name} | {words:,} | " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
