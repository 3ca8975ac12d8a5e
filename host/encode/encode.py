"""Encoding: from splats on the image to code words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.host.shading.normal_levels import level_slopes
from splatline.host.visibility.occlusion import cover, new_pyramid
from splatline.host.visibility.splats import Splats
from splatline.host.visibility.view import View

from .encode_planes import encode_planes
from .quality import DEFAULT_QUALITY, QUALITIES
from .shape_table import shape_table
from .splat_loop import Fixed, Occluders, Shapes, Slots, encode_splats, measure_room
from .tile import Target, Tile, whole_image
from .waves import waves_of

__all__ = ["Encoded", "encode"]

TINY = 1.0 / float(np.finfo(np.float64).max)
"""Largest depth range whose inverse overflows."""


NOTHING = new_pyramid(1, 1, PAPER)
"""A pyramid for calls that look nothing up."""


@dataclass(frozen=True)
class Encoded:
    """Code words in the order of their splats, before sorting, in chunks with gaps between.

    Parameters
    ----------
    words
        Shape (slots,), uint64; of an engine with planes (slots, 2).
    lines
        The engine's line at which each is drawn: shape (slots,), int16.
    starts, stops
        The slots of each chunk: shape (chunks,), int64.
    counts
        Words of each chunk on each line: shape (chunks, lines), int32.
    elements
        Splats that gave at least one word.
    hidden
        Splats left out because they are behind others.
    """

    words: npt.NDArray[np.uint64]
    lines: npt.NDArray[np.int16]
    starts: npt.NDArray[np.int64]
    stops: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int32]
    elements: int
    hidden: int = 0

    def together(self) -> tuple[npt.NDArray[np.uint64], npt.NDArray[np.int16]]:
        """Return words and lines without gaps."""
        parts = [slice(start, stop) for start, stop in zip(self.starts, self.stops, strict=True)]
        words = np.concatenate([self.words[part] for part in parts])
        return words, np.concatenate([self.lines[part] for part in parts])


def encode(
    splats: Splats,
    view: View,
    config: EngineConfig,
    quality: str = DEFAULT_QUALITY,
    *,
    nearest_pixel: bool = False,
    skip_hidden: bool = False,
    compact: bool = False,
    tile: Tile | None = None,
    marks: npt.NDArray[np.uint8] | None = None,
) -> Encoded:
    """Return the code words that draw splats.

    Words without a pixel in the image are left out. The engine clips words at the right and lower
    border. Depths are linear over the range of the splats' centres: the nearest is 0, the furthest
    is the largest depth that draws.

    Parameters
    ----------
    splats
        The splats to draw.
    view
        Size of the image, its focal length, and where the view's axis meets it.
    config
        The engine's configuration.
    quality
        One of ``QUALITIES``; an engine with planes has one way of drawing, whichever is asked for.
    nearest_pixel
        Draw a splat that covers no pixel's centre as the pixel that holds its centre, else leave it
        out. Symmetric shapes always have a pixel.
    skip_hidden
        Leave out splats that are wholly behind others; no pixel changes. Not with compact words,
        whose rows are unknown here.
    compact
        Write the symmetric shapes that the engine's ROM holds as compact words; not in tiles.
    tile
        The part of the image whose words are wanted; columns and lines of the words are those of
        its frame. None: the whole image.
    marks
        Set for each slot of ``splats`` that has a word (1) or is hidden (2): shape (slots,), uint8.
        None: not asked for.
    """
    size = view.width, view.height
    tile = tile or whole_image(*size)
    marks = np.empty(0, np.uint8) if marks is None else marks
    if config.plane:
        fixed = _fixed(splats, view, config, "exact", nearest_pixel)
        return _encoded(*encode_planes(splats, fixed, size, tile, config, skip_hidden, marks))
    fixed = _fixed(splats, view, config, quality, nearest_pixel)
    shapes = Shapes(shape_table(), level_slopes(), config.largest_shape if compact else 0)
    chunks = len(splats.starts)
    room = np.empty(chunks, np.int64)
    source = (*splats.views(), splats.starts, splats.stops)
    measure_room(source, fixed, size, tile.size, room)
    starts = np.concatenate([[0], np.cumsum(room)])
    words = np.empty(starts[-1], np.uint64)
    lines = np.empty(starts[-1], np.int16)
    slots = Slots.of(starts[:-1], tile, marks)
    positions = config.x.lsb, config.z.lsb, config.background_depth - 1
    to = Target(words, lines, *size, *tile[:4], *positions)
    pyramid = new_pyramid(*tile.size, config) if skip_hidden else NOTHING
    occluders = Occluders(skip_hidden, pyramid.bound, pyramid.coarse)
    for wave in waves_of(splats.nearest, skip_hidden):
        encode_splats(wave, source, fixed, shapes, to, occluders, slots)
        if skip_hidden:
            cover(pyramid, words, lines, starts[wave], slots.stops[wave], config)
    return _encoded(words, lines, slots)


def _encoded(words: npt.NDArray[np.uint64], lines: npt.NDArray[np.int16], slots: Slots) -> Encoded:
    """Return the results of the compiled loops."""
    return Encoded(
        words,
        lines,
        slots.starts,
        slots.stops,
        slots.counts,
        int(slots.elements.sum()),
        int(slots.hidden.sum()),
    )


def _fixed(
    splats: Splats,
    view: View,
    config: EngineConfig,
    quality: str,
    nearest_pixel: bool,
) -> Fixed:
    """Return the values that all splats of a frame share; see :func:`encode`."""
    low, high = splats.depth_range
    middle_x, middle_y = view.middle
    return Fixed(
        quality=list(QUALITIES).index(quality),
        inverse_focal=1.0 / view.focal,
        low=low,
        inverse_span=_inverse(high - low),
        nearest_pixel=nearest_pixel,
        look_lsb=config.diffuse.lsb,
        near=view.near,
        middle_x=middle_x,
        middle_y=middle_y,
    )


def _inverse(span: float) -> float:
    """Return the inverse of a depth range, or 0 if it would overflow."""
    return 1.0 / span if span > TINY else 0.0
