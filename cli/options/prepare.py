"""Preparation of a render request: reading the cloud, fitting the view, encoding the frames."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from splatline.cli.report.progress import Stages

from .above import seen_from_above
from .camera import see, with_camera
from .large import is_large, prepare_large, prepare_large_tiles
from .request import RenderRequest

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.contract.frame import Frame
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.cloud.spacing import Discs
    from splatline.host.files.wanted import ColourBy
    from splatline.host.large.cluster_tiles import ClusterTiles
    from splatline.host.large.joined_tiles import JoinedTiles
    from splatline.host.picture_tiles.frames import TiledPicture
    from splatline.host.scenes.scenes import Scene
    from splatline.host.visibility.view import View
    from splatline.view.live_cloud import LiveCloud
    from splatline.view.subject import Subject

    Picture: TypeAlias = TiledPicture | JoinedTiles | ClusterTiles
    """A picture in tiles."""

__all__ = [
    "PreparedFrames",
    "PreparedTiles",
    "measure_in_stages",
    "prepare",
    "prepare_live",
    "prepare_tiles",
    "read_in_stages",
    "subject_of",
]


@dataclass(frozen=True)
class PreparedFrames:
    """The frames of a render request.

    Parameters
    ----------
    frames
        One frame for each sample of a pixel.
    view
        The camera.
    camera
        Orbit, field of view, up axis and zoom that were used, for the statistics; of a camera that
        looks at a point also target and distance.
    dropped
        Points left out when the cloud was read, by reason.
    colour_key
        What the colours stand for; see ``Cloud.colour_key``.
    notes
        What a person should know about the cloud, each in one line.
    far_away
        Points far from the rest that are not drawn.
    facts
        Further statistics.
    cloud, radii
        The points, and the radius of each one's disc in the cloud's unit: shape (n,). None for a
        cloud that is drawn in parts.
    """

    frames: list[Frame]
    view: View
    camera: dict[str, Any]
    dropped: dict[str, int]
    colour_key: dict[str, Any]
    notes: list[str]
    far_away: int = 0
    facts: dict[str, Any] = field(default_factory=dict)
    cloud: Cloud | None = None
    radii: npt.NDArray[np.float64] | None = None


@dataclass(frozen=True)
class PreparedTiles:
    """The tiles of a render request.

    Parameters
    ----------
    picture
        The tiles; their frames are made as they are asked for, or lie in memory.
    camera, dropped, colour_key, notes, far_away
        See :class:`PreparedFrames`.
    facts
        Returns further statistics, once the tiles are drawn.
    """

    picture: Picture
    camera: dict[str, Any]
    dropped: dict[str, int]
    colour_key: dict[str, Any]
    notes: list[str]
    far_away: int = 0
    facts: Callable[[], dict[str, Any]] = dict


@dataclass(frozen=True)
class _View:
    """The cloud of a render request in memory, and its view.

    Parameters
    ----------
    cloud, discs, view
        The points, their discs and the camera.
    camera, far_away
        See :class:`PreparedFrames`.
    """

    cloud: Cloud
    discs: Discs
    view: View
    camera: dict[str, Any]
    far_away: int

    @property
    def notes(self) -> list[str]:
        """What a person should know about the cloud, each in one line."""
        return [*self.cloud.notes, *_far_note(self.far_away)]


def prepare(request: RenderRequest, stages: Stages, samples: int = 1) -> PreparedFrames:
    """Read the cloud of a request and encode it as frames, one for each sample of a pixel.

    Raises
    ------
    InputError
        If a file cannot be read, a value is out of range, or nothing of the cloud is in view.
    """
    request, camera, scene = with_camera(request, stages)
    if is_large(request):
        return prepare_large(request, camera, stages, samples)
    prepared = _view_of(request, camera, scene, stages)
    cloud = prepared.cloud
    return PreparedFrames(
        frames=_encode(request, cloud, prepared.view, prepared.discs, stages, samples),
        view=prepared.view,
        camera=camera,
        dropped=cloud.dropped,
        colour_key=cloud.colour_key,
        notes=prepared.notes,
        far_away=prepared.far_away,
        cloud=cloud,
        radii=prepared.discs.radii,
    )


def prepare_tiles(
    request: RenderRequest, stages: Stages, samples: int, stack: ExitStack
) -> PreparedTiles:
    """Read the cloud of a request whose picture is larger than the engine's image.

    What the tiles need, such as a cluster, is closed by ``stack``.

    Raises
    ------
    InputError
        As :func:`prepare`.
    """
    request, camera, scene = with_camera(request, stages)
    if is_large(request):
        return prepare_large_tiles(request, camera, stages, samples, stack)
    prepared = _view_of(request, camera, scene, stages)
    cloud = prepared.cloud
    with stages.stage("", "Projecting"):
        from splatline.host.picture_tiles.frames import tile_picture
        from splatline.host.shading.light_sets import LIGHTS

        picture = tile_picture(
            cloud,
            prepared.view,
            samples,
            **prepared.discs._asdict(),
            lighting=LIGHTS[request.lights],
            config=request.preset,
            quality=request.quality,
            skips=request.skips,
        )
    return PreparedTiles(
        picture=picture,
        camera=camera,
        dropped=cloud.dropped,
        colour_key=cloud.colour_key,
        notes=prepared.notes,
        far_away=prepared.far_away,
    )


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
    cloud = _cloud_of(request, scene, stages)
    with stages.stage("spacing", f"Measuring the spacing of {len(cloud):,} points") as share:
        live = live_cloud(
            cloud,
            fit=request.fit,
            splat_size=request.splat_size,
            progress=lambda text, part: share(part or 0.0),
        )
    return live, camera


def _cloud_of(request: RenderRequest, scene: Scene | None, stages: Stages) -> Cloud:
    """Return the cloud of a request in memory, in the colours that are asked for."""
    if request.path is not None:
        return read_in_stages(
            request.path,
            stages,
            request.colour,
            format=request.format,
            sample=request.sample,
            keep=request.keep,
        )
    assert scene is not None
    if request.colour is None:
        return scene.cloud
    from splatline.host.files.colouring import colour_scene

    return colour_scene(scene.cloud, request.colour)


def _view_of(
    request: RenderRequest, camera: dict[str, Any], scene: Scene | None, stages: Stages
) -> _View:
    """Read the cloud of a request and fit its view."""
    from splatline.host.cloud.upward import turn_upward

    cloud = _cloud_of(request, scene, stages)
    far_away = 0
    if request.fit != "all":
        with stages.stage("bulk", "Looking for points far from the rest"):
            cloud, far_away = _bulk(cloud)

    discs = measure_in_stages(cloud, stages, request.splat_size)
    with stages.stage("view", "Fitting the view"):
        view = see(cloud, camera, request.size, discs.radii)
        up = seen_from_above(request, camera, view)
        if up is not None:
            cloud = turn_upward(cloud, up)
    return _View(cloud, discs, view, camera, far_away)


def _encode(
    request: RenderRequest, cloud: Cloud, view: View, discs: Discs, stages: Stages, samples: int
) -> list[Frame]:
    """Return the frames of a cloud in memory."""
    from splatline.host.pipeline import make_frames, total_counts
    from splatline.host.shading.light_sets import LIGHTS

    options: dict[str, Any] = {
        "lighting": LIGHTS[request.lights],
        "config": request.preset,
        "quality": request.quality,
        "skips": request.skips,
        **discs._asdict(),
    }
    with stages.stage("", "Encoding") as share:
        frames = make_frames(cloud, view, samples, shapes=request.shapes, progress=share, **options)
    stages.seconds.update(total_counts(frames)["seconds"])
    if request.shapes != "table":
        # Only the number of bits is needed, so this time is not counted.
        with stages.stage("", "Encoding with the host's table, to compare") as share:
            others = make_frames(cloud, view, samples, progress=share, **options)
        for frame, other in zip(frames, others, strict=True):
            frame.counts["bits_sent"].update(other.counts["bits_sent"])
    return frames


def _far_note(far_away: int) -> list[str]:
    """Return a line about points far from the rest, if there are any."""
    if not far_away:
        return []
    points = "1 point lies" if far_away == 1 else f"{far_away:,} points lie"
    return [f"{points} far from the rest, and not in the picture; see --fit all"]


def read_in_stages(
    path: Path,
    stages: Stages,
    colour: ColourBy | None = None,
    *,
    format: str | None = None,
    sample: int | None = None,
    keep: frozenset[str] = frozenset(),
) -> Cloud:
    """Read a cloud file in the stages ``read`` and ``normals``; see ``read_cloud``."""
    from splatline.host.files.readers import read_cloud

    reading = {"read": f"Reading {path}", "normals": f"Estimating the normals of {path.name}"}
    with stages.stages(reading) as tell:
        return read_cloud(
            path, colour=colour, format=format, sample=sample, keep=keep, progress=tell
        )


def measure_in_stages(cloud: Cloud, stages: Stages, size: float | None = None) -> Discs:
    """Return a cloud's discs in the stage ``spacing``; see ``measure_discs``."""
    from splatline.host.cloud.spacing import measure_discs

    with stages.stage("spacing", f"Measuring the spacing of {len(cloud):,} points") as share:
        return measure_discs(cloud, size, progress=share)


def _bulk(cloud: Cloud) -> tuple[Cloud, int]:
    """Return the cloud without the points far from the rest, and their number."""
    from splatline.host.cloud.bulk import far_points, select

    far = far_points(cloud.positions)
    number = int(far.sum())
    return (select(cloud, ~far), number) if number else (cloud, 0)
