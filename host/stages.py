"""The host's stages: project, cull, shade, encode and sort, from a cloud's index to a frame."""

from __future__ import annotations

import dataclasses
import time
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.host.cloud.cloud import Cloud
from splatline.host.encode.close_specks import close_specks
from splatline.host.encode.encode import encode
from splatline.host.encode.sort_by_line import sort_by_line
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.materials import Materials, find_materials, material_tables
from splatline.host.shading.normal_levels import LEVELS
from splatline.host.shading.shade import SHADE_LEVELS, shade_bits
from splatline.host.visibility.block_index import Index, build_index
from splatline.host.visibility.depth_extent import depth_extent
from splatline.host.visibility.project import project
from splatline.host.visibility.splats import Splats
from splatline.host.visibility.view import View

__all__ = ["Stopwatch", "draw_up", "indexed", "splats_of", "useful_skips"]


def draw_up(
    index: Index,
    view: View,
    chosen: frozenset[str],
    *,
    lighting: Lighting | None,
    config: EngineConfig,
    quality: str,
    depth_range: tuple[float, float] | None,
    shapes: str,
    rounding: float = 0.5,
    cover: float = 1.0,
    close: bool = False,
) -> Frame:
    """Return a frame as :func:`make_frame` does; the frame is empty if nothing is in view.

    Parameters
    ----------
    chosen
        Reasons to leave points out; all are applied.
    rounding
        Rounding offset of colours; see ``material_tables``.
    cover
        How far small discs are trimmed; see ``trim``.
    close
        Whether specks are closed; see ``close_specks``.
    """
    clock = Stopwatch()
    lighting = lighting or Lighting()
    tables = material_tables(index.materials, lighting, config, rounding)
    useful = useful_skips(chosen, quality)
    clock.lap("tables")
    splats = splats_of(index, view, useful, lighting, config, quality, depth_range, cover)
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
    stream, control_words = sort_by_line(encoded, config)
    clock.lap("sort")
    counts = {
        "points": len(index),
        "dropped": index.cloud.dropped,
        "culled": culled,
        "elements": encoded.elements,
        "quality": quality,
        "skips": sorted(chosen),
        "shapes": shapes,
        "bits_sent": {shapes: config.codeword_bits * len(stream)},
        "codewords": len(stream),
        "control_words": control_words,
        "depth_range": list(splats.depth_range),
        "seconds": clock.laps,
    }
    frame = Frame(stream, tables, view.width, view.height, config, counts)
    if close:
        frame = close_specks(frame)
        clock.lap("close")
    return frame


def useful_skips(chosen: frozenset[str], quality: str) -> frozenset[str]:
    """Return the skips that a quality has a use for: the symmetric shapes always have a pixel."""
    return chosen - {"no_pixel", "overdrawn"} if quality == "paper" else chosen


def splats_of(
    index: Index,
    view: View,
    useful: frozenset[str],
    lighting: Lighting,
    config: EngineConfig,
    quality: str,
    depth_range: tuple[float, float] | None,
    cover: float,
) -> Splats:
    """Return the splats of a view, with their depth range.

    Parameters
    ----------
    useful
        The skips; see :func:`useful_skips`.
    depth_range, cover
        See :func:`make_frames`.
    """
    shades = shade_bits(lighting, config, LEVELS if quality == "paper" else SHADE_LEVELS)
    shift = config.material.lsb - config.diffuse.lsb
    splats = project(index, view, shades, shift, useful, cover)
    if depth_range is not None:
        return dataclasses.replace(splats, depth_range=_check_range(depth_range))
    if config.plane:  # each pixel has its own depth, and beyond the range none
        extent = depth_extent(splats, view, config.background_depth - 1)
        return dataclasses.replace(splats, depth_range=extent)
    return splats


def indexed(
    cloud: Cloud | Index,
    radii: npt.NDArray[np.floating[Any]] | None,
    thin: npt.NDArray[np.bool_] | None,
    materials: Materials | None,
    config: EngineConfig,
    clock: Stopwatch,
) -> Index:
    """Return a cloud's index, which is built if need be; ``clock`` gets its stages."""
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
        raise TypeError("a cloud needs radii; see measure_discs")
    if materials is None:
        materials = find_materials(cloud, 1 << config.material_bits)
        clock.lap("materials")
    index = build_index(cloud, radii, materials, thin)
    clock.lap("index")
    return index


def _check_range(limits: tuple[float, float]) -> tuple[float, float]:
    """Return two distances, or raise ``InputError`` unless they are finite and in order."""
    low, high = map(float, limits)
    if not (np.isfinite([low, high]).all() and low <= high):
        raise InputError(f"the depth range must be two distances in order, not {limits}")
    return low, high


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
