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
from splatline.host.visibility.skips import DEFAULT_SKIPS
from splatline.host.visibility.view import View
from splatline.sim.golden.multisample import average
from splatline.sim.golden.renderer import render

from .camera import Eye
from .live_cloud import LiveCloud
from .pixels import rgba_bytes

__all__ = ["BACKGROUND", "Drawing", "Settings", "draw"]

BACKGROUND = (23 / 255, 26 / 255, 31 / 255)
"""RGB of the background, that of ``splatline render``."""


@dataclass(frozen=True)
class Settings:
    """How a picture is drawn.

    Parameters
    ----------
    preset
        The engine.
    quality, samples, skips
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
        drawn = average(self.rasters)
        background = drawn.config.background_depth
        nearness = background - np.arange(background + 1.0)
        greys = (np.rint(nearness * (65535.0 / background)).astype(np.uint32) >> 8).astype(np.uint8)
        depth = drawn.depth
        rgba = np.full((*depth.shape, 4), 255, np.uint8)
        rgba[..., :3] = greys[depth][..., np.newaxis]
        return rgba

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
    camera: Eye,
    size: tuple[int, int],
    settings: Settings | None = None,
    *,
    check: Callable[[], None] = lambda: None,
) -> Drawing:
    """Draw a picture; an empty one if nothing of the cloud is in view.

    Parameters
    ----------
    live
        The cloud.
    camera
        Where it is seen from.
    size
        Width and height of the image in pixels. An image that is larger than the engine's is drawn
        in tiles, without seams.
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
    drawing = _draw(live, camera, size, settings, check)
    if drawing.counts["elements"] or not drawing.counts["culled"].get("no_pixel"):
        return drawing
    # As ``make_frames``: a picture of one pixel a point is better than an empty one.
    skips = settings.skips - {"no_pixel"}
    return _draw(live, camera, size, replace(settings, skips=skips), check)


def _draw(
    live: LiveCloud,
    camera: Eye,
    size: tuple[int, int],
    settings: Settings,
    check: Callable[[], None],
) -> Drawing:
    """Draw a picture with the skips as they are; see :func:`draw`."""
    config = settings.preset
    view = camera.view(live.cloud, size)
    cloud = live.index(config, camera.upward)
    options: dict[str, Any] = {
        "lighting": LIGHTS[settings.lights],
        "config": config,
        "quality": settings.quality,
        "skips": settings.skips,
        "may_be_empty": True,
    }
    if size[0] > config.max_width or size[1] > config.max_height:
        picture = tile_picture(
            cloud, view, settings.samples, progress=lambda share: check(), **options
        )
        frames, rasters, seconds = _draw_tiles(picture, settings.samples, check)
        counts = {**picture.counts, "samples": settings.samples}
    else:
        frames = make_frames(
            cloud, view, settings.samples, progress=lambda share: check(), **options
        )
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
        for tile, own in ((one.tile, one.frames) for one in row):
            check()
            columns, lines = tile.guard
            part = (
                slice(tile.origin_y + lines, tile.bottom),
                slice(tile.origin_x + columns, tile.right),
            )
            for frame, raster in zip(own, rasters, strict=True):
                if frame is None:
                    continue
                frames.append(frame)
                start = time.perf_counter()
                drawn = render(frame).without(columns, lines)
                seconds += time.perf_counter() - start
                raster.depth[part] = drawn.depth
                raster.colour[part] = drawn.colour
    return frames, rasters, seconds
