"""Render requests of a live view and of a film: the cloud, the camera, the settings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from splatline.cli.report.progress import Stages

from .camera import with_camera
from .prepare import cloud_of
from .request import RenderRequest

if TYPE_CHECKING:
    from splatline.view.draw import Settings
    from splatline.view.live_cloud import LiveCloud
    from splatline.view.subject import Subject

__all__ = ["draw_settings", "prepare_live", "subject_of"]


def subject_of(request: RenderRequest) -> Subject:
    """Return what a live view of a request looks at."""
    from splatline.view.subject import Subject

    request, camera, _ = with_camera(request, Stages())
    return Subject(
        path=request.path,
        scene=request.scene,
        name=request.name,
        format=request.format,
        sample=request.sample,
        keep=request.keep,
        fit=request.fit,
        splat_size=request.splat_size,
        orbit=camera["orbit"],
        fov=camera["fov"],
        up=camera["up"],
        target=request.target,
        distance=request.distance,
    )


def prepare_live(request: RenderRequest, stages: Stages) -> tuple[LiveCloud, dict[str, Any]]:
    """Return the cloud of a request, ready to be drawn again and again, and its camera's values.

    Raises
    ------
    InputError
        If a file cannot be read, or a value is out of range.
    """
    from splatline.view.live_cloud import live_cloud

    request, camera, scene = with_camera(request, stages)
    cloud = cloud_of(request, scene, stages)
    with stages.stage("spacing", f"Measuring the spacing of {len(cloud):,} points") as share:
        live = live_cloud(
            cloud,
            fit=request.fit,
            splat_size=request.splat_size,
            progress=lambda text, part: share(part or 0.0),
        )
    return live, camera


def draw_settings(
    request: RenderRequest, samples: int, background: tuple[float, float, float] | None
) -> Settings:
    """Return how the pictures of a request are drawn; without a background, on the usual one."""
    from splatline.plots.figure import BACKGROUND
    from splatline.view.draw import Settings

    return Settings(
        preset=request.preset,
        quality=request.quality,
        samples=samples,
        skips=request.skips,
        close_specks=request.close_specks,
        lights=request.lights,
        background=background or BACKGROUND,
    )
