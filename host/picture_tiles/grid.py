"""The tiles of a picture: where each lies, and which of them a pixel is in."""

from __future__ import annotations

from typing import NamedTuple

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.host.encode.sort_by_line import PERIOD
from splatline.host.encode.tile import GUARD_COLUMNS, GUARD_LINES, HEM, Tile

__all__ = ["MOST_LINES", "MOST_SIDE", "Grid"]

MOST_LINES = 512
"""Lines of a tile's frame, whatever the engine could draw: what is held of a picture is a row of
tiles."""

MOST_SIDE = 1 << 16
"""Most columns and lines of a picture. Positions are float32, which are exact to 1/256 there."""


class Grid(NamedTuple):
    """The tiles of a picture, row by row.

    Parameters
    ----------
    width, height
        Of the picture, in pixels.
    frame_width, frame_height
        Most columns and lines of a tile's frame, with all that is thrown away.
    """

    width: int
    height: int
    frame_width: int
    frame_height: int

    @classmethod
    def of(
        cls, width: int, height: int, config: EngineConfig, frame_size: tuple[int, int] | None
    ) -> Grid:
        """Return the grid of a picture for an engine.

        Parameters
        ----------
        frame_size
            Most columns and lines of a tile's frame; columns must be a multiple of
            ``sort_by_line.PERIOD``. None: all columns that the engine has, and up to ``MOST_LINES``
            lines.

        Raises
        ------
        InputError
            If the picture is too large, or the engine's image too narrow for a guard band.
        """
        if max(width, height) > MOST_SIDE:
            raise InputError(
                f"the picture is {width}x{height}; its sides have at most {MOST_SIDE} pixels"
            )
        across, down = frame_size or (config.max_width, min(config.max_height, MOST_LINES))
        if across > config.max_width or down > config.max_height:
            raise InputError(f"a tile of {across}x{down} pixels does not fit {config.name}")
        narrow = across % PERIOD or across <= GUARD_COLUMNS
        if (width > across and narrow) or (height > down and down <= GUARD_LINES):
            raise InputError(f"tiles of {across}x{down} pixels have no room for a guard band")
        return cls(width, height, across, down)

    @property
    def step(self) -> tuple[int, int]:
        """Columns and lines from one tile's origin to the next one's."""
        return self.frame_width - GUARD_COLUMNS, self.frame_height - GUARD_LINES

    @property
    def columns(self) -> int:
        """Number of tiles in a row."""
        return _parts(self.width, self.frame_width, GUARD_COLUMNS)

    @property
    def rows(self) -> int:
        """Number of rows of tiles."""
        return _parts(self.height, self.frame_height, GUARD_LINES)

    def row(self, number: int) -> list[Tile]:
        """Return the tiles of a row, from left to right."""
        across, down = self.step
        top = number * down
        bottom = min(top + self.frame_height, self.height)
        below = HEM * (bottom < self.height)
        rights = [
            (left, min(left + self.frame_width, self.width))
            for left in range(0, across * self.columns, across)
        ]
        return [
            Tile(left, top, right, bottom, HEM * (right < self.width), below)
            for left, right in rights
        ]


def _parts(length: int, most: int, guard: int) -> int:
    """Return the fewest tiles that hold some columns or lines; all but the first have a guard."""
    return max(1, -(-(length - guard) // (most - guard)))
