"""Reflection and diffusion tables: how bright a surface of each quantised normal is."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..rtl.format import EngineConfig
from .lighting import Lighting
from .shapes import level_slopes

__all__ = ["shade_bits", "shade_tables"]


def shade_tables(
    lighting: Lighting, intensity_bits: int
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

    Returns
    -------
    diffuse, specular
        Shape (64 * 64,), uint16, by ``64 * level of n'x + level of n'y``.
    """
    slopes = level_slopes()
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

    def levels(intensity: npt.NDArray[np.float64]) -> npt.NDArray[np.uint16]:
        return np.rint(np.clip(intensity, 0.0, 1.0) * full).astype(np.uint16).ravel()

    return levels(diffuse), levels(specular)


def shade_bits(lighting: Lighting, config: EngineConfig) -> npt.NDArray[np.uint32]:
    """Return DIFFUSE and SPECULAR of every quantised normal, as they lie in a code word.

    Returns
    -------
    ndarray
        Shape (2, 64 * 64), uint32: DIFFUSE, then SPECULAR; bit 0 is the lowest of DIFFUSE.
    """
    diffuse, specular = shade_tables(lighting, config.intensity_bits)
    shift = np.uint32(config.specular.lsb - config.diffuse.lsb)
    return np.stack([diffuse.astype(np.uint32), specular.astype(np.uint32) << shift])
