"""What is drawn: a cloud or a built-in scene, and the view of it."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.core import ParameterSource

from splatline.cli.report.progress import Stages
from splatline.contract.config import EngineConfig
from splatline.contract.presets import DEFAULT
from splatline.host.encode.quality import DEFAULT_QUALITY, QUALITIES
from splatline.host.encode.shape_source import SHAPE_SOURCES
from splatline.host.visibility.skips import DEFAULT_SKIPS, SKIPS

from .parameters import ORBIT, PRESET, SIZE, SPLAT_SIZE, UP_AXES

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.contract.frame import Frame
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.visibility.view import View

__all__ = ["Shot", "Subject", "prepare", "subject_options"]

_Command = TypeVar("_Command", bound=Callable[..., Any])

DEFAULT_SCENE = "terrain"

_CAMERA = ("orbit", "fov", "up", "zoom")


@dataclass(frozen=True)
class Subject:
    """What the command line asks to be drawn; None leaves a value to the scene or the host.

    Parameters
    ----------
    path
        Cloud file, or None for a built-in scene.
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
    splat_size
        Diameter of the splats in the cloud's unit; None: from the points' own spacing.
    preset
        The engine's configuration.
    quality
        How splats become code words.
    skips
        What to leave out.
    shapes
        Where the shapes of the quality ``paper`` come from.
    """

    path: Path | None
    scene: str
    size: tuple[int, int]
    orbit: tuple[float, float] | None
    fov: float | None
    up: str | None
    zoom: float | None
    splat_size: float | None
    preset: EngineConfig
    quality: str
    skips: frozenset[str]
    shapes: str = "table"

    @property
    def name(self) -> str:
        """What to call the picture: the file's name without its format, or the scene's."""
        return self.scene if self.path is None else self.path.stem


@dataclass(frozen=True)
class Shot:
    """A subject turned into frames, with what the exact reference needs to draw it too.

    Parameters
    ----------
    cloud, view
        The points and the camera.
    radii
        Shape (n,): radius of each point's disc, in the cloud's unit.
    frames
        The code words and tables, of each sample of a pixel.
    camera
        Orbit, field of view, up axis and zoom as they came out, for the statistics.
    """

    cloud: Cloud
    view: View
    radii: npt.NDArray[np.float64]
    frames: list[Frame]
    camera: dict[str, Any]


def subject_options(command: _Command) -> _Command:
    """Add the argument CLOUD and the options of the view; the command gets one ``subject``."""

    @functools.wraps(command)
    def with_subject(
        cloud: Path | None,
        scene: str | None,
        size: tuple[int, int],
        orbit: tuple[float, float] | None,
        fov: float | None,
        up: str | None,
        zoom: float | None,
        splat_size: float | None,
        preset: EngineConfig,
        quality: str,
        skip: tuple[str, ...],
        keep: tuple[str, ...],
        shapes: str,
        **rest: Any,
    ) -> Any:
        if cloud is not None and scene is not None:
            raise click.UsageError("give a CLOUD or a --scene, not both")
        if both := set(skip) & set(keep):
            raise click.UsageError(f"--skip and --keep name the same: {', '.join(sorted(both))}")
        if shapes == "rom":
            quality, preset = _quality_for_rom(quality), preset.with_shapes()
        subject = Subject(
            cloud,
            scene or DEFAULT_SCENE,
            size,
            orbit,
            fov,
            up,
            zoom,
            splat_size,
            preset,
            quality,
            (DEFAULT_SKIPS | set(skip)) - set(keep),
            shapes,
        )
        return command(subject=subject, **rest)

    decorated: Any = with_subject
    for decorate in (
        click.option(
            "--keep",
            type=click.Choice(sorted(DEFAULT_SKIPS)),
            multiple=True,
            help="Do not leave out such points (may be given several times).",
        ),
        click.option(
            "--skip",
            type=click.Choice(list(SKIPS)),
            multiple=True,
            show_default=", ".join(name for name in SKIPS if name in DEFAULT_SKIPS),
            help="Leave out points as well (may be given several times). "
            + "; ".join(f"{name}: {what}" for name, what in SKIPS.items())
            + ".",
        ),
        click.option(
            "--shapes",
            type=click.Choice(list(SHAPE_SOURCES)),
            default="table",
            help="; ".join(f"{name}: {what}" for name, what in SHAPE_SOURCES.items())
            + ". rom takes the quality paper, and of --preset the variant with a ROM.",
        ),
        click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine to draw for."),
        click.option(
            "--quality",
            type=click.Choice(list(QUALITIES)),
            default=DEFAULT_QUALITY,
            help="; ".join(f"{name}: {what}" for name, what in QUALITIES.items()) + ".",
        ),
        click.option(
            "--splat-size",
            type=SPLAT_SIZE,
            metavar="auto|WORLD",
            default="auto",
            help="Diameter of the splats in the cloud's unit; auto: from the points' spacing.",
        ),
        click.option(
            "--zoom",
            type=float,
            metavar="F",
            show_default="the scene's, or 1",
            help="Magnify about the middle of the picture; 1 fits the cloud.",
        ),
        click.option(
            "--up", type=UP_AXES, show_default="the scene's, or y", help="Axis that points up."
        ),
        click.option(
            "--fov",
            type=float,
            metavar="DEG",
            show_default="the scene's, or 35",
            help="Angle that the shorter side spans.",
        ),
        click.option(
            "--orbit",
            type=ORBIT,
            metavar="AZ,EL",
            show_default="the scene's, or 30,20",
            help="Azimuth and elevation of the eye in degrees.",
        ),
        click.option(
            "--size",
            type=SIZE,
            metavar="WxH",
            default="512x512",
            help="Size of the image in pixels.",
        ),
        click.option(
            "--scene",
            metavar="NAME",
            show_default=DEFAULT_SCENE,
            help="Built-in scene, where there is no CLOUD: terrain or knot.",
        ),
        click.argument("cloud", required=False, type=click.Path(path_type=Path), metavar="[CLOUD]"),
    ):
        decorated = decorate(decorated)
    return decorated


def _quality_for_rom(quality: str) -> str:
    """Return the one quality that a shape ROM has, unless another was asked for."""
    context = click.get_current_context()
    if quality != "paper" and context.get_parameter_source("quality") != ParameterSource.DEFAULT:
        raise click.UsageError(f"--shapes rom needs --quality paper, not {quality}")
    return "paper"


def prepare(subject: Subject, stages: Stages, samples: int = 1) -> Shot:
    """Read a subject and turn it into frames, one for each sample of a pixel.

    Raises
    ------
    InputError
        If the file cannot be read, a value is out of range, or nothing of the cloud is in view.
    """
    from splatline.host.visibility.view import fit_view

    parameters = inspect.signature(fit_view).parameters
    camera = {key: parameters[key].default for key in _CAMERA}
    if subject.path is None:
        from splatline.host.scenes.scenes import load_scene

        with stages.stage("read", f"Making the scene {subject.scene}"):
            scene = load_scene(subject.scene)
        cloud = scene.cloud
        camera |= {key: getattr(scene, key) for key in _CAMERA if hasattr(scene, key)}
    else:
        from splatline.host.files.readers import read_cloud

        with stages.stage("read", f"Reading {subject.path}"):
            cloud = read_cloud(subject.path)
    camera |= {key: value for key in _CAMERA if (value := getattr(subject, key)) is not None}

    from splatline.host.cloud.spacing import splat_radii

    with stages.stage("spacing", f"Measuring the spacing of {len(cloud):,} points"):
        radii = splat_radii(cloud, subject.splat_size)
    with stages.stage("view", "Fitting the view"):
        view = fit_view(cloud, size=subject.size, **camera)
    from splatline.host.pipeline import make_frames, total_counts

    options: dict[str, Any] = {
        "config": subject.preset,
        "quality": subject.quality,
        "skips": subject.skips,
    }
    with stages.stage("", "Encoding"):
        frames = make_frames(cloud, view, samples, radii=radii, shapes=subject.shapes, **options)
    stages.seconds.update(total_counts(frames)["seconds"])
    if subject.shapes != "table":
        # For the number of bits alone, so that its time does not count.
        with stages.stage("", "Encoding with the host's table, to compare"):
            others = make_frames(cloud, view, samples, radii=radii, **options)
        for frame, other in zip(frames, others, strict=True):
            frame.counts["bits_sent"].update(other.counts["bits_sent"])
    return Shot(cloud, view, radii, frames, camera)
