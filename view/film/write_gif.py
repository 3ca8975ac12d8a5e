"""Animated GIF, by Pillow: one palette, ordered dithering, and only the pixels that change."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import IO, TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from PIL import GifImagePlugin, Image

from splatline.contract.errors import InputError

from .palette import BAYER, SKIPPED, SPREAD, Palette, index_frame

if TYPE_CHECKING:
    from .form import Form, Pixels

__all__ = ["check_gif", "write_gif"]

TICKS = 100
"""Units of a second in which a GIF tells durations."""

FASTEST = 50
"""Frames a second: browsers show a frame of one unit for ten."""

KEEP = 1
"""Disposal: a frame is drawn over the one before."""


def check_gif(form: Form) -> None:
    """Raise ``InputError`` if a film cannot be a GIF."""
    if form.fps > FASTEST:
        raise InputError(f"a GIF has at most {FASTEST} frames a second, not {form.fps:g}")


def write_gif(frames: Iterator[Pixels], stream: IO[bytes], form: Form, palette: Palette) -> None:
    """Write a film that everything shows, in 255 colours.

    Pillow encodes each frame. Its own way to save many frames holds all of them, so the blocks
    between them are written here.

    Parameters
    ----------
    frames, stream, form
        As of ``Write``.
    palette
        The colours of all frames.
    """
    width, height = form.size
    # Of the logical screen: a table of 2^(7 + 1) colours, 8 bits each, background 0, square pixels.
    stream.write(b"GIF89a" + struct.pack("<HHBBB", width, height, 0xF7, 0, 0))
    stream.write(palette.colours.tobytes())
    stream.write(b"\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00")  # again and again
    shown = np.full((height, width), SKIPPED, np.uint8)
    changed = np.empty_like(shown)
    thresholds, background = SPREAD * BAYER, palette.colours[0]
    for pixels, duration in zip(frames, form.durations(TICKS), strict=True):
        index_frame(pixels, palette.nearest, thresholds, background, shown, changed)
        left, top, part = _crop(changed)
        blocks = GifImagePlugin.getdata(
            Image.fromarray(part, "P"),
            (left, top),
            duration=1000 // TICKS * duration,
            disposal=KEEP,
            transparency=SKIPPED,
        )
        stream.writelines(blocks)
    stream.write(b"\x3b")


def _crop(changed: npt.NDArray[np.uint8]) -> tuple[int, int, npt.NDArray[np.uint8]]:
    """Return the left and upper corner of what changes, and that part; at least one pixel."""
    kept = changed != SKIPPED
    lines, columns = np.flatnonzero(kept.any(axis=1)), np.flatnonzero(kept.any(axis=0))
    if not len(lines):
        return 0, 0, changed[:1, :1].copy()
    top, left = int(lines[0]), int(columns[0])
    part = changed[top : int(lines[-1]) + 1, left : int(columns[-1]) + 1]
    return left, top, np.ascontiguousarray(part)
