"""The host's work from end to end: a cloud and a view in, a frame for the engine out."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from ..rtl.format import PAPER, EngineConfig
from .cloud import Cloud
from .encode import encode
from .errors import InputError
from .frame import Frame
from .index import Index, build_index
from .lighting import Lighting
from .materials import Materials, find_materials, material_tables
from .order import sort_by_line
from .project import project
from .quality import DEFAULT_QUALITY, QUALITIES
from .shade import SHADE_LEVELS, shade_bits
from .shape_source import check_shapes
from .shapes import LEVELS
from .skips import DEFAULT_SKIPS, check_skips
from .view import View

__all__ = ["Stopwatch", "indexed", "make_frame"]


def make_frame(
    cloud: Cloud | Index,
    view: View,
    *,
    radii: npt.NDArray[np.floating[Any]] | None = None,
    lighting: Lighting | None = None,
    materials: Materials | None = None,
    config: EngineConfig = PAPER,
    quality: str = DEFAULT_QUALITY,
    skips: Iterable[str] = DEFAULT_SKIPS,
    depth_range: tuple[float, float] | None = None,
    shapes: str = "table",
    rounding: float = 0.5,
) -> Frame:
    """Project, cull, shade, encode and sort a cloud.

    Parameters
    ----------
    cloud
        The points; or their index (``build_index``), built once for many frames.
    view
        The camera and the size of the image.
    radii
        Radius of each point's disc, in the cloud's unit: shape (n,); see ``splat_radii``. An index
        has them already.
    lighting
        Lights and surface; the default ones if not given.
    materials
        The cloud's palette; found if not given. An index has it already.
    config
        The engine to draw it.
    quality
        One of ``QUALITIES``: ``paper``, ``fast`` or ``exact``.
    skips
        What to leave out, by name; see ``SKIPS``. If ``no_pixel`` would leave nothing at all, it is
        not applied.
    depth_range
        Distances along the view of depth 0 and of the largest depth, so that frames of one view can
        be put together; fitted to what is seen if not given.
    shapes
        One of ``SHAPE_SOURCES``: where the shapes of the quality ``paper`` come from.
    rounding
        What of a colour's level is added before the engine cuts it off; see ``material_tables``.

    Returns
    -------
    Frame
        ``counts`` has ``points``, ``dropped`` (reason -> points left out when the cloud was read),
        ``culled`` (reason -> points), ``elements`` (points drawn), ``quality``, ``skips``,
        ``shapes``, ``bits_sent`` (those of the stream, by the name of ``shapes``),
        ``codewords`` (length of the stream), ``control_words``, ``depth_range`` (distances along
        the view of depth 0 and of the largest depth) and ``seconds`` (per stage).

    Raises
    ------
    InputError
        If the image is larger than the engine's, or shows nothing of the cloud, or a radius is
        missing, negative or not finite; or if there is no quality, skip or source of shapes of a
        given name, or the ROM does not go with the rest.
    """
    check_size(view.width, view.height, config)
    chosen = check_skips(skips)
    if quality not in QUALITIES:
        raise InputError(f"no quality named {quality!r}; there are: {', '.join(QUALITIES)}")
    check_shapes(shapes, quality, chosen, config)
    clock = Stopwatch()
    index = indexed(cloud, radii, materials, config, clock)
    lighting = lighting or Lighting()
    tables = material_tables(index.materials, lighting, config, rounding)
    shades = shade_bits(lighting, config, LEVELS if quality == "paper" else SHADE_LEVELS)
    clock.lap("tables")
    # The symmetric shapes always have a pixel.
    useful = chosen - {"no_pixel"} if quality == "paper" else chosen
    splats = project(index, view, shades, config.material.lsb - config.diffuse.lsb, useful)
    if depth_range is not None:
        splats = dataclasses.replace(splats, depth_range=_check_range(depth_range))
    clock.lap("project")
    encoded = encode(
        splats,
        view,
        config,
        quality,
        nearest_pixel="no_pixel" not in useful,
        skip_hidden="hidden" in useful,
        compact=shapes == "rom",
    )
    clock.lap("encode")
    culled = splats.culled
    culled["hidden"] = encoded.hidden
    culled["no_pixel"] += len(splats) - encoded.elements - encoded.hidden
    if not encoded.elements and culled["no_pixel"] and "no_pixel" in useful:
        # Better a pixel for each than a picture of nothing.
        return make_frame(
            index,
            view,
            lighting=lighting,
            config=config,
            quality=quality,
            skips=chosen - {"no_pixel"},
            depth_range=depth_range,
            shapes=shapes,
            rounding=rounding,
        )
    name, points, dropped = index.cloud.name, len(index), index.cloud.dropped
    if not encoded.elements:
        raise InputError(
            f"nothing of {name} is in view: of {points} points, "
            + ", ".join(f"{count} {reason}" for reason, count in culled.items() if count)
            + "; change the view"
        )
    stream, control_words = sort_by_line(encoded, config)
    clock.lap("sort")
    counts = {
        "points": points,
        "dropped": dropped,
        "culled": culled,
        "elements": encoded.elements,
        "quality": quality,
        "skips": sorted(chosen),
        "shapes": shapes,
        "bits_sent": {shapes: 8 * stream.nbytes},
        "codewords": len(stream),
        "control_words": control_words,
        "depth_range": list(splats.depth_range),
        "seconds": clock.laps,
    }
    return Frame(stream, tables, view.width, view.height, config, counts)


def indexed(
    cloud: Cloud | Index,
    radii: npt.NDArray[np.floating[Any]] | None,
    materials: Materials | None,
    config: EngineConfig,
    clock: Stopwatch,
) -> Index:
    """Return a cloud's index, built if need be; ``clock`` has the stages that this took."""
    if isinstance(cloud, Index):
        if radii is not None or materials is not None:
            raise TypeError("an index has radii and materials already")
        found, most = len(cloud.materials.palette), 1 << config.material_bits
        if found > most:
            raise InputError(
                f"the index has {found} materials, an engine of preset {config.name} holds {most}"
            )
        return cloud
    if radii is None:
        raise TypeError("a cloud needs radii; see splat_radii")
    if materials is None:
        materials = find_materials(cloud, 1 << config.material_bits)
        clock.lap("materials")
    index = build_index(cloud, radii, materials)
    clock.lap("index")
    return index


def _check_range(limits: tuple[float, float]) -> tuple[float, float]:
    """Return two distances, or raise ``InputError`` unless they are finite and in order."""
    low, high = map(float, limits)
    if not (np.isfinite([low, high]).all() and low <= high):
        raise InputError(f"the depth range must be two distances in order, not {limits}")
    return low, high


def check_size(width: int, height: int, config: EngineConfig) -> None:
    """Raise ``InputError`` if an engine cannot draw an image of this size."""
    if width > config.max_width or height > config.max_height:
        raise InputError(
            f"the image is {width}x{height}; an engine of preset {config.name} draws at most "
            f"{config.max_width}x{config.max_height}"
        )


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
