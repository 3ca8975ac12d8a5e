"""Encoding for an engine with planes: from splats on the image to plane words."""

from __future__ import annotations

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.host.visibility.occlusion import cover_planes, new_pyramid
from splatline.host.visibility.splats import Splats

from .plane_loop import encode_plane_splats
from .plane_words import layout_of
from .splat_loop import Fixed, Occluders, Slots, measure_room
from .tile import Target, Tile
from .waves import waves_of

__all__ = ["encode_planes"]


def encode_planes(
    splats: Splats,
    fixed: Fixed,
    size: tuple[int, int],
    tile: Tile,
    config: EngineConfig,
    skip_hidden: bool,
    marks: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, Slots]:
    """Return the plane words of splats: words, lines and slots.

    A splat of up to 8 x 8 pixels is one word: a fraction if it has at most four lines, else a
    symmetric word with moved ends. A larger one is fractions, each with the disc's plane.

    Parameters
    ----------
    splats, tile, config, skip_hidden
        See :func:`splatline.host.encode.encode.encode`.
    fixed
        What all splats share, with the quality ``exact``.
    size
        Width and height of the whole image.
    marks
        See :class:`splatline.host.encode.splat_loop.Slots`.

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
    measure_room(source, fixed, size, tile.size, room)
    starts = np.concatenate([[0], np.cumsum(room)])
    words = np.empty((starts[-1], 2), np.uint64)
    lines = np.empty(starts[-1], np.int16)
    slots = Slots.of(starts[:-1], tile, marks)
    positions = config.x.lsb, config.z.lsb, config.background_depth - 1
    to = Target(words.view(np.int64), lines, *size, *tile[:4], *positions)
    pyramid = new_pyramid(*(tile.size if skip_hidden else (1, 1)), config)
    occluders = Occluders(skip_hidden, pyramid.bound, pyramid.coarse)
    layout = layout_of(config)
    for wave in waves_of(splats.nearest, skip_hidden):
        encode_plane_splats(wave, source, fixed, layout, to, occluders, slots)
        if skip_hidden:
            cover_planes(pyramid, words, lines, starts[wave], slots.stops[wave], config)
    return words, lines, slots
