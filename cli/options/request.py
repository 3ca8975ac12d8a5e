"""Render requests: pictures that the command line asks for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from splatline.contract.config import EngineConfig
from splatline.host.files.wanted import ColourBy
from splatline.host.shading.light_sets import DEFAULT_LIGHTS

__all__ = ["RenderRequest"]


@dataclass(frozen=True)
class RenderRequest:
    """The cloud, view and encoding that the command line asks for.

    None leaves a value to the scene or the host.

    Parameters
    ----------
    paths
        Files of the cloud; none: a built-in scene.
    scene
        Name of the built-in scene.
    size
        Width and height of the image in pixels.
    orbit
        Azimuth and elevation of the eye in degrees.
    fov
        Field of view in degrees.
    up
        Axis that points up.
    zoom
        Magnification.
    target, distance
        The point in the middle of the image, in the file's own coordinates, and its distance from
        the eye; None: the view fits the cloud.
    lights
        Name of a set of lights.
    splat_size
        Diameter of the splats in the cloud's unit; None: from the points' own spacing.
    preset
        The engine's configuration.
    quality
        How splats become code words.
    skips
        Reasons to leave points out.
    shapes
        Source of the shapes of the quality ``paper``.
    close_specks
        Whether single pixels that show through a surface are closed.
    fit
        Points that the view fits: ``bulk``, without those far from the rest, or ``all``.
    colour
        What colours a point. Its ``up`` counts for nothing; the view's does.
    format
        Format of the cloud file; None: by its name.
    sample
        Points on the faces of a mesh; None: its vertices.
    memory
        Bytes that a large cloud may take; None: a quarter of the machine's.
    dask
        Address of the Dask cluster that draws, or ``local``; None: this process does.
    keep
        Points that are drawn though they usually are not; see ``read_cloud``.
    """

    paths: tuple[Path, ...]
    scene: str
    orbit: tuple[float, float] | None
    fov: float | None
    up: str | None
    splat_size: float | None
    preset: EngineConfig
    quality: str
    skips: frozenset[str]
    size: tuple[int, int] = (512, 512)
    zoom: float | None = None
    target: tuple[float, float, float] | None = None
    distance: float | None = None
    lights: str = DEFAULT_LIGHTS
    shapes: str = "table"
    close_specks: bool = True
    fit: str = "bulk"
    colour: ColourBy | None = None
    format: str | None = None
    sample: int | None = None
    memory: int | None = None
    dask: str | None = None
    keep: frozenset[str] = frozenset()

    @property
    def path(self) -> Path | None:
        """The first file; None for a built-in scene."""
        return self.paths[0] if self.paths else None

    @property
    def name(self) -> str:
        """Name of the picture: the file's name without its suffix, or the scene's name."""
        if self.path is None:
            return self.scene
        if str(self.path) == "-":
            return "stdin"
        # Not from host.files, which would load numpy for the help.
        return (self.path.with_suffix("") if self.path.suffix.lower() == ".gz" else self.path).stem
