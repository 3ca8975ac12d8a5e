"""Trace of the window of a tiles engine: its position in each cycle of a frame."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.frame import Frame

from .cycles import count_cycles
from .front import halves_of, machine_of
from .tiles import count_tiles

__all__ = ["WindowTrace", "trace_window"]


class WindowTrace(NamedTuple):
    """The window's work in each cycle: three arrays of shape (cycles,), int64.

    Parameters
    ----------
    element
        Index of the code word at the tiler, or of the last one that was there; -1 before the first.
    top
        Lines above it are complete.
    oldest
        First line in the window, at least 0. Lines from it to ``top`` wait to leave.
    """

    element: npt.NDArray[np.int64]
    top: npt.NDArray[np.int64]
    oldest: npt.NDArray[np.int64]


def trace_window(frame: Frame) -> WindowTrace:
    """Return where the window is in each cycle, from the first code word taken to the end beat.

    The window is clear at the start, every port is always ready or valid, and there is no initial
    raster.

    Raises
    ------
    InputError
        If there is no end-of-frame word.
    ValueError
        If the engine has a window of blocks or a shape ROM, whose words are not those of the frame.
    """
    config = frame.config
    if config.draws_blocks or config.shapes != "none":
        raise ValueError("only windows of tiles without a shape ROM are traced")
    words, highs = halves_of(frame.codewords, config)
    trace = np.empty((count_cycles(frame, after_reset=False), 3), np.int64)
    count_tiles(words, highs, machine_of(config, frame.width, frame.height), trace)
    trace[-1] = trace[-2]  # the end beat is on the port
    return WindowTrace(np.maximum.accumulate(trace[:, 0]), trace[:, 1], trace[:, 2])
