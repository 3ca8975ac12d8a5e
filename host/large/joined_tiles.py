"""A picture in tiles of a large cloud: the joined frames of its parts, as those of a cloud."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.host.encode.read_stream import read_stream
from splatline.host.encode.stand_ins import number_of
from splatline.host.encode.tile import Tile
from splatline.host.picture_tiles.frames import TileFrames, words_of_others
from splatline.host.picture_tiles.grid import Grid

from .draw_parts import OVERDRAWN, Drawing, PartFrames
from .plan import Plan

__all__ = ["JoinedTiles", "tiles_of"]


@dataclass(frozen=True)
class JoinedTiles:
    """A picture in tiles; see :class:`splatline.host.picture_tiles.frames.TiledPicture`."""

    grid: Grid
    config: EngineConfig
    counts: dict[str, Any]
    _tiles: list[list[TileFrames]]

    def rows(self) -> Iterator[list[TileFrames]]:
        """Yield the tiles row by row, each from left to right."""
        yield from self._tiles


def tiles_of(plan: Plan, drawing: Drawing, joined: PartFrames) -> JoinedTiles:
    """Return the picture of joined parts."""
    grid = Grid.of(plan.view.width, plan.view.height, drawing.config, None)
    frames = iter(joined.frames)
    tiles = [
        [TileFrames(tile, [next(frames) for _ in range(drawing.samples)]) for tile in grid.row(row)]
        for row in range(grid.rows)
    ]
    drawn = [tile for row in tiles for tile in row if any(map(_exists, tile.frames))]
    made = [(tile.tile, frame) for tile in drawn for frame in tile.frames if frame is not None]
    counts = {
        "points": joined.points,
        "dropped": joined.dropped,
        "culled": joined.culled,
        "elements": joined.elements,
        "quality": drawing.quality,
        "skips": sorted(drawing.skips - {OVERDRAWN}),
        "shapes": "table",
        "bits_sent": {
            "table": drawing.config.codeword_bits * sum(len(frame.codewords) for _, frame in made)
        },
        "codewords": sum(len(frame.codewords) for _, frame in made),
        "control_words": sum(frame.counts["control_words"] for _, frame in made),
        "words_twice": sum(_twice(tile, frame) for tile, frame in made),
        "tiles": len(drawn),
        "tiles_empty": grid.rows * grid.columns - len(drawn),
        "depth_range": list(plan.depth_range),
        "seconds": {},
    }
    return JoinedTiles(grid, drawing.config, counts, tiles)


def _exists(frame: Frame | None) -> bool:
    """Return whether a sample draws anything in a tile."""
    return frame is not None


def _twice(tile: Tile, frame: Frame) -> int:
    """Return how many words of a tile's frame other tiles have too."""
    words, lines = read_stream(frame.codewords, frame.config)
    if frame.config.plane:
        words = frame.codewords[number_of(words)]
    return words_of_others(words, lines, tile, frame.config)
