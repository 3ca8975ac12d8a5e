"""An engine to draw with, on a board or in a simulation: the same code runs on both."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from splatline.contract.raster import Raster
from splatline.contract.raster_beats import from_beats, to_beats

from .driver import Driver

__all__ = ["Engine"]


class Engine(Driver):
    """Draws frames of code words with the engine in a device.

    >>> with SimulatedDevice() as device:  # or XdmaDevice(): a board
    ...     engine = Engine(device)
    ...     engine.write_tables(frame.tables, frame.width, frame.height)
    ...     raster = engine.draw(frame.codewords)

    Parameters and errors are those of :class:`splatline.host.device.driver.Driver`.
    """

    def draw(self, codewords: npt.NDArray[np.uint64], initial: Raster | None = None) -> Raster:
        """Draw a frame with the tables and the size that were written.

        Parameters
        ----------
        codewords
            Shape (n,), uint64; the last is the end word.
        initial
            The picture to start from; background if not given.

        Raises
        ------
        EngineError
            If the engine found something wrong with the frame; the next is drawn right.
        ValueError
            If what came back is no picture of that size.
        """
        beats = self.draw_beats(codewords, None if initial is None else to_beats(initial))
        width, height = self.get("LAST_COLUMN") + 1, self.get("LAST_LINE") + 1
        return from_beats(beats, width, height, self.config)
