"""A large cloud from further and further away: its time, and its error against the exact discs."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from .frames import build, draw_frames

if TYPE_CHECKING:
    from splatline.contract.config import EngineConfig
    from splatline.host.visibility.block_index import Index
    from splatline.host.visibility.view import View

    from .race import Subject

__all__ = ["DISTANCES", "measure_distances"]

DISTANCES = (1, 2, 5, 10, 30)
"""Distances, as multiples of that of a view that fits the cloud."""

SAMPLES = (1, 16)
"""Samples a pixel whose errors are measured."""

TRUE_SAMPLES = 8
"""Samples along a side of a pixel of the exact discs."""


def measure_distances(
    subject: Subject, preset: EngineConfig, repeats: int, announce: Callable[[str], None]
) -> list[dict[str, Any]]:
    """Return the times of a cloud's frame and its errors at each of ``DISTANCES``.

    Parameters
    ----------
    subject, preset
        What is drawn, and the engine that golden draws for.
    repeats
        Frames of which the fastest counts.
    announce
        Called with a description before each distance.

    Returns
    -------
    list of dict
        ``distance``, ``cloud``, what ``draw_frames`` returns, and ``errors``: for each number of
        samples ``psnr_db``, ``silhouette_iou``, ``hole_fraction`` and ``pinholes``.
    """
    from splatline.host.shading.lighting import Lighting
    from splatline.sim import reference

    cloud, view, radii = subject
    index, _ = build(cloud, radii)
    found = []
    for distance in DISTANCES:
        announce(f"{cloud.name}, {distance} times as far")
        far = dataclasses.replace(view, focal=view.focal / distance)
        run = draw_frames(index, far, "exact", (), preset, repeats)
        exact = reference.render(cloud, far, radii, Lighting(), samples=TRUE_SAMPLES)
        errors = {str(count): _errors(index, far, exact, preset, count) for count in SAMPLES}
        found.append({"distance": distance, "cloud": cloud.name, **run, "errors": errors})
    return found


def _errors(
    index: Index, view: View, exact: Any, preset: EngineConfig, samples: int
) -> dict[str, float | None]:
    """Return the errors of a picture with some samples a pixel."""
    from splatline.host.pipeline import make_frames
    from splatline.sim import golden
    from splatline.sim.golden.multisample import average
    from splatline.sim.reference import metrics
    from splatline.sim.reference.wholeness import wholeness

    frames = make_frames(index, view, samples, config=preset)
    picture = average([golden.render(frame) for frame in frames])
    found = metrics.compare(picture, exact)
    kept = {name: found[name] for name in ("psnr_db", "silhouette_iou", "hole_fraction")}
    return {**kept, "pinholes": wholeness(picture)["pinholes"]}
