"""Measures frames of the terrain with each way to run parallel loops; see decision 0087.

Usage: ``python docs/measure_threads.py [ROUNDS]``. Each line is a fresh process: the median of 60
frames, the processor time of a frame, and what the process takes from its start to its end.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time

FRAMES = 60

DRAW = f"""
import statistics, time
from splatline.host.scenes.scenes import load_scene
from splatline.view.camera import fit_camera
from splatline.view.draw import draw
from splatline.view.live_cloud import live_cloud
scene = load_scene("terrain")
live = live_cloud(scene.cloud)
camera = fit_camera(live.cloud, live.discs.radii, up=scene.up)
draw(live, camera, (512, 512)).rgba
seconds, before = [], time.process_time()
for _ in range({FRAMES}):
    camera, start = camera.turned(3.0, 0.0), time.perf_counter()
    draw(live, camera, (512, 512)).rgba
    seconds.append(time.perf_counter() - start)
mean = (time.process_time() - before) / {FRAMES}
print(f"{{statistics.median(seconds) * 1e3:.1f}} | {{mean * 1e3:.1f}}")
"""

WAYS = {
    "TBB": {"NUMBA_THREADING_LAYER": "tbb"},
    "OpenMP": {"NUMBA_THREADING_LAYER": "omp", "OMP_WAIT_POLICY": "active"},
    "OpenMP, whose threads sleep between loops": {
        "NUMBA_THREADING_LAYER": "omp", "OMP_WAIT_POLICY": "passive",
    },
    "numba's own threads": {"NUMBA_THREADING_LAYER": "workqueue"},
}  # fmt: skip


def main() -> None:
    """Print the table."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    print(f"load average {os.getloadavg()[0]:.1f}")
    print("| parallel loops | a frame, ms | its processor, ms | process, s |")
    print("|---|---:|---:|---:|")
    for _ in range(rounds):
        for name, settings in WAYS.items():
            start = time.perf_counter()
            run = subprocess.run(
                [sys.executable, "-c", DRAW], env={**os.environ, **settings},
                capture_output=True, text=True, check=False,
            )  # fmt: skip
            seconds = time.perf_counter() - start
            found = run.stdout.strip() or "not there | -"
            print(f"| {name} | {found} | {seconds:.1f} |", flush=True)


if __name__ == "__main__":
    main()
