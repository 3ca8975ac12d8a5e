"""Measure what thinning costs: pictures of a scan's cells, and of all its points, beside the truth.

Run as ``.venv/bin/python docs/measure_thinning.py [POINTS]``. It makes a noisy scan of the built-in
terrain. The truth is the terrain itself, drawn exactly. It prints the PSNR against the truth of the
picture of all points and of those of cells of several widths, with one sample and with four, all
with the same view and range of depths.
"""

import dataclasses
import functools
import sys
import tempfile
from pathlib import Path

import numpy as np

from splatline.cli.bench.large.make_scan import OFFSETS, make_scan
from splatline.cli.bench.machine import described
from splatline.host import fit_view, read_cloud
from splatline.host.cloud.spacing import measure_discs
from splatline.host.large import read_part
from splatline.host.large.draw_parts import Drawing, draw_parts, frames_of
from splatline.host.large.plan import make_plan
from splatline.host.pipeline import make_frames
from splatline.host.scenes.terrain import terrain_patches
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.materials import materials_of
from splatline.sim import golden
from splatline.sim.golden.multisample import average
from splatline.sim.reference.true_surface import render_surface

SAMPLES = 1, 4


GREY = (0.1, 0.1, 0.1)


def picture(frames):
    """Return the picture of some frames as RGB in 0..1."""
    return average([golden.render(frame) for frame in frames]).to_rgb(GREY)


def main():
    """Make the scan, measure and print."""
    points = int(float(sys.argv[1])) if sys.argv[1:] else 4_000_000
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scan.laz"
        make_scan(path, points)
        plan = make_plan([path], None, functools.partial(fit_view, up="z"), 128)
        cloud = read_cloud(path)
        view = dataclasses.replace(plan.view, eye=plan.view.eye + plan.origin - cloud.origin)
        discs = measure_discs(cloud).drawn(close_specks=False)._asdict()
        shared = {"materials": materials_of(cloud, plan.palette), "depth_range": plan.depth_range}
        origin = plan.origin - np.array(OFFSETS)
        truth = render_surface(terrain_patches(), origin, plan.view, Lighting(), background=GREY)
        print(f"{described()}; {points:,} points, 512 x 512 pixels")
        whole = [make_frames(cloud, view, n, **discs, **shared) for n in SAMPLES]
        tell("all points", len(cloud), whole, truth.rgb)
        for cells in (4.0, 2.0, 1.0, 0.5):
            read_part.CELLS = cells
            pictures = []
            for samples in SAMPLES:
                drawing = Drawing(samples=samples, memory=8 << 30)
                joined = draw_parts(plan, drawing)
                pictures.append(frames_of(plan, drawing, joined))
            kept = joined.points - sum(joined.dropped.values())
            tell(f"cells of 1/{cells:g} pixel", kept, pictures, truth.rgb)


def tell(what, points, pictures, truth):
    """Print the PSNR of pictures, in dB."""
    errors = [np.mean((picture(frames) - truth) ** 2) for frames in pictures]
    values = " / ".join(f"{-10.0 * np.log10(error):.2f}" for error in errors)
    print(f"{what}: {points:,} points, {values} dB")


if __name__ == "__main__":
    main()
