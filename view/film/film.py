"""A film of a cloud: its cameras, its frames, its file."""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from splatline.contract.atomic_write import atomic_stream, tell_unwritable
from splatline.contract.errors import InputError
from splatline.host.files.wanted import ColourBy
from splatline.view.camera import Camera
from splatline.view.draw import Settings, draw
from splatline.view.live_cloud import LiveCloud
from splatline.view.prepared import Drawable, prepare
from splatline.view.settings_of import settings_of

from .ahead import ahead
from .form import Form, Pixels, Write
from .keyframes import read_path
from .palette import find_palette
from .turntable import fit_turntable, turntable
from .write_gif import check_gif, write_gif
from .write_mp4 import check_mp4, write_mp4
from .write_webp import write_webp

__all__ = ["SUFFIXES", "TURNTABLE", "Film", "check_film", "film", "make_film", "plan_cameras"]

SUFFIXES = (".mp4", ".gif", ".webp")
"""Of the files that are written."""

TURNTABLE = "turntable"
"""The path of a camera that goes once round the cloud."""

SECONDS = 8.0
"""Length of a turntable."""

MOST_FRAMES = 100_000

PALETTE_FRAMES = 12
"""Frames that the palette of a GIF is made from."""


@dataclasses.dataclass(frozen=True)
class Film:
    """A film that was written.

    Parameters
    ----------
    path
        The file.
    frames, seconds, bytes
        Its number of frames, its length and its size.
    """

    path: Path
    frames: int
    seconds: float
    bytes: int


def film(
    cloud: Drawable,
    output: str | os.PathLike[str],
    *,
    seconds: float | None = None,
    fps: float = 30.0,
    path: str | os.PathLike[str] = TURNTABLE,
    fidelity: float = 80.0,
    size: tuple[int, int] = (512, 512),
    orbit: tuple[float, float] | None = None,
    fov: float | None = None,
    up: str | None = None,
    zoom: float | None = None,
    colour: str | ColourBy | None = None,
    fit: str = "bulk",
    splat_size: float | None = None,
    progress: Callable[[float], None] | None = None,
    **settings: Any,
) -> Film:
    """Draw a cloud from a moving camera and write it as ``.mp4``, ``.gif`` or ``.webp``.

    Each frame is the picture that ``render`` draws with the same camera.

    Parameters
    ----------
    cloud
        A cloud, a scene, or the name of a cloud's file.
    output
        The file. An MP4 needs the extra ``film``.
    seconds
        Length; None: 8 of a turntable, or that of the path.
    fps
        Frames a second.
    path
        ``turntable``, or a file of keyframes; see ``read_path``.
    fidelity
        Of an MP4 or a WebP, 0 to 100; a WebP of 100 has the frames' very pixels.
    size, orbit, fov, up, zoom, colour, fit, splat_size, **settings
        As of ``render``; the orbit is that of the first frame.
    progress
        Called with the share of the frames that are done.

    Raises
    ------
    InputError
        If the cloud or the path is bad, an option has no such value, or the file cannot be written.
    """
    chosen = settings_of(**settings)
    check_film(output, size, fps, fidelity, seconds)
    prepared = prepare(cloud, colour=colour, up=up, fit=fit, splat_size=splat_size)
    options = prepared.camera(orbit=orbit, fov=fov, up=up, zoom=zoom)
    live = prepared.live
    home = fit_turntable(live.cloud, live.discs.radii, size=size, **options)
    cameras = plan_cameras(home, path, seconds, fps)
    return make_film(
        live, cameras, output, size=size, fps=fps, fidelity=fidelity, settings=chosen,
        progress=progress,
    )  # fmt: skip


def check_film(
    output: str | os.PathLike[str],
    size: tuple[int, int],
    fps: float,
    fidelity: float,
    seconds: float | None,
) -> None:
    """Raise ``InputError`` if there is no such film, before anything is read or drawn."""
    suffix = Path(output).suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"{Path(output)}: the name must end in {', '.join(SUFFIXES)}")
    if not 0.1 <= fps <= 240.0:
        raise InputError(f"the frames a second must lie in 0.1 to 240, not {fps:g}")
    if not 0.0 <= fidelity <= 100.0:
        raise InputError(f"the fidelity must lie in 0 to 100, not {fidelity:g}")
    if seconds is not None and not 0.0 < seconds < math.inf:
        raise InputError(f"the film's seconds must be above 0, not {seconds:g}")
    form = Form(size, 1, fps, fidelity)
    if suffix == ".mp4":
        check_mp4(form)
    elif suffix == ".gif":
        check_gif(form)


def plan_cameras(
    home: Camera, path: str | os.PathLike[str], seconds: float | None, fps: float
) -> list[Camera]:
    """Return the camera of each frame.

    Parameters
    ----------
    home
        The camera of a turntable's first frame; it gives what the path's keyframes leave out.
    path, seconds, fps
        As of :func:`film`.
    """
    way = None if str(path) == TURNTABLE else read_path(Path(path), home)
    length = seconds or (SECONDS if way is None else way.seconds)
    count = max(1, round(min(length * fps, MOST_FRAMES + 1.0)))
    if count > MOST_FRAMES:
        raise InputError(f"a film has at most {MOST_FRAMES:,} frames, not {length * fps:,.0f}")
    return turntable(home, count) if way is None else way.cameras(count)


def make_film(
    live: LiveCloud,
    cameras: Sequence[Camera],
    output: str | os.PathLike[str],
    *,
    size: tuple[int, int],
    fps: float,
    fidelity: float = 80.0,
    settings: Settings | None = None,
    progress: Callable[[float], None] | None = None,
) -> Film:
    """Draw a frame for each camera and write the film, whole or not at all.

    Each core draws a frame of its own, while those before are encoded.

    Parameters
    ----------
    live
        The cloud.
    cameras
        A camera for each frame.
    output, size, fps, fidelity, progress
        As of :func:`film`; :func:`check_film` takes them.
    settings
        As of ``draw``.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    settings = settings or Settings()
    form = Form(size, len(cameras), fps, fidelity)
    picture = partial(_pixels, live, size, settings)
    write: Write
    suffix = Path(output).suffix.lower()
    if suffix == ".gif":
        some = np.unique(np.linspace(0, len(cameras) - 1, PALETTE_FRAMES).round().astype(int))
        red, green, blue = (round(255.0 * level) for level in settings.background)
        write = partial(
            write_gif,
            palette=find_palette(
                list(ahead(picture, [cameras[i] for i in some])), (red, green, blue)
            ),
        )
    else:
        write = write_mp4 if suffix == ".mp4" else write_webp
    frames = ahead(picture, cameras)
    try:
        with atomic_stream(output) as stream, tell_unwritable(output):
            write(_told(frames, len(cameras), progress), stream, form)
            size_in_bytes = stream.tell()
    finally:
        frames.close()
    return Film(Path(output), len(cameras), len(cameras) / fps, size_in_bytes)


def _pixels(live: LiveCloud, size: tuple[int, int], settings: Settings, camera: Camera) -> Pixels:
    """Return a frame: shape (height, width, 3), uint8."""
    return np.ascontiguousarray(draw(live, camera, size, settings).rgba[..., :3])


def _told(
    frames: Iterator[Pixels], count: int, progress: Callable[[float], None] | None
) -> Iterator[Pixels]:
    """Yield frames, and tell the share of them that are done."""
    for number, frame in enumerate(frames, 1):
        if progress is not None:
            progress(number / count)
        yield frame
