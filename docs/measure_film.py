"""Frames of a turntable drawn in turn, each on all cores, and at once, each on one core.

    .venv/bin/python docs/measure_film.py

Prints wall and processor time of 90 frames of 512 x 512, and whether the pictures are the same.
"""

import time
from functools import partial

import numba
import numpy as np

from splatline.host import load_scene
from splatline.view.draw import Settings, draw
from splatline.view.film.ahead import ahead
from splatline.view.film.film import plan_cameras
from splatline.view.film.turntable import fit_turntable
from splatline.view.live_cloud import live_cloud

SIZE = (512, 512)


def main() -> None:
    """Measure and print."""
    scene = load_scene("terrain")
    live = live_cloud(scene.cloud)
    home = fit_turntable(live.cloud, live.discs.radii, size=SIZE, fov=scene.fov, up=scene.up)
    cameras = plan_cameras(home, "turntable", 3.0, 30.0)
    print(f"{len(cameras)} frames, {numba.get_num_threads()} cores")
    for samples in (1, 4):
        settings = Settings(samples=samples)
        picture = partial(checksum, live, settings)
        picture(cameras[0])  # compiled and indexed
        for _ in range(3):
            turn, turn_processor, one = timed(lambda made=picture: list(map(made, cameras)))
            once, once_processor, other = timed(lambda made=picture: list(ahead(made, cameras)))
            print(
                f"{samples} samples: in turn {turn:.2f} s ({turn_processor:.2f} of processor),"
                f" at once {once:.2f} s ({once_processor:.2f});"
                f" {sum(map(int.__ne__, one, other))} frames unlike"
            )


def checksum(live, settings, camera) -> int:
    """Return a number that two pictures share only if they are the same, as good as surely."""
    return hash(np.ascontiguousarray(draw(live, camera, SIZE, settings).rgba).tobytes())


def timed(work):
    """Return the wall and the processor time of some work, seconds, and what it gives."""
    wall, processor = time.perf_counter(), time.process_time()
    given = work()
    return time.perf_counter() - wall, time.process_time() - processor, given


if __name__ == "__main__":
    main()
