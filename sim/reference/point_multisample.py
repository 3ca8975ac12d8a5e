"""Point-sampled pictures with several samples a pixel: the mean of shifted ones."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud
from splatline.host.sample_positions import SAMPLES
from splatline.host.shading.lighting import Lighting
from splatline.host.visibility.view import View

from .point_sampled import Picture, Steps, render

__all__ = ["render_samples"]


def render_samples(
    samples: int,
    cloud: Cloud,
    view: View,
    radii: npt.ArrayLike,
    lighting: Lighting,
    steps: Steps,
    **options: Any,
) -> Picture:
    """Draw a cloud of discs with several samples a pixel, at the host's positions.

    Every sample has the depth range of the first. The mean picture shows a point where at least
    half of a pixel's samples do: that of the first such sample, at the mean depth.

    Parameters
    ----------
    samples
        One of ``host.sample_positions.SAMPLES``.
    cloud, view, radii, lighting, steps, options
        As for :func:`splatline.sim.reference.point_sampled.render`.
    """
    pictures: list[Picture] = []
    for right, down in SAMPLES[samples]:
        shift = view.shift[0] - right / 16.0, view.shift[1] - down / 16.0
        there = dataclasses.replace(view, shift=shift)
        pictures.append(render(cloud, there, radii, lighting, steps, **options))
        options.setdefault("depth_range", pictures[0].depth_range)
    if samples == 1:
        return pictures[0]
    drawn = np.array([picture.drawn for picture in pictures])
    shown = drawn.mean(axis=0) >= 0.5
    total = np.zeros(shown.shape)
    for picture in pictures:
        total += np.where(picture.drawn, picture.depth, 0.0)
    depth = np.where(shown, total / np.maximum(drawn.sum(axis=0), 1), np.nan)
    first = np.argmax(drawn, axis=0)[np.newaxis]
    seen = np.take_along_axis(np.array([picture.seen for picture in pictures]), first, axis=0)[0]
    return Picture(
        rgb=np.mean([picture.rgb for picture in pictures], axis=0),
        depth=depth,
        seen=np.where(shown, seen, -1),
        depth_range=pictures[0].depth_range,
    )
