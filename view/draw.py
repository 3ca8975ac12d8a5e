"""Draws a picture of a live cloud: the golden renderer's, bit for bit the engine's."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.contract.presets import DEFAULT
from splatline.contract.raster import Raster
from splatline.host.encode.quality import DEFAULT_QUALITY
from splatline.host.picture_tiles.frames import TiledPicture, tile_picture
from splatline.host.pipeline import make_frames, total_counts
from splatline.host.shading.light_sets import DEFAULT_LIGHTS, LIGHTS
from splatline.host.visibility.block_index import Index
from splatline.host.visibility.skips import DEFAULT_SKIPS
from splatline.host.visibility.view import View
from splatline.plots.figure import BACKGROUND, depth_levels
from splatline.sim.golden.multisample import average
from splatline.sim.golden.renderer import render

from .camera import Camera
from .live_cloud import LiveCloud
from .pixels import opaque, rgba_bytes

__all__ = ["Drawing", "Settings", "draw", "draw_view"]


@dataclass(frozen=True)
class Settings:
    """Settings of a picture.

    Parameters
    ----------
    preset
        The engine.
    quality, samples, skips, close_specks
        As of ``make_frames``.
    lights
        One of ``LIGHTS``.
    background
        RGB in 0..1 of the pixels that nothing is drawn into.
    """

    preset: EngineConfig = DEFAULT
    quality: str = DEFAULT_QUALITY
    samples: int = 1
    skips: frozenset[str] = DEFAULT_SKIPS
    lights: str = DEFAULT_LIGHTS
    background: tuple[float, float, float] = BACKGROUND
    close_specks: bool = True


@dataclass(frozen=True)
class Drawing:
    """A picture, and what it was made of.

    Parameters
    ----------
    view
        What the camera saw.
    frames
        The code words: one frame for each sample of a pixel, and for each tile if the image is
        larger than the engine's; a tile's frame that draws nothing is left out.
    rasters
        The picture of each sample of a pixel.
    counts
        Statistics of the frames together; see ``make_frames``.
    background
        See :class:`Settings`.
    golden_seconds
        Time that the golden renderer took.
    """

    view: View
    frames: list[Frame]
    rasters: list[Raster]
    counts: dict[str, Any]
    background: tuple[float, float, float]
    golden_seconds: float = 0.0

    @cached_property
    def rgba(self) -> npt.NDArray[np.uint8]:
        """The picture: shape (height, width, 4), uint8; the bytes of ``splatline render``'s PNG."""
        return rgba_bytes(self.rasters, self.background)

    @cached_property
    def depth_rgba(self) -> npt.NDArray[np.uint8]:
        """The depth as greys: near is white, the background black. Shape (height, width, 4).

        A grey is the upper byte of the level in the picture of ``splatline render --depth``.
        """
        levels = depth_levels(average(self.rasters))
        return opaque((levels >> 8)[..., np.newaxis])

    def depth_at(self, column: int, line: int) -> float | None:
        """Return the distance along the view at a pixel, in the cloud's unit; None: background.

        Raises
        ------
        IndexError
            If the pixel lies outside the image.
        """
        raster = self.rasters[0]
        if not (0 <= column < self.view.width and 0 <= line < self.view.height):
            raise IndexError(f"no pixel {column}, {line}")
        code = int(raster.depth[line, column])
        last = raster.config.background_depth - 1
        if code > last:
            return None
        nearest, farthest = self.counts["depth_range"]
        return float(nearest + (farthest - nearest) * code / last)


def draw(
    live: LiveCloud,
    camera: Camera,
    size: tuple[int, int],
    settings: Settings | None = None,
    *,
    check: Callable[[], None] = lambda: None,
) -> Drawing:
    """Draw what a camera sees on an image of a size in pixels; see :func:`draw_view`."""
    return draw_view(live, camera.view(live.cloud, size), camera.upward, settings, check=check)


def draw_view(
    live: LiveCloud,
    view: View,
    upward: str | None,
    settings: Settings | None = None,
    *,
    check: Callable[[], None] = lambda: None,
) -> Drawing:
    """Draw a picture; an empty one if nothing of the cloud is in view.

    Parameters
    ----------
    live
        The cloud.
    view
        What is seen of it. An image that is larger than the engine's is drawn in tiles, without
        seams.
    upward
        The axis up if the view looks down or is level; else None.
    settings
        How it is drawn; None: as by default.
    check
        Called after each sample and each tile. It may raise an exception, which ends the drawing.

    Raises
    ------
    InputError
        If an option has no such value, or does not go with another.
    """
    settings = settings or Settings()
    index = live.index(settings.preset, upward)
    cover = live.discs.drawn(close_specks=settings.close_specks).cover
    drawing = _draw(index, view, settings, cover, check)
    if drawing.counts["elements"] or not drawing.counts["culled"].get("no_pixel"):
        return drawing
    # As ``make_frames``: a picture of one pixel a point is better than an empty one.
    skips = settings.skips - {"no_pixel"}
    return _draw(index, view, replace(settings, skips=skips), cover, check)


def _draw(
    index: Index, view: View, settings: Settings, cover: float, check: Callable[[], None]
) -> Drawing:
    """Draw a picture with the skips as they are; see :func:`draw_view` and ``trim``."""
    config = settings.preset
    options: dict[str, Any] = {
        "lighting": LIGHTS[settings.lights],
        "config": config,
        "quality": settings.quality,
        "skips": settings.skips,
        "close_specks": settings.close_specks,
        "cover": cover,
        "may_be_empty": True,
        "progress": lambda share: check(),
    }
    if view.width > config.max_width or view.height > config.max_height:
        picture = tile_picture(index, view, settings.samples, **options)
        frames, rasters, seconds = _draw_tiles(picture, settings.samples, check)
        counts = {**picture.counts, "samples": settings.samples}
    else:
        frames = make_frames(index, view, settings.samples, **options)
        start = time.perf_counter()
        rasters, counts = [render(frame) for frame in frames], total_counts(frames)
        seconds = time.perf_counter() - start
    return Drawing(view, frames, rasters, counts, settings.background, seconds)


def _draw_tiles(
    picture: TiledPicture, samples: int, check: Callable[[], None]
) -> tuple[list[Frame], list[Raster], float]:
    """Return the frames of a picture's tiles, the raster of each sample, and golden's seconds."""
    grid, config = picture.grid, picture.config
    rasters = [Raster.background(grid.width, grid.height, config) for _ in range(samples)]
    frames: list[Frame] = []
    seconds = 0.0
    for row in picture.rows():
        for own in row:
            check()
            place = own.tile.place
            for frame, raster in zip(own.frames, rasters, strict=True):
                if frame is None:
                    continue
                frames.append(frame)
                start = time.perf_counter()
                drawn = render(frame).part(*own.tile.own)
                seconds += time.perf_counter() - start
                raster.depth[place] = drawn.depth
                raster.colour[place] = drawn.colour
    return frames, rasters, seconds
