"""The host's work from end to end: a cloud and a view in, a frame for the engine out."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import numpy.typing as npt

from ..rtl.format import PAPER, EngineConfig
from .cloud import Cloud
from .encode import depth_shares, encode
from .errors import InputError
from .frame import Frame
from .lighting import Lighting
from .materials import Materials, find_materials, material_tables
from .order import sort_by_line
from .project import project
from .quality import DEFAULT_QUALITY, QUALITIES
from .shade import shade_tables
from .view import View

__all__ = ["make_frame"]


def make_frame(
    cloud: Cloud,
    view: View,
    *,
    radii: npt.NDArray[np.floating[Any]],
    lighting: Lighting | None = None,
    materials: Materials | None = None,
    config: EngineConfig = PAPER,
    quality: str = DEFAULT_QUALITY,
) -> Frame:
    """Project, cull, shade, encode and sort a cloud.

    Parameters
    ----------
    cloud
        The points.
    view
        The camera and the size of the image.
    radii
        Radius of each point's disc, in the cloud's unit: shape (n,); see ``splat_radii``.
    lighting
        Lights and surface; the default ones if not given.
    materials
        The cloud's palette, to find it once for many frames.
    config
        The engine to draw it.
    quality
        One of ``QUALITIES``: ``paper``, ``fast`` or ``exact``.

    Returns
    -------
    Frame
        ``counts`` has ``points``, ``dropped`` (reason -> points left out when the cloud was read),
        ``culled`` (reason -> points), ``elements`` (points drawn), ``codewords`` (length of the
        stream), ``control_words``, ``depth_range`` (distances along the view of depth 0 and of the
        largest depth) and ``seconds`` (per stage).

    Raises
    ------
    InputError
        If the image is larger than the engine's, or shows nothing of the cloud, or a radius is
        missing, negative or not finite.
    """
    check_size(view.width, view.height, config)
    check_radii(radii, len(cloud))
    if quality not in QUALITIES:
        raise InputError(f"no quality named {quality!r}; there are: {', '.join(QUALITIES)}")
    lighting = lighting or Lighting()
    clock = Stopwatch()
    if materials is None:
        materials = find_materials(cloud)
    tables = material_tables(materials, lighting, config)
    clock.lap("materials")
    splats = project(cloud, view, radii)
    clock.lap("project")
    diffuse, specular = shade_tables(lighting, config.intensity_bits)
    shades = diffuse[splats.shade], specular[splats.shade]
    material = materials.index[splats.point]
    clock.lap("shade")
    depth, gradient, depth_range = depth_shares(splats, view.focal)
    encoded = encode(splats, depth, gradient, (*shades, material), view, config, quality)
    clock.lap("encode")
    if not encoded.elements:
        raise InputError(
            f"nothing of {cloud.name} is in view: of {len(cloud)} points, "
            + ", ".join(f"{count} {reason}" for reason, count in splats.culled.items())
            + "; change the view"
        )
    stream, control_words = sort_by_line(encoded.words, encoded.lines, config)
    clock.lap("sort")
    counts = {
        "points": len(cloud),
        "dropped": cloud.dropped,
        "culled": {**splats.culled, "no_pixel": len(splats) - encoded.elements},
        "elements": encoded.elements,
        "quality": quality,
        "codewords": len(stream),
        "control_words": control_words,
        "depth_range": list(depth_range),
        "seconds": clock.laps,
    }
    return Frame(stream, tables, view.width, view.height, config, counts)


def check_size(width: int, height: int, config: EngineConfig) -> None:
    """Raise ``InputError`` if an engine cannot draw an image of this size."""
    if width > config.max_width or height > config.max_height:
        raise InputError(
            f"the image is {width}x{height}; an engine of preset {config.name} draws at most "
            f"{config.max_width}x{config.max_height}"
        )


def check_radii(radii: npt.NDArray[np.floating[Any]], count: int) -> None:
    """Raise ``InputError`` unless there is a length for every point."""
    if np.shape(radii) != (count,):
        raise InputError(f"there must be one radius a point, {count}, not {np.shape(radii)}")
    if count and not (np.isfinite(radii).all() and np.min(radii) >= 0.0):
        raise InputError("every radius must be a finite length, 0 or more")


class Stopwatch:
    """Seconds of each stage."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, stage: str) -> None:
        """End a stage."""
        now = time.perf_counter()
        self.laps[stage] = now - self._last
        self._last = now
