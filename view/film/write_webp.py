"""Animated WebP, by Pillow."""

from __future__ import annotations

from collections.abc import Iterator
from typing import IO, TYPE_CHECKING

from PIL import Image

if TYPE_CHECKING:
    from .form import Form, Pixels

__all__ = ["write_webp"]

LOSSLESS = 100
"""Fidelity from which on nothing is lost."""


def write_webp(frames: Iterator[Pixels], stream: IO[bytes], form: Form) -> None:
    """Write a film that browsers show as a picture; with fidelity 100 its pixels are the frames'.

    Parameters
    ----------
    frames, stream, form
        As of ``Write``.
    """
    lossless = form.fidelity >= LOSSLESS
    _Reel(frames, form.count).save(
        stream,
        "WEBP",
        save_all=True,
        duration=form.durations(1000),
        loop=0,
        lossless=lossless,
        quality=form.fidelity,
        # Without loss the fidelity is the effort: of little use, and slow.
        method=3 if lossless else 4,
    )


class _Reel(Image.Image):
    """An image of many frames, each of which is drawn when Pillow asks for it.

    So Pillow holds one frame at a time, where a list of images would hold all.
    """

    def __init__(self, frames: Iterator[Pixels], count: int) -> None:
        super().__init__()
        self.n_frames = count
        self._frames = frames
        self._number = -1
        self.seek(0)

    def seek(self, frame: int) -> None:
        """Go to the next frame; frames before it are gone."""
        if frame == self._number + 1:
            shown = Image.fromarray(next(self._frames))
            self.im, self._mode, self._size = shown.im, shown.mode, shown.size
            self._number = frame

    def tell(self) -> int:
        """Return the number of the frame."""
        return self._number
