"""Samples of the built-in scenes, drawn and compared with their true surfaces."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from splatline.cli.bench.sizes import LARGE, MEDIUM

if TYPE_CHECKING:
    from splatline.contract.config import EngineConfig
    from splatline.contract.raster import Raster
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.scenes.patches import Patch
    from splatline.host.visibility.view import View
    from splatline.sim.reference.reference import Reference

__all__ = ["Sweep", "measure_clouds", "measure_scenes", "samples_of"]

SCENES = ("knot", "terrain")

DENSER = 4
"""Points of a dense or noisy sample of a scan, for one of its own."""

MANY = (MEDIUM, LARGE)
"""Points of the samples of the largest scan whose first pictures ``splatline bench host`` times."""

SEED = 1
"""Of points and of noise."""

TRIAL = 100_000
"""Points at random that tell how many of a scene's points face the eye."""


@dataclass(frozen=True)
class Sweep:
    """Measurements of the scenes.

    Parameters
    ----------
    size, preset
        The image, and the engine to draw for.
    densities
        Points that face the eye, a pixel of the true surface.
    noises
        Noise along the normal, in spacings of the points.
    """

    size: tuple[int, int]
    preset: EngineConfig
    densities: Sequence[float]
    noises: Sequence[float]

    def total(self) -> int:
        """Return the number of runs."""
        return 2 * 2 * len(SCENES) * len(self.densities) * len(self.noises)


@dataclass(frozen=True)
class _Subject:
    """A scene's surface, view and truth.

    Parameters
    ----------
    patches, view, truth
        The surface, the view, and the surface as the view sees it.
    shape
        The same, shaded by the shape's own normals: the truth of points without normals.
    middle
        What the view's coordinates are relative to.
    points
        Points of a density of 1.
    """

    name: str
    patches: list[Patch]
    view: View
    truth: Reference
    shape: Reference
    middle: Any
    points: float


def measure_scenes(
    sweep: Sweep, advance: Callable[[str], None]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the truths' own pinholes and see-through pixels, and every run's measures."""
    truths, runs = [], []
    for name in SCENES:
        subject = _subject(name, sweep.size)
        truths.append({"scene": name, **_of_truth(subject.truth)})
        cases = itertools.product(("even", "random"), sweep.noises, (True, False), sweep.densities)
        for spread, noise, has_normals, density in cases:
            advance(f"{name}, {density:g} a pixel")
            cloud = _sample(subject, density, spread, noise, has_normals)
            truth = subject.truth if has_normals else subject.shape
            found = _measure(cloud, subject.view, truth, sweep.preset)
            case = {"spread": spread, "noise": noise, "normals": has_normals, "density": density}
            runs.append({"scene": name, **case, "points": len(cloud), **found})
    return truths, runs


def measure_clouds(
    clouds: Sequence[Path],
    many: Sequence[int],
    preset: EngineConfig,
    advance: Callable[[str], None],
) -> list[dict[str, Any]]:
    """Return what is open in pictures of clouds and of samples, in the default view.

    Parameters
    ----------
    clouds
        Files of scans.
    many
        Points of further samples of the largest scan.
    preset
        The engine to draw for.
    advance
        Called with the name of each scan, before it is measured.
    """
    from splatline.host.files.readers import read_cloud

    runs: list[dict[str, Any]] = []
    largest: Cloud | None = None
    for path in clouds:
        advance(path.stem)
        scan = read_cloud(path)
        runs += _open_shares(samples_of(scan), scan, preset)
        if largest is None or len(scan) > len(largest):
            largest = scan
    if largest is not None:
        runs += _open_shares(_larger(largest, many), largest, preset)
    return runs


def _open_shares(
    samples: Iterator[tuple[str, Cloud]], scan: Cloud, preset: EngineConfig
) -> Iterator[dict[str, Any]]:
    """Yield the measures of each sample's picture, in the view that fits its scan."""
    from splatline.host.visibility.view import fit_view
    from splatline.sim.reference.wholeness import largest_gap, wholeness

    view = fit_view(scan)
    for name, cloud in samples:
        raster, counts, splat = _draw(cloud, view, preset)
        yield {
            "cloud": name,
            "points": len(cloud),
            "splat_pixels": splat,
            **wholeness(raster),
            "largest_gap": largest_gap(raster.drawn),
            "elements": counts["elements"],
            "codewords": counts["codewords"],
        }


def _larger(scan: Cloud, many: Sequence[int]) -> Iterator[tuple[str, Cloud]]:
    """Yield samples of a scan's discs that have so many points, with their discs' normals."""
    from splatline.host.cloud.resample import resample
    from splatline.host.cloud.spacing import splat_radii

    radii = splat_radii(scan)
    for count in many:
        yield f"{scan.name}, {count:,}", resample(scan, radii, count)[0]


def samples_of(scan: Cloud) -> Iterator[tuple[str, Cloud]]:
    """Yield a scan, more points of its discs, and these with noise and without their normals."""
    import numpy as np

    from splatline.cli.bench.host.first_picture import NOISE
    from splatline.host.cloud.normals import estimate_normals
    from splatline.host.cloud.resample import resample
    from splatline.host.cloud.spacing import splat_radii

    yield scan.name, scan
    dense, radii = resample(scan, splat_radii(scan), DENSER * len(scan))
    yield f"{scan.name}, dense", dense
    scale = NOISE * float(np.median(radii))
    heights = np.random.default_rng(SEED + 1).normal(scale=scale, size=(len(dense), 1))
    positions = dense.positions + heights * dense.normals
    unknown = np.ones(len(dense), np.bool_)
    yield (
        f"{scan.name}, noisy",
        dataclasses.replace(
            dense, positions=positions, normals=estimate_normals(positions), two_sided=unknown
        ),
    )


def _subject(name: str, size: tuple[int, int]) -> _Subject:
    """Return a scene's surface, view and truth."""
    import numpy as np

    from splatline.host.scenes.knot import knot_patches
    from splatline.host.scenes.patches import sample
    from splatline.host.scenes.scenes import load_scene
    from splatline.host.scenes.terrain import terrain_patches
    from splatline.host.shading.lighting import Lighting
    from splatline.host.visibility.view import fit_view
    from splatline.sim.reference.true_surface import render_surface

    scene = load_scene(name)
    camera = {key: getattr(scene, key) for key in ("orbit", "fov", "up", "zoom")}
    view = fit_view(scene.cloud, size=size, **camera)
    patches = {"knot": knot_patches, "terrain": terrain_patches}[name]()
    middle = scene.cloud.origin
    truth = render_surface(patches, middle, view, Lighting())
    shape = render_surface(patches, middle, view, Lighting(), shape_normals=True)
    trial = sample(patches, TRIAL, name, SEED)
    away = np.einsum("ij,ij->i", trial.normals, trial.positions + trial.origin - middle - view.eye)
    seen = np.count_nonzero(truth.coverage > 0.5)
    return _Subject(
        name, patches, view, truth, shape, middle, TRIAL * seen / np.count_nonzero(away < 0.0)
    )


def _sample(
    subject: _Subject, density: float, spread: str, noise: float, has_normals: bool
) -> Cloud:
    """Return a cloud of points on a scene's surface, in its view's coordinates."""
    import numpy as np

    from splatline.host.cloud.normals import estimate_normals
    from splatline.host.scenes.patches import sample

    count = max(round(density * subject.points), 2)
    seed = None if spread == "even" else SEED
    cloud = sample(subject.patches, count, subject.name, seed)
    positions = cloud.positions + cloud.origin - subject.middle
    if noise:
        # The side of the square that a point has of the surface.
        spacing = _side(subject) / np.sqrt(count)
        heights = np.random.default_rng(SEED + 1).normal(scale=noise * spacing, size=count)
        positions += cloud.normals * heights[:, np.newaxis]
    cloud = dataclasses.replace(cloud, positions=positions, origin=subject.middle)
    if has_normals:
        return cloud
    normals, unknown = estimate_normals(positions), np.ones(count, np.bool_)
    return dataclasses.replace(cloud, normals=normals, two_sided=unknown)


def _side(subject: _Subject) -> float:
    """Return the side of a square with a surface's area, as far as its points are even by area."""
    import numpy as np

    from splatline.host.cloud.spacing import closing_radii
    from splatline.host.scenes.patches import sample

    count = 20_000
    even = sample(subject.patches, count, subject.name)
    # A square grid's closing radius is half of its diagonal.
    radii = closing_radii(even.positions, even.normals)
    return float(np.median(radii) * np.sqrt(2.0 * count))


def _draw(cloud: Cloud, view: View, preset: EngineConfig) -> tuple[Raster, dict[str, Any], float]:
    """Return a cloud's picture, the frame's counts, and the median splat in pixels."""
    import numpy as np

    from splatline.host.cloud.spacing import measure_discs
    from splatline.host.pipeline import make_frame
    from splatline.host.visibility.trim import trimmed_radii
    from splatline.sim import golden

    discs = measure_discs(cloud)
    frame = make_frame(cloud, view, **discs._asdict(), config=preset, close_specks=True)
    radii = trimmed_radii(cloud.positions, discs.radii, view, discs.cover)
    depth = (cloud.positions - view.eye) @ view.axes[2]
    return golden.render(frame), frame.counts, float(np.median(2.0 * radii * view.focal / depth))


def _measure(cloud: Cloud, view: View, truth: Reference, preset: EngineConfig) -> dict[str, Any]:
    """Draw a cloud and compare it with the truth."""
    from splatline.sim.reference import metrics
    from splatline.sim.reference.wholeness import behind_truth, wholeness

    raster, counts, splat = _draw(cloud, view, preset)
    limits = counts["depth_range"]
    found = metrics.compare(raster, truth, depth_range=limits)
    return {
        "splat_pixels": splat,
        **{key: found[key] for key in ("psnr_db", "hole_fraction", "silhouette_iou")},
        **wholeness(raster),
        "behind_truth": behind_truth(raster, truth, limits),
        "elements": counts["elements"],
        "codewords": counts["codewords"],
    }


def _of_truth(truth: Reference) -> dict[str, float]:
    """Return the pinholes and see-through pixels that the true surface has itself."""
    import numpy as np

    from splatline.sim.reference.wholeness import pinholes, see_through

    drawn = truth.coverage > 0.5
    low, high = np.nanmin(truth.depth), np.nanmax(truth.depth)
    share = np.where(drawn, (truth.depth - low) / (high - low), np.nan)
    total = np.count_nonzero(drawn)
    return {
        "pinholes": float(np.count_nonzero(pinholes(drawn)) / total),
        "see_through": float(np.count_nonzero(see_through(share, drawn)) / total),
    }
