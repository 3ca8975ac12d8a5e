"""A picture in tiles of a large cloud: the joined frames of its parts, as those of a cloud."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.host.encode.close_specks import close_specks
from splatline.host.encode.read_stream import read_stream
from splatline.host.encode.stand_ins import number_of
from splatline.host.encode.tile import Tile
from splatline.host.picture_tiles.counts import first_counts
from splatline.host.picture_tiles.frames import TileFrames, words_of_others
from splatline.host.picture_tiles.grid import Grid

from .draw_parts import OVERDRAWN, Drawing, PartFrames
from .plan import Plan

__all__ = [
    "JoinedTiles",
    "add_counts",
    "counts_without_rows",
    "row_counts",
    "tiles_of",
    "tiles_of_row",
]

Shown = TypeVar("Shown")


@dataclass(frozen=True)
class JoinedTiles:
    """A picture in tiles; see :class:`splatline.host.picture_tiles.frames.TiledPicture`."""

    grid: Grid
    config: EngineConfig
    counts: dict[str, Any]
    _tiles: list[list[TileFrames]]

    def map_rows(self, show: Callable[[list[TileFrames]], Shown]) -> Iterator[Shown]:
        """Yield what ``show`` returns of each row of tiles, from the top down."""
        return map(show, self._tiles)


def tiles_of(plan: Plan, drawing: Drawing, joined: PartFrames) -> JoinedTiles:
    """Return the picture of joined parts."""
    grid = Grid.of(plan.view.width, plan.view.height, drawing.config, None)
    length = grid.columns * drawing.samples
    tiles = [
        tiles_of_row(
            grid,
            row,
            joined.frames[row * length : (row + 1) * length],
            close=drawing.close_specks,
        )
        for row in range(grid.rows)
    ]
    counts = counts_without_rows(plan, drawing, joined)
    for row in tiles:
        add_counts(counts, row_counts(row), drawing.config)
    return JoinedTiles(grid, drawing.config, counts, tiles)


def tiles_of_row(
    grid: Grid, number: int, frames: Sequence[Frame | None], *, close: bool
) -> list[TileFrames]:
    """Return the tiles of a row, from left to right.

    Parameters
    ----------
    grid, number
        The tiles, and the row's number.
    frames
        Of each tile and sample; empty if there are none.
    close
        Whether specks are closed.
    """
    tiles = grid.row(number)
    samples = len(frames) // len(tiles)
    found = []
    for at, tile in enumerate(tiles):
        own = list(frames[at * samples : (at + 1) * samples] or [None])
        if close:
            own = [frame and close_specks(frame, tile.own) for frame in own]
        found.append(TileFrames(tile, own))
    return found


def counts_without_rows(plan: Plan, drawing: Drawing, joined: PartFrames) -> dict[str, Any]:
    """Return the statistics of a picture without those of its rows; see :func:`row_counts`."""
    skips = drawing.skips - {OVERDRAWN}
    return {
        **first_counts(
            joined.points, joined.dropped, drawing.quality, skips, close=drawing.close_specks
        ),
        "culled": joined.culled,
        "elements": joined.elements,
        "depth_range": list(plan.depth_range),
    }


def row_counts(tiles: Sequence[TileFrames]) -> dict[str, int]:
    """Return the statistics of a row of tiles."""
    drawn = [tile for tile in tiles if any(frame is not None for frame in tile.frames)]
    made = [(tile.tile, frame) for tile in drawn for frame in tile.frames if frame is not None]
    closed = [frame.counts["specks"] for _, frame in made if "specks" in frame.counts]
    return {
        **({"specks": sum(closed)} if closed else {}),
        "codewords": sum(len(frame.codewords) for _, frame in made),
        "control_words": sum(frame.counts["control_words"] for _, frame in made),
        "words_twice": sum(_twice(tile, frame) for tile, frame in made),
        "tiles": len(drawn),
        "tiles_empty": len(tiles) - len(drawn),
    }


def add_counts(counts: dict[str, Any], row: dict[str, int], config: EngineConfig) -> None:
    """Add the statistics of a row to those of the picture."""
    for name, number in row.items():
        counts[name] += number
    counts["bits_sent"]["table"] += config.codeword_bits * row["codewords"]


def _twice(tile: Tile, frame: Frame) -> int:
    """Return how many words of a tile's frame other tiles have too."""
    words, lines = read_stream(frame.codewords, frame.config)
    if frame.config.plane:
        words = frame.codewords[number_of(words)]
    return words_of_others(words, lines, tile, frame.config)
