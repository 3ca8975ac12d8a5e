"""Measure what a sign of estimated normals gives: pictures of the scenes beside their surfaces.

Run as ``.venv/bin/python docs/measure_upward.py``. It samples the built-in scenes at random, and
draws each sample at 512 x 512 pixels with its true normals; with estimated ones that have no sign;
with those that ``turn_upward`` leaves; and with the sign of the true normals, which bounds what any
orientation gives. It prints the PSNR against the true surface, the share of dark pixels, and the
elements. A dark pixel has less than 0.6 of the luminance of each true pixel of its neighbourhood.
"""

import dataclasses

import numpy as np
from scipy.ndimage import minimum_filter

from splatline.cli.bench.machine import described
from splatline.contract.presets import RGB24
from splatline.host import fit_view, load_scene, make_frame, splat_radii
from splatline.host.cloud.normals import estimate_normals
from splatline.host.cloud.upward import turn_upward
from splatline.host.scenes.knot import knot_patches
from splatline.host.scenes.patches import sample
from splatline.host.scenes.terrain import terrain_patches
from splatline.host.shading.lighting import Lighting
from splatline.sim import golden
from splatline.sim.reference.metrics import compare
from splatline.sim.reference.true_surface import render_surface

SURFACES = {"terrain": terrain_patches, "knot": knot_patches}

VIEWS = (("terrain", (30.0, 20.0)), ("terrain", (-75.0, 48.0)), ("knot", (-8.0, 8.0)))

SAMPLES = ((200_000, 0.0), (1_000_000, 0.0), (1_000_000, 0.5), (1_000_000, 2.0))
"""Points, and their noise along the normal in spacings."""

SPACINGS = {"terrain": 35_400.0, "knot": 10.0}
"""About the side of a square with each surface's area."""

LUMINANCE = (0.299, 0.587, 0.114)

DARK = 0.6


def main():
    """Measure and print."""
    print(f"{described()}; 512 x 512 pixels")
    for name, orbit in VIEWS:
        scene = load_scene(name)
        view = fit_view(scene.cloud, orbit=orbit, fov=scene.fov, up=scene.up)
        patches = SURFACES[name]()
        truth = render_surface(patches, scene.cloud.origin, view, Lighting())
        for count, noise in SAMPLES:
            cloud = sample(patches, count, name, 1)
            spread = noise * SPACINGS[name] / np.sqrt(count)
            positions = cloud.positions + cloud.origin - scene.cloud.origin
            heights = np.random.default_rng(2).normal(scale=spread, size=(count, 1))
            positions += cloud.normals * heights
            cloud = dataclasses.replace(cloud, positions=positions, origin=scene.cloud.origin)
            for what, signed in with_signs(cloud, scene.up):
                measured = measure(signed, view, truth)
                print(f"{name} {orbit}, {count:,} points, noise {noise:g}, {what}: {measured}")


def with_signs(cloud, up):
    """Yield names and clouds whose normals have their signs from several sources."""
    yield "given", cloud
    two_sided = np.ones(len(cloud), np.bool_)
    estimated = cloud.turned(estimate_normals(cloud.positions), two_sided)
    yield "no sign", estimated
    upward = turn_upward(dataclasses.replace(estimated, up="z"), up)  # as a survey
    yield f"upward ({1 - upward.two_sided.mean():.1%})", upward
    agree = np.einsum("ij,ij->i", estimated.normals, cloud.normals) >= 0.0
    normals = np.where(agree[:, np.newaxis], estimated.normals, -estimated.normals)
    yield "true sign", cloud.turned(normals, ~two_sided)


def measure(cloud, view, truth):
    """Return the PSNR, the share of dark pixels and the elements, as a text."""
    frame = make_frame(cloud, view, radii=splat_radii(cloud), config=RGB24)
    raster = golden.render(frame)
    limits = frame.counts["depth_range"]
    psnr = compare(raster, truth, depth_range=limits)["psnr_db"]
    luminance = raster.to_rgb((1.0, 1.0, 1.0)) @ LUMINANCE
    dark = raster.drawn & (luminance < DARK * minimum_filter(truth.rgb @ LUMINANCE, 3))
    share = np.count_nonzero(dark) / np.count_nonzero(raster.drawn)
    return f"{psnr:.2f} dB, {share:.2%} dark, {frame.counts['elements']:,} elements"


if __name__ == "__main__":
    main()
