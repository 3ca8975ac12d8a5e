"""The exact reference: true discs in perspective, in float64, supersampled.

Errors of the engine's pictures are measured against it. Every point is a disc in space, and every
sample is a ray. The depth of a sample is that of the ray's intersection with the disc's plane.
Nothing is quantised. The reference uses the host's data types (cloud, view and lighting), but
none of its encoder.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud
from splatline.host.shading.lighting import Lighting
from splatline.host.visibility.view import View

from .reference_kernel import BAND, bound_discs, draw_bands, sort_into_bands

__all__ = ["Reference", "face_eye", "render", "shade"]

_Floats = npt.NDArray[np.float64]

BANDS_AT_ONCE = 4
"""Bands that each thread draws before the progress is told."""

MOST_SAMPLES = 16
"""Largest number of samples along a side of a pixel."""


@dataclass(frozen=True)
class Reference:
    """A picture drawn by the exact reference.

    Parameters
    ----------
    rgb
        Mean colour of the pixel's samples, background included: shape (height, width, 3), float64,
        0..1.
    depth
        Mean distance along the view, in the cloud's unit, of the pixel's samples that hit a disc;
        NaN if none does. Shape (height, width), float64.
    coverage
        Share of the pixel's samples that hit a disc: shape (height, width), float64, 0..1.
    """

    rgb: _Floats
    depth: _Floats
    coverage: _Floats


def render(
    cloud: Cloud,
    view: View,
    radii: npt.ArrayLike,
    lighting: Lighting,
    *,
    background: tuple[float, float, float] = (1.0, 1.0, 1.0),
    samples: int = 4,
    progress: Callable[[float], None] | None = None,
) -> Reference:
    """Draw a cloud of discs, exactly up to the sampling.

    A point is a flat disc about its position, perpendicular to its normal. Its colour is constant:
    Phong's model at the disc's centre. Discs that face away are not drawn; the normals of two-sided
    points are flipped towards the eye. A ray shows the nearest disc that it hits beyond the near
    plane, and of equally near discs the first in the cloud.

    Parameters
    ----------
    cloud
        Positions, normals and colours.
    view
        The camera.
    radii
        Radius of each point's disc, in the cloud's unit: shape (n,). A disc of radius 0 is not
        drawn.
    lighting
        The lights.
    background
        RGB in 0..1 of the samples that hit no disc.
    samples
        Samples along a side of a pixel, evenly spread and evenly weighted; 1 samples the pixel's
        centre alone.
    progress
        Called now and then with the share of the image's lines that are drawn.

    Raises
    ------
    ValueError
        If ``radii`` has another shape than the cloud, is negative or not finite, or if ``samples``
        is not in 1..16.
    """
    radii = np.ascontiguousarray(radii, np.float64)
    if radii.shape != (len(cloud),):
        raise ValueError(f"there must be one radius a point, {len(cloud)}, not {radii.shape}")
    if not (np.isfinite(radii) & (radii >= 0.0)).all():
        raise ValueError("radii must be finite and at least 0")
    if not 1 <= samples <= MOST_SAMPLES:
        raise ValueError(f"samples must be in 1..{MOST_SAMPLES}, not {samples}")

    centres = (cloud.positions - view.eye) @ view.axes.T
    # In a power of two of the cloud's unit, which changes no digit: fourth powers of lengths must
    # not under- or overflow.
    exponent = int(np.frexp(np.abs(centres).max())[1]) if centres.size else 0
    centres, radii = np.ldexp(centres, -exponent), np.ldexp(radii, -exponent)
    near = float(np.ldexp(view.near, -exponent))
    normals, facing = face_eye(cloud, view, centres)
    colours = shade(cloud.colours, normals, centres, lighting)

    size = (view.width * samples, view.height * samples)
    optics = (view.focal * samples, view.middle[0] * samples, view.middle[1] * samples, near)
    boxes = np.empty((len(cloud), 4), np.int64)
    bound_discs(centres, normals, facing, radii, optics, size, boxes)
    band = BAND * samples
    starts, members = sort_into_bands(boxes, band, -(-size[1] // band))

    rgb = np.empty((view.height, view.width, 3))
    depth = np.empty((view.height, view.width))
    coverage = np.empty((view.height, view.width))
    discs = starts, members, boxes, centres, normals, radii, colours
    ground = np.asarray(background, np.float64)
    for part in _parts(len(starts) - 1, progress):
        draw_bands(part, *discs, optics, samples, ground, rgb, depth, coverage)
    return Reference(rgb, np.ldexp(depth, exponent), coverage)


def _parts(bands: int, progress: Callable[[float], None] | None) -> Iterator[tuple[int, int]]:
    """Yield the first band and the one past the last of each part, and tell the share after it."""
    step = bands if progress is None else BANDS_AT_ONCE * numba.get_num_threads()
    for first in range(0, bands, max(step, 1)):
        last = min(first + step, bands)
        yield first, last
        if progress is not None:
            progress(last / bands)


def face_eye(cloud: Cloud, view: View, centres: _Floats) -> tuple[_Floats, npt.NDArray[np.bool_]]:
    """Return unit normals in camera axes, and which discs face the eye.

    Normals of two-sided points are flipped towards the eye.
    """
    normals = cloud.normals.astype(np.float64) @ view.axes.T
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    away = np.einsum("ij,ij->i", normals, centres)
    flipped = cloud.two_sided & (away > 0.0)
    normals[flipped] *= -1.0
    # A disc that is edge-on or has no normal (away is 0) has no area on the image.
    return normals, (away < 0.0) | flipped


def shade(
    base: npt.NDArray[np.uint8], normals: _Floats, centres: _Floats, lighting: Lighting
) -> _Floats:
    """Return the colour of each disc by Phong's model, as :class:`Lighting` defines it.

    A light behind a disc contributes nothing to it, neither diffuse nor specular.
    """
    distances = np.linalg.norm(centres, axis=1, keepdims=True)
    to_eye = np.divide(-centres, distances, out=np.zeros_like(centres), where=distances > 0.0)
    diffuse = np.full(len(centres), lighting.ambient)
    specular = np.zeros(len(centres))
    for light in lighting.lights:
        direction = np.asarray(light.direction, np.float64)
        length = np.linalg.norm(direction)
        direction = direction / length
        incidence = normals @ direction
        mirrored = 2.0 * incidence[:, np.newaxis] * normals - direction
        glance = np.maximum(np.einsum("ij,ij->i", mirrored, to_eye), 0.0)
        diffuse += light.intensity * np.maximum(incidence, 0.0)
        specular += np.where(incidence > 0.0, light.intensity * glance**lighting.shininess, 0.0)
    diffuse = np.clip(diffuse, 0.0, 1.0)
    specular = np.clip(specular, 0.0, 1.0)
    shown: _Floats = base / 255.0 * diffuse[:, np.newaxis]
    shown += lighting.gloss * specular[:, np.newaxis]
    return shown.clip(0.0, 1.0)
