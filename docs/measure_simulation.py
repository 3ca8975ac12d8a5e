"""Measure the time to build a simulation of the engine, to find it cached, and to run a frame.

Run as ``.venv/bin/python docs/measure_simulation.py [PRESET ...]``; the default is ``paper``. It
draws the built-in terrain, 512 x 512, with the generated Verilog in Verilator under cocotb. The
first build starts from an empty cache, in a folder that is removed at the end. The Verilog is
generated again before the second build, which the cache finds by its content. Seconds are wall
time.
"""

import os
import sys
import tempfile
import time

from splatline.contract.presets import get_preset
from splatline.host import fit_view, load_scene, make_frame, splat_radii
from splatline.sim import golden
from splatline.sim.cosim.player.frames import build_engine, simulate_frame

STALLS = (0.0, 0.25, 0.5)
"""Shares of the cycles in which each port stalls."""

MOST_BUILD, MOST_RUN, ELEMENTS = 40.0, 3.0, 100_000
"""Targets: seconds of a build, seconds of a run, and the elements of that run."""


def make_terrain(config):
    """Return the terrain's frame."""
    scene = load_scene("terrain")
    view = fit_view(
        scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up, zoom=scene.zoom, size=(512, 512)
    )
    return make_frame(scene.cloud, view, radii=splat_radii(scene.cloud), config=config)


def build(config):
    """Return the build of a preset's engine, and its time in seconds."""
    begin = time.perf_counter()
    built = build_engine(config)
    return built, time.perf_counter() - begin


def measure(config):
    """Print the times of an engine's simulation."""
    frame = make_terrain(config)
    elements = frame.counts["elements"]
    picture = golden.render(frame)
    first, cold = build(config)
    again, warm = build(config)
    assert (first.reused, again.reused, first.folder) == (False, True, again.folder)
    print(f"| {config.name} | build | {cold:.1f} | {_verdict(cold <= MOST_BUILD)} |")
    print(f"| {config.name} | built before, found by its content | {warm:.1f} | |")
    for stall in STALLS:
        outcome = simulate_frame(frame, stall=stall)
        assert not outcome.raster.mismatches(picture)
        seconds = outcome.seconds["run"]
        share = seconds * ELEMENTS / elements
        ports = f"ports that wait {stall:.0%} of the time" if stall else "ports that never wait"
        print(
            f"| {config.name} | {elements:,} elements, {outcome.cycles:,} cycles, {ports}"
            f" | {seconds:.2f}; {share:.2f} for {ELEMENTS:,} | {_verdict(share <= MOST_RUN)} |"
        )


def _verdict(met):
    return "met" if met else "**not met**"


def main():
    """Measure every preset named."""
    print("| preset | what | seconds | target |\n|---|---|---:|---|")
    with tempfile.TemporaryDirectory(prefix="splatline-cache-") as cache:
        os.environ["SPLATLINE_CACHE"] = cache
        for name in sys.argv[1:] or ["paper"]:
            measure(get_preset(name))


if __name__ == "__main__":
    main()
