"""Preparation of a render request: reading the cloud, fitting the view, encoding the frames."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from splatline.cli.report.progress import Stages

from .camera import see, with_camera
from .large import is_large, prepare_large, prepare_large_tiles
from .prepared import PreparedFrames, PreparedTiles
from .request import RenderRequest

if TYPE_CHECKING:
    from splatline.contract.frame import Frame
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.cloud.spacing import Discs
    from splatline.host.files.wanted import ColourBy
    from splatline.host.scenes.scenes import Scene
    from splatline.host.visibility.view import View

__all__ = ["cloud_of", "prepare", "prepare_tiles"]


@dataclass(frozen=True)
class _View:
    """The cloud of a render request in memory, and its view.

    Parameters
    ----------
    cloud, discs, view
        The points, their discs and the camera.
    far_away
        See :class:`PreparedFrames`.
    """

    cloud: Cloud
    discs: Discs
    view: View
    far_away: int

    @property
    def notes(self) -> list[str]:
        """Remarks about the cloud, each in one line."""
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
        discs=prepared.discs,
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
            close_specks=request.close_specks,
        )
    return PreparedTiles(
        picture=picture,
        camera=camera,
        dropped=cloud.dropped,
        colour_key=cloud.colour_key,
        notes=prepared.notes,
        far_away=prepared.far_away,
    )


def cloud_of(request: RenderRequest, scene: Scene | None, stages: Stages) -> Cloud:
    """Return the cloud of a request in memory, in the colours that are asked for."""
    if request.path is not None:
        return _read(
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
    from splatline.host.cloud.bulk import without_far_points
    from splatline.host.cloud.upward import turn_upward, upward_of

    cloud = cloud_of(request, scene, stages)
    far_away = 0
    if request.fit != "all":
        with stages.stage("bulk", "Looking for points far from the rest"):
            cloud, far_away = without_far_points(cloud)
    discs = _measure(cloud, stages, request.splat_size).drawn(close_specks=request.close_specks)
    with stages.stage("view", "Fitting the view"):
        view = see(cloud, camera, request.size, discs.radii)
        cloud = turn_upward(cloud, upward_of(camera["orbit"], camera["up"]))
    return _View(cloud, discs, view, far_away)


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
        "close_specks": request.close_specks,
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


def _read(
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


def _measure(cloud: Cloud, stages: Stages, size: float | None = None) -> Discs:
    """Return a cloud's discs in the stage ``spacing``; see ``measure_discs``."""
    from splatline.host.cloud.spacing import measure_discs

    with stages.stage("spacing", f"Measuring the spacing of {len(cloud):,} points") as share:
        return measure_discs(cloud, size, progress=share)
