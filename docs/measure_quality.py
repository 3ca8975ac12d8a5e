"""Measure each quality against the exact reference: error, holes and code words.

Run as ``.venv/bin/python docs/measure_quality.py [CLOUD ...]``: the built-in scenes, and any clouds
named, 512 x 512, splats of the points' spacing, 4 x 4 samples a pixel. Prints a table.
"""

import sys
from pathlib import Path

from splatline.host import Lighting, fit_view, load_scene, make_frame, read_cloud, splat_radii
from splatline.host.quality import QUALITIES
from splatline.host.scenes import SCENES
from splatline.sim import golden, metrics, reference
from splatline.sim.figure import BACKGROUND


def measure(name, cloud, **options):
    """Print a row for each quality."""
    view, radii = fit_view(cloud, **options), splat_radii(cloud)
    exact = reference.render(cloud, view, radii, Lighting(), background=BACKGROUND)
    for quality in QUALITIES:
        frame = make_frame(cloud, view, radii=radii, quality=quality)
        found = metrics.compare(
            golden.render(frame),
            exact,
            background=BACKGROUND,
            depth_range=frame.counts["depth_range"],
        )
        words = frame.counts["codewords"] - frame.counts["control_words"]
        numbers = (
            f"{words / frame.counts['elements']:.2f}",
            f"{found['psnr_db']:.2f}",
            f"{found['psnr_foreground_db']:.2f}",
            f"{found['ssim']:.3f}",
            f"{found['hole_fraction']:.3%}",
            f"{found['silhouette_iou']:.4f}",
            f"{found['depth_rmse']:.4f}",
        )
        print("| " + " | ".join([name, quality, *numbers]) + " |")


def main():
    """Measure and print."""
    heads = ("scene", "quality", "words an element", "PSNR", "foreground", "SSIM", "holes")
    print("| " + " | ".join([*heads, "silhouette IoU", "depth RMS"]) + " |")
    print("|---|---" + "|---:" * 7 + "|")
    for name in SCENES:
        scene = load_scene(name)
        measure(name, scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up, zoom=scene.zoom)
    for path in map(Path, sys.argv[1:]):
        measure(path.stem, read_cloud(path))


if __name__ == "__main__":
    main()
