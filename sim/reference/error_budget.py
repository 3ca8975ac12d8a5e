"""The error budget: error after each approximation, from exact samples to the engine's picture."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.contract.raster import Raster
from splatline.host.cloud.cloud import Cloud
from splatline.host.encode.shape_table import LEVELS
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.shade import SHADE_LEVELS
from splatline.host.visibility.view import View

from . import metrics
from .point_multisample import render_samples
from .point_sampled import Picture, Steps
from .reference import Reference

__all__ = ["LADDERS", "Step", "blurred_psnr", "ladder", "measure", "walk"]

LADDERS = ("paper", "exact")
"""The qualities that have an error budget."""

BLUR = 1.5
"""Standard deviation in pixels of the blur of ``blurred_psnr``, the same as in SSIM."""


@dataclass(frozen=True)
class Step:
    """One step of an error budget.

    Parameters
    ----------
    name
        Name of the approximation that this step adds.
    steps
        All approximations up to this step.
    """

    name: str
    steps: Steps


def ladder(quality: str, config: EngineConfig = PAPER, samples: int = 1) -> list[Step]:
    """Return the steps from exact samples to an engine's picture.

    Parameters
    ----------
    quality
        One of ``LADDERS``. ``paper`` has one depth a splat, whole positions and diameters and the
        shape table; ``exact`` has one depth a fraction and exact footprints, or with an engine
        with planes a depth for every pixel.
    config
        The engine's configuration: bits of depth, intensity and colour, number of materials.
    samples
        Samples a pixel, which the name of the first step states.

    Returns
    -------
    list of Step
        Each step adds to the one before it the approximation that its name states.
    """
    if quality not in LADDERS:
        raise ValueError(f"no ladder leads to {quality!r}; there are: {', '.join(LADDERS)}")
    per = "splat" if quality == "paper" else "fraction"
    changes: list[tuple[str, dict[str, Any]]] = [
        (f"one depth a {per}", {"depth": per}),
        (f"{config.depth_bits}-bit depth", {"depth_bits": config.depth_bits}),
    ]
    if config.plane and quality == "exact":
        changes = [
            changes[1],
            (
                f"{config.slope_bits}-bit slopes",
                {"depth": "plane", "slope_bits": config.slope_bits},
            ),
        ]
    if quality == "paper":
        changes += [
            ("whole places", {"place": "whole", "never_empty": True}),
            ("whole diameters", {"size": "whole"}),
            ("levels of n'", {"normal_levels": True}),
        ]
    colour = f"{config.channel_bits}-bit colour"
    levels = LEVELS if quality == "paper" else SHADE_LEVELS
    changes += [
        ("shading table", {"intensity_bits": config.intensity_bits, "shade_levels": levels}),
        ("materials", {"materials": 1 << config.material_bits}),
        (colour, {"channel_bits": config.channel_bits}),
    ]
    first = "one sample a pixel" if samples == 1 else f"{samples} samples a pixel"
    rungs = [Step(first, Steps())]
    for name, change in changes:
        rungs.append(Step(name, replace(rungs[-1].steps, **change)))
    return rungs


def walk(
    rungs: list[Step],
    cloud: Cloud,
    view: View,
    radii: npt.ArrayLike,
    lighting: Lighting,
    exact: Reference,
    background: tuple[float, float, float],
    samples: int = 1,
) -> Iterator[dict[str, Any]]:
    """Draw each step with a number of samples a pixel, and measure its error.

    Yields
    ------
    dict
        ``step``, its name, and the measures of ``measure``.
    """
    for rung in rungs:
        picture = render_samples(
            samples, cloud, view, radii, lighting, rung.steps, background=background
        )
        yield {"step": rung.name, **measure(picture, exact, background)}


def measure(
    picture: Picture, exact: Reference, background: tuple[float, float, float]
) -> dict[str, float | None]:
    """Measure the error of a point-sampled picture.

    Returns
    -------
    dict
        The measures of ``metrics.compare``, and ``psnr_blurred_db``.
    """
    low, high = picture.depth_range
    found = metrics.compare(
        cast(Raster, _AsRaster(picture)),
        exact,
        background=background,
        depth_range=(low, high) if high > low else None,
    )
    return {**found, "psnr_blurred_db": blurred_psnr(picture.rgb, exact.rgb)}


def blurred_psnr(rgb: npt.NDArray[np.float64], exact: npt.NDArray[np.float64]) -> float | None:
    """Return the PSNR in dB of the blurred error, or None if there is no error.

    The error is blurred by a Gaussian of ``BLUR`` pixels. This attenuates noise from pixel to
    pixel, while a wrong colour over an area counts in full.

    Parameters
    ----------
    rgb, exact
        Shape (height, width, 3), float64, 0..1.
    """
    from scipy.ndimage import gaussian_filter

    error = float(np.mean(gaussian_filter(rgb - exact, (BLUR, BLUR, 0.0)) ** 2))
    return -10.0 * math.log10(error) if error > 0.0 else None


class _AsRaster:
    """Adapter that gives a picture a raster's interface; depth is a share of the depth range."""

    def __init__(self, picture: Picture) -> None:
        low, high = picture.depth_range
        self.depth = (picture.depth - low) / (high - low if high > low else 1.0)
        self.drawn = picture.drawn
        self.config = _Unit
        self._rgb = picture.rgb

    def to_rgb(self, background: tuple[float, float, float]) -> npt.NDArray[np.float64]:
        """Return the picture, which was drawn with the same background."""
        return self._rgb


class _Unit:
    """Configuration whose largest drawn depth is 1."""

    background_depth = 2
