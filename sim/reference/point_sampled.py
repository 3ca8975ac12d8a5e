"""Point-sampled renderer in float64, in which each of the engine's approximations is optional.

Without any of them, the picture is the reference's at one sample a pixel. Footprints are true
discs in perspective. Rounding of position and size moves and scales a footprint as a whole. With
quantised normals, footprints are the paper's ellipses (equation 1). The renderer shares only the
definitions of quantisation with the host's encoder: quantised normals, shading table and palette.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud
from splatline.host.compiled_cache import cached_njit
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.materials import find_materials
from splatline.host.shading.normal_levels import level_slopes, quantise
from splatline.host.shading.shade import SHADE_LEVELS, shade_tables
from splatline.host.visibility.view import View

from .footprints import PLACES, SIZES, SPLAT, place_splats
from .point_sampled_kernel import DEPTHS, draw_bands
from .reference import face_eye, shade

__all__ = ["Picture", "Steps", "render"]

_Floats = npt.NDArray[np.float64]

GRAZING = -1e-6
"""Largest z of a normal for shading; normals that face further away are clamped to it."""


@dataclass(frozen=True, kw_only=True)
class Steps:
    """The approximations of a picture; by default there are none.

    Parameters
    ----------
    depth
        Where depth is sampled: at every ``pixel`` of the sloped disc, at the mean position of each
        ``fraction`` of the host's quality ``exact``, at the centre of the ``splat``, or at every
        pixel of the ``plane`` that a plane word holds, which needs ``depth_bits``.
    depth_bits
        Bits of a stored depth, whose largest value is the background's; None: not quantised.
    slope_bits
        Bits of a slope, for planes.
    reciprocal
        Depth codes are even steps of 1 / z instead of z.
    place
        Positions of centres: exact (``true``), or rounded to a ``quarter`` or a ``whole`` of a
        pixel. Whole positions are corners of the pixel grid.
    size
        Diameters: exact (``true``), or rounded to a ``half`` or a ``whole`` of a pixel.
    size_up
        Diameters are rounded up instead of to nearest.
    never_empty
        A splat that covers no pixel's centre draws the pixel that contains the splat's centre. If
        the splat's centre is a pixel corner, it draws the pixel nearest in the ellipse's metric and
        the half rotation of that pixel.
    normal_levels
        Shapes are the paper's ellipses of n', quantised as in ``host.encode.shape_table``.
    intensity_bits
        Bits of the intensities D and S in the table of quantised normals, whose viewer is on the
        image's axis; highlights are looked up by normals that make up for it, as the host's are.
        None: Phong's model at the disc's centre.
    shade_levels
        Levels of n'x and of n'y in that table.
    materials
        Largest number of colours in the palette; None: each point has its own colour.
    channel_bits
        Bits of a stored colour channel; None: not quantised.
    """

    depth: Literal["pixel", "fraction", "splat", "plane"] = "pixel"
    depth_bits: int | None = None
    slope_bits: int = 7
    reciprocal: bool = False
    place: Literal["true", "quarter", "whole"] = "true"
    size: Literal["true", "half", "whole"] = "true"
    size_up: bool = True
    never_empty: bool = False
    normal_levels: bool = False
    intensity_bits: int | None = None
    shade_levels: int = SHADE_LEVELS
    materials: int | None = None
    channel_bits: int | None = None


@dataclass(frozen=True)
class Picture:
    """A point-sampled picture.

    Parameters
    ----------
    rgb
        Shape (height, width, 3), float64, 0..1, background included.
    depth
        Distance along the view in the cloud's unit, decoded from the depth code; NaN where nothing
        was drawn. Shape (height, width), float64.
    seen
        Index of the point that a pixel shows, or -1: shape (height, width), int64.
    depth_range
        Nearest and furthest distance of the depth codes.
    """

    rgb: _Floats
    depth: _Floats
    seen: npt.NDArray[np.int64]
    depth_range: tuple[float, float]

    @property
    def drawn(self) -> npt.NDArray[np.bool_]:
        """Where anything was drawn: shape (height, width)."""
        return self.seen >= 0


def render(
    cloud: Cloud,
    view: View,
    radii: npt.ArrayLike,
    lighting: Lighting,
    steps: Steps = Steps(),
    *,
    background: tuple[float, float, float] = (1.0, 1.0, 1.0),
    depth_range: tuple[float, float] | None = None,
) -> Picture:
    """Draw a cloud of discs with one sample at each pixel's centre.

    Of splats with equal depth the first in the cloud is seen.

    Parameters
    ----------
    cloud, view, radii, lighting, background
        As for :func:`splatline.sim.reference.render`.
    steps
        The approximations.
    depth_range
        Nearest and furthest distance of the depth codes. By default those of the visible discs'
        rims if each pixel has a depth, else of their centres.

    Raises
    ------
    ValueError
        If planes have no bits of depth, or codes of 1 / z.
    """
    if steps.depth == "plane" and (steps.depth_bits is None or steps.reciprocal):
        raise ValueError("planes need bits of depth, whose codes are linear")
    radii = np.ascontiguousarray(radii, np.float64)
    centres = (cloud.positions - view.eye) @ view.axes.T
    normals, facing = face_eye(cloud, view, centres)

    discs = (centres, normals, facing, radii)
    camera = (view.focal, view.near, view.width, view.height, *view.middle)
    splats = np.zeros(len(cloud), SPLAT)
    rounding = (PLACES[steps.place], SIZES[steps.size], steps.size_up, steps.never_empty)
    slopes = level_slopes() if steps.normal_levels else np.empty(0)
    place_splats(discs, camera, rounding, slopes, splats)
    if depth_range is None:
        visible = splats["left"] <= splats["right"]
        depths = centres[visible, 2]
        reach = np.zeros(len(depths))
        if steps.depth in ("pixel", "plane"):
            across = 1.0 - normals[visible, 2].astype(np.float64) ** 2
            reach = radii[visible] * np.sqrt(np.maximum(across, 0.0))
        limits = float((depths - reach).min(initial=np.inf)), float((depths + reach).max(initial=0))
        depth_range = (max(limits[0], 0.0), limits[1]) if len(depths) else (0.0, 0.0)
    # Depths are compared as codes, which rise with distance.
    low, high = depth_range
    if steps.reciprocal:
        low, high = 1.0 / low, 1.0 / high
    largest = 0 if steps.depth_bits is None else (1 << steps.depth_bits) - 2
    slope = (1 << steps.slope_bits - 1) - 1 if steps.depth == "plane" else 0
    coding = (largest, steps.reciprocal, low, high - low if high != low else 1.0, slope)

    codes = np.full((view.height, view.width), np.inf)
    seen = np.full((view.height, view.width), -1, np.int64)
    draw_bands(splats, discs, camera, coding, DEPTHS[steps.depth], codes, seen)

    depth = np.where(seen >= 0, codes, np.nan)
    if largest:
        depth = coding[2] + depth / largest * coding[3]
        depth = 1.0 / depth if steps.reciprocal else depth
    colours = _colours(cloud, normals, centres, lighting, steps)
    rgb = _quantise_colour(colours[seen], steps) if len(cloud) else np.zeros((*seen.shape, 3))
    rgb = np.where(seen[..., np.newaxis] >= 0, rgb, np.asarray(background, np.float64))
    return Picture(rgb, depth, seen, depth_range)


def _colours(
    cloud: Cloud, normals: _Floats, centres: _Floats, lighting: Lighting, steps: Steps
) -> _Floats:
    """Return the colour of each splat before quantisation: shape (n, 3)."""
    base = cloud.colours
    if steps.materials is not None:
        found = find_materials(cloud, steps.materials)
        base = found.palette[found.index]
    if steps.intensity_bits is None:
        return shade(base, normals, centres, lighting)
    tables = shade_tables(lighting, steps.intensity_bits, steps.shade_levels)
    diffuse, specular = (
        _looked_up(table, seen)
        for table, seen in zip(tables, (normals, _turned_to_axis(normals, centres)), strict=True)
    )
    full = float((1 << steps.intensity_bits) - 1)
    shown: _Floats = base / 255.0 * (diffuse / full)[:, np.newaxis]
    shown += lighting.gloss * (specular / full)[:, np.newaxis]
    return shown.clip(0.0, 1.0)


def _turned_to_axis(normals: _Floats, centres: _Floats) -> _Floats:
    """Return normals whose highlight, seen from the axis, is as the viewer sees it: shape (n, 3).

    The table's viewer is on the image's axis. The bisector of light and viewer turns by about half
    of the angle between the axis and the direction v to the viewer, and the normal goes along:
    n + ((n.v) e - (n.e) v) / 2, with e against the axis.
    """
    away = np.linalg.norm(centres, axis=1, keepdims=True)
    viewer = -centres / np.maximum(away, np.finfo(np.float64).tiny)
    axis = np.array([0.0, 0.0, -1.0])
    facing = np.sum(normals * viewer, axis=1, keepdims=True)
    turned: _Floats = normals + 0.5 * (facing * axis + normals[:, 2:] * viewer)
    return np.ascontiguousarray(turned)


def _looked_up(table: npt.NDArray[np.uint16], normals: _Floats) -> npt.NDArray[np.uint16]:
    """Return the entries of a shade table for normals: shape (n,)."""
    level = np.empty((2, len(normals)), np.int64)
    _shade_levels(normals, len(table), level)
    return table[level[0], level[1]]


@cached_njit()
def _shade_levels(normals: Any, levels: int, level: Any) -> None:
    """Fill in each normal's levels of n'x and n'y."""
    for i in range(len(normals)):
        towards = min(normals[i, 2], GRAZING)
        level[0, i] = quantise(normals[i, 0], towards, levels)
        level[1, i] = quantise(normals[i, 1], towards, levels)


def _quantise_colour(rgb: _Floats, steps: Steps) -> _Floats:
    """Return a picture with its colours rounded to the levels of a stored channel."""
    if steps.channel_bits is None:
        return rgb
    largest = (1 << steps.channel_bits) - 1
    levels: _Floats = np.minimum(np.floor(rgb * largest + 0.5), largest) / largest
    return levels
