"""Shade tables: the diffuse and specular intensity of each quantised normal."""

from __future__ import annotations

import functools

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig

from .lighting import Lighting
from .normal_levels import level_slopes

__all__ = ["SHADE_LEVELS", "shade_bits", "shade_tables"]

SHADE_LEVELS = 256
"""Levels of n'x and of n'y for shades. The quality ``paper`` uses the levels of its shapes."""


def shade_tables(
    lighting: Lighting, intensity_bits: int, levels: int = SHADE_LEVELS
) -> tuple[npt.NDArray[np.uint16], npt.NDArray[np.uint16]]:
    """Return the diffuse and specular intensity of every quantised normal.

    Phong's model, as :class:`Lighting` states it, with the viewer on the image's axis. The tables
    are the paper's: a look-up by n' replaces the model for every point.

    Parameters
    ----------
    lighting
        Any number of directional lights.
    intensity_bits
        Bits of D and of S; an intensity of 1 is their largest value.
    levels
        Levels of n'x and of n'y.

    Returns
    -------
    diffuse, specular
        Shape (levels, levels), uint16, by the levels of n'x and n'y.
    """
    slopes = level_slopes(levels)
    x, y = np.meshgrid(slopes, slopes, indexing="ij")
    normal = -np.stack([x, y, np.ones_like(x)], axis=-1)  # towards the eye: z points away from it
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    diffuse = np.full(x.shape, lighting.ambient)
    specular = np.zeros(x.shape)
    for light in lighting.lights:
        towards = np.asarray(light.direction, np.float64)
        towards = towards / np.linalg.norm(towards)
        cosine = np.maximum(normal @ towards, 0.0)
        diffuse += light.intensity * cosine
        mirrored_z = 2.0 * cosine * normal[..., 2] - towards[2]
        glance = np.where(cosine > 0.0, np.maximum(-mirrored_z, 0.0), 0.0)
        specular += light.intensity * glance**lighting.shininess
    full = (1 << intensity_bits) - 1

    def rounded(intensity: npt.NDArray[np.float64]) -> npt.NDArray[np.uint16]:
        return np.rint(np.clip(intensity, 0.0, 1.0) * full).astype(np.uint16)

    return rounded(diffuse), rounded(specular)


@functools.lru_cache(maxsize=8)
def shade_bits(
    lighting: Lighting, config: EngineConfig, levels: int = SHADE_LEVELS
) -> npt.NDArray[np.uint32]:
    """Return DIFFUSE and SPECULAR of every quantised normal, as they lie in a code word.

    The table is cached, as it takes longer than a small frame.

    Returns
    -------
    ndarray
        Shape (2, levels, levels), uint32, read-only: DIFFUSE, then SPECULAR; bit 0 is the lowest of
        DIFFUSE.
    """
    diffuse, specular = shade_tables(lighting, config.intensity_bits, levels)
    shift = np.uint32(config.specular.lsb - config.diffuse.lsb)
    bits = np.stack([diffuse.astype(np.uint32), specular.astype(np.uint32) << shift])
    bits.setflags(write=False)
    return bits
