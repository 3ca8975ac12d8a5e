"""Encoding for an engine with planes: from splats on the image to plane words."""

from __future__ import annotations

import numpy as np

from splatline.contract.config import ROWS, EngineConfig
from splatline.host.visibility.occlusion import cover_planes, new_pyramid
from splatline.host.visibility.splats import Splats

from .plane_loop import encode_plane_splats
from .plane_words import layout_of
from .splat_loop import Fixed, Occluders, Slots, measure_room

__all__ = ["encode_planes"]


def encode_planes(
    splats: Splats, fixed: Fixed, config: EngineConfig, skip_hidden: bool, waves: int
) -> tuple[np.ndarray, np.ndarray, Slots]:
    """Return the plane words of splats: words, lines and slots.

    A splat of up to 8 x 8 pixels is one word: a fraction if it has at most four lines, else a
    symmetric word with moved ends. A larger one is fractions, each with the disc's plane.

    Parameters
    ----------
    splats, config, skip_hidden
        See :func:`splatline.host.encode.encode.encode`.
    fixed
        What all splats share, with the quality ``exact``.
    waves
        Parts that are encoded one after the other if each may hide the next.

    Returns
    -------
    words
        Shape (slots, 2), uint64.
    lines
        Shape (slots,), int16.
    slots
        See :class:`splatline.host.encode.splat_loop.Slots`.
    """
    chunks = len(splats.starts)
    room = np.empty(chunks, np.int64)
    source = (*splats.views(), splats.starts, splats.stops)
    measure_room(source, fixed, room)
    starts = np.concatenate([[0], np.cumsum(room)])
    words = np.empty((starts[-1], 2), np.uint64)
    lines = np.empty(starts[-1], np.int16)
    slots = Slots(
        starts=starts[:-1],
        stops=np.empty(chunks, np.int64),
        counts=np.zeros((chunks, fixed.height + ROWS), np.int32),
        elements=np.empty(chunks, np.int64),
        hidden=np.zeros(chunks, np.int64),
    )
    to = words.view(np.int64), lines, fixed.width, fixed.height
    size = (fixed.width, fixed.height) if skip_hidden else (1, 1)
    pyramid = new_pyramid(*size, config)
    occluders = Occluders(skip_hidden, pyramid.bound, pyramid.coarse)
    nearest = np.argsort(splats.nearest, kind="stable")
    layout = layout_of(config)
    for wave in np.array_split(nearest, waves) if skip_hidden else [nearest]:
        encode_plane_splats(wave, source, fixed, layout, to, occluders, slots)
        if skip_hidden:
            cover_planes(pyramid, words, lines, starts[wave], slots.stops[wave], config)
    return words, lines, slots
