"""Form of a film: its frames, its size, its rate and its length."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterator
from typing import IO, TypeAlias

import numpy as np
import numpy.typing as npt

__all__ = ["Form", "Pixels", "Write"]

Pixels: TypeAlias = npt.NDArray[np.uint8]
"""A frame: shape (height, width, 3), uint8, C-contiguous."""


@dataclasses.dataclass(frozen=True)
class Form:
    """Form of a film.

    Parameters
    ----------
    size
        Width and height in pixels.
    count
        Number of frames.
    fps
        Frames a second.
    fidelity
        Of the encoder: 0 to 100.
    """

    size: tuple[int, int]
    count: int
    fps: float
    fidelity: float

    def durations(self, unit: int) -> list[int]:
        """Return each frame's duration in parts of a second, which add up to the film's length.

        Parameters
        ----------
        unit
            Parts of a second.
        """
        ends = [round(unit * number / self.fps) for number in range(self.count + 1)]
        return [end - begin for begin, end in itertools.pairwise(ends)]


Write: TypeAlias = Callable[[Iterator[Pixels], IO[bytes], Form], None]
"""Writes frames to a stream, as a film of a form."""
