"""Frames of a picture's tiles: one projection for the whole picture, then tile by tile.

The picture that the tiles draw is bit for bit the one that an engine of the picture's size would
draw; see :mod:`splatline.host.encode.tile`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from splatline.contract.config import ROWS, EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Frame, Tables
from splatline.contract.presets import DEFAULT
from splatline.host.cloud.cloud import Cloud
from splatline.host.encode.close_specks import close_specks as closed
from splatline.host.encode.encode import Encoded, encode
from splatline.host.encode.quality import DEFAULT_QUALITY
from splatline.host.encode.sort_by_line import sort_by_line
from splatline.host.encode.splat_loop import DRAWN, HIDDEN
from splatline.host.encode.tile import Tile
from splatline.host.pipeline import check_request, nothing_in_view, sample_views
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.materials import Materials, material_tables
from splatline.host.stages import Stopwatch, indexed, splats_of, useful_skips
from splatline.host.visibility.block_index import Index
from splatline.host.visibility.skips import DEFAULT_SKIPS, check_skips
from splatline.host.visibility.splats import Splats
from splatline.host.visibility.view import View

from .bins import Bin, bins_of_row
from .counts import first_counts
from .grid import Grid

__all__ = ["TileFrames", "TiledPicture", "tile_picture", "words_of_others"]

Shown = TypeVar("Shown")


@dataclass(frozen=True)
class TileFrames:
    """The frames of a tile.

    Parameters
    ----------
    tile
        Where it lies, and its guard band, whose pixels are thrown away.
    frames
        One for each sample of a pixel; None for a sample that draws nothing there.
    """

    tile: Tile
    frames: list[Frame | None]


@dataclass
class _Sample:
    """The splats of a sample.

    Parameters
    ----------
    view, splats, tables
        The view, its splats and the engine's tables.
    marks
        What became of each splat: shape (slots,), uint8. A splat that is drawn in a tile and hidden
        in another one has both marks.
    """

    view: View
    splats: Splats
    tables: Tables
    marks: npt.NDArray[np.uint8]


@dataclass
class TiledPicture:
    """A picture in tiles: the frames are made as they are asked for.

    Parameters
    ----------
    grid
        The tiles.
    config
        The engine.
    counts
        Statistics as those of ``make_frames``. Those of words and elements count what was made so
        far; each point counts once, however many tiles show it. ``tiles`` is the number of tiles
        that were drawn, ``tiles_empty`` that of those that nothing touches, and ``words_twice``
        that of the code words that were sent again, since they reach into another tile.
    """

    grid: Grid
    config: EngineConfig
    counts: dict[str, Any]
    _quality: str
    _useful: frozenset[str]
    _close: bool
    _samples: list[_Sample] = field(repr=False)

    def map_rows(self, show: Callable[[list[TileFrames]], Shown]) -> Iterator[Shown]:
        """Yield what ``show`` returns of each row of tiles, from the top down; once alone."""
        return map(show, self.rows())

    def rows(self) -> Iterator[list[TileFrames]]:
        """Yield the tiles row by row, each from left to right; once alone."""
        for number in range(self.grid.rows):
            bins = [bins_of_row(one.splats, one.view, self.grid, number) for one in self._samples]
            row = []
            for tile, *own in zip(self.grid.row(number), *bins, strict=True):
                frames = [
                    self._frame(sample, bin_)
                    for sample, bin_ in zip(self._samples, own, strict=True)
                ]
                drawn = any(frame is not None for frame in frames)
                self.counts["tiles" if drawn else "tiles_empty"] += 1
                row.append(TileFrames(tile, frames))
            yield row
        self._count_points()

    def _encode(self, sample: _Sample, own: Bin) -> Encoded:
        """Return the words of a tile; mark its splats."""
        marks = np.zeros(len(own.splats.data), np.uint8)
        encoded = encode(
            own.splats,
            sample.view,
            self.config,
            self._quality,
            nearest_pixel="no_pixel" not in self._useful,
            skip_hidden="hidden" in self._useful,
            tile=own.tile,
            marks=marks,
        )
        sample.marks[own.slots] |= marks
        return encoded

    def _frame(self, sample: _Sample, own: Bin) -> Frame | None:
        """Return a sample's frame of a tile, or None if nothing is in it."""
        if not len(own.splats):
            return None
        clock = Stopwatch()
        encoded = self._encode(sample, own)
        clock.lap("encode")
        if not encoded.elements:
            return None
        stream, control_words = sort_by_line(encoded, self.config)
        clock.lap("sort")
        sizes = {"codewords": len(stream), "control_words": control_words}
        frame = Frame(stream, sample.tables, *own.tile.size, self.config, sizes)
        if self._close:
            frame = closed(frame, own.tile.own)
            clock.lap("close")
        counts = self.counts
        for name, number in frame.counts.items():
            counts[name] += number
        counts["words_twice"] += words_of_others(*encoded.together(), own.tile, self.config)
        counts["bits_sent"]["table"] += self.config.codeword_bits * len(frame.codewords)
        for stage, seconds in clock.laps.items():
            counts["seconds"][stage] = counts["seconds"].get(stage, 0.0) + seconds
        return frame

    def _count_points(self) -> None:
        """Count each point once, when all tiles are made."""
        culled = self.culled()
        self.counts["culled"] = {name: culled[name] for name in self._samples[0].splats.culled}
        self.counts["elements"] = sum(
            int(np.count_nonzero(sample.marks & DRAWN)) for sample in self._samples
        )

    def culled(self) -> Counter[str]:
        """Return the points that were left out, summed over the samples.

        A splat without a mark gave no word in any tile.
        """
        total: Counter[str] = Counter()
        for sample in self._samples:
            total.update(sample.splats.culled)
            hidden = int(np.count_nonzero(sample.marks == HIDDEN))
            drawn = int(np.count_nonzero(sample.marks & DRAWN))
            total["hidden"] += hidden
            total["no_pixel"] += len(sample.splats) - drawn - hidden
        return total

    def project(
        self,
        index: Index,
        view: View,
        samples: int,
        lighting: Lighting,
        depth_range: tuple[float, float] | None,
        cover: float,
        progress: Callable[[float], None],
    ) -> tuple[float, float] | None:
        """Project every sample; return the depth range, or None if nothing is drawn.

        The range is that of the first sample that draws anything, as in ``make_frames``.
        """
        limits, drawn = depth_range, False
        for shifted, rounding in sample_views(view, samples):
            splats = splats_of(
                index, shifted, self._useful, lighting, self.config, self._quality, limits, cover
            )
            tables = material_tables(index.materials, lighting, self.config, rounding)
            sample = _Sample(shifted, splats, tables, np.zeros(len(splats.data), np.uint8))
            self._samples.append(sample)
            progress(len(self._samples) / samples)
            if not drawn and self._draws_something(sample):
                drawn, limits = True, limits or splats.depth_range
        return limits if drawn else None

    def _draws_something(self, sample: _Sample) -> bool:
        """Return whether a sample has any word; stops at the first tile with one."""
        words = (
            len(own.splats) and self._encode(sample, own).elements
            for number in range(self.grid.rows)
            for own in bins_of_row(sample.splats, sample.view, self.grid, number)
        )
        found = any(words)
        sample.marks[:] = 0
        return found


def tile_picture(
    cloud: Cloud | Index,
    view: View,
    samples: int = 1,
    *,
    radii: npt.NDArray[np.floating[Any]] | None = None,
    thin: npt.NDArray[np.bool_] | None = None,
    cover: float = 1.0,
    lighting: Lighting | None = None,
    materials: Materials | None = None,
    config: EngineConfig = DEFAULT,
    quality: str = DEFAULT_QUALITY,
    skips: Iterable[str] = DEFAULT_SKIPS,
    depth_range: tuple[float, float] | None = None,
    shapes: str = "table",
    frame_size: tuple[int, int] | None = None,
    close_specks: bool = False,
    may_be_empty: bool = False,
    progress: Callable[[float], None] = lambda share: None,
) -> TiledPicture:
    """Project, cull and shade a cloud for a picture of any size, which is drawn in tiles.

    Parameters
    ----------
    cloud, view, samples, radii, thin, cover, lighting, materials, config, quality, skips,
    depth_range, close_specks
        As for :func:`splatline.host.pipeline.make_frames`. The view is the whole picture's.
    shapes
        ``table``; compact words have no order that tiles keep.
    frame_size
        See :meth:`splatline.host.picture_tiles.grid.Grid.of`.
    may_be_empty
        Whether a picture that shows nothing is no error, as that of a part of a cloud.
    progress
        Called with the share of the samples that are projected.

    Raises
    ------
    InputError
        As ``make_frames``, except for the picture's size: each side has at most ``MOST_SIDE``
        pixels. If the shapes come from the ROM.
    """
    chosen = check_skips(skips)
    check_request(samples, config, quality, shapes, chosen)
    if shapes != "table":
        raise InputError("shapes from the ROM are not drawn in tiles: take --shapes table")
    grid = Grid.of(view.width, view.height, config, frame_size)
    clock = Stopwatch()
    index = indexed(cloud, radii, thin, materials, config, clock)
    laps = clock.laps
    # A picture of one pixel a point is better than an empty one.
    for kept in dict.fromkeys((chosen, chosen - {"no_pixel"})):
        counts = first_counts(len(index), index.cloud.dropped, quality, kept, close=close_specks)
        useful = useful_skips(kept, quality)
        picture = TiledPicture(grid, config, counts, quality, useful, close_specks, [])
        lights = lighting or Lighting()
        limits = picture.project(index, view, samples, lights, depth_range, cover, progress)
        if limits is not None or may_be_empty:
            clock.lap("project")
            counts["depth_range"], counts["seconds"] = list(limits or (0.0, 0.0)), laps
            return picture
    raise nothing_in_view(index, picture.culled(), samples)


def words_of_others(
    words: npt.NDArray[np.uint64], line: npt.NDArray[Any], tile: Tile, config: EngineConfig
) -> int:
    """Return how many words begin in another tile, which has them too.

    A word begins at its X, four lines above its own line; outside of the image in the next tile.
    """
    lines, columns = tile.own
    low = words[:, 0] if config.plane else words
    x = low >> np.uint64(config.x.lsb) & np.uint64(config.x.mask)
    beside = (x < columns.start) | ((x >= columns.stop) & (tile.hem_right > 0))
    above = (line < lines.start + ROWS) & (lines.start > 0)
    below = (line >= lines.stop + ROWS) & (tile.hem_below > 0)
    return int(np.count_nonzero(beside | above | below))
