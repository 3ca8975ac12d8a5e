"""Draws a picture in tiles on the workers of a Dask cluster: a task draws a row of tiles.

Each part of the cloud is read by one worker, which encodes its frames of all tiles. Further tasks
take the frames of one row of tiles from each part, join them, and draw the row. So what comes back
is what the caller makes of a row, such as packed pixels.
"""

from __future__ import annotations

import dataclasses
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple, TypeVar

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.host.picture_tiles.frames import TileFrames
from splatline.host.picture_tiles.grid import Grid

from .cluster import Traffic, bytes_of, draw_on_worker, hand_out, lost_workers, wait_for
from .draw_parts import Drawing, PartFrames, Progress, check_shown, join_frames_of, join_parts
from .joined_tiles import add_counts, counts_without_rows, row_counts, tiles_of_row
from .plan import Plan

__all__ = ["ClusterTiles", "draw_tiles_on_cluster"]

AHEAD = 2
"""Rows for each thread of a worker that are drawn, or wait to be taken."""

JOINED = 8
"""Parts whose rows one task joins."""

Shown = TypeVar("Shown")


class _Row(NamedTuple):
    """Frames of a row of tiles.

    Parameters
    ----------
    frames
        Of each tile and sample; empty if there are none.
    tasks, bytes
        Tasks that made them, and the code words that these returned, in bytes.
    """

    frames: tuple[Frame | None, ...]
    tasks: int
    bytes: int


@dataclasses.dataclass
class ClusterTiles:
    """A picture in tiles; see :class:`splatline.host.picture_tiles.frames.TiledPicture`.

    Parameters
    ----------
    grid, config, counts
        As there.
    parts
        What was read and drawn of all parts, without frames.
    traffic
        Of the tasks so far.
    """

    grid: Grid
    config: EngineConfig
    counts: dict[str, Any]
    parts: PartFrames
    traffic: Traffic
    _close: bool
    _rows: list[Any]
    _client: Any
    _shared: list[Any]  # without it what is lost could not be done again

    def map_rows(self, show: Callable[[list[TileFrames]], Shown]) -> Iterator[Shown]:
        """Yield what ``show`` returns of each row of tiles, from the top down; once alone.

        ``show`` is called on the workers. Only ``AHEAD`` rows for each thread are under way, so
        that those which wait fit the memory.

        Raises
        ------
        InputError
            If workers are lost again and again.
        """
        (shared,) = hand_out(self._client, show)
        most = AHEAD * sum(self._client.nthreads().values())
        waiting: deque[Any] = deque()
        numbers = iter(range(self.grid.rows))
        with lost_workers():
            for _ in self._rows:
                while len(waiting) < most and (number := next(numbers, None)) is not None:
                    what = (shared, self._rows[number], self.grid, number, self._close)
                    waiting.append(self._client.submit(_show, *what, pure=False))
                shown, counts, traffic = waiting.popleft().result()
                add_counts(self.counts, counts, self.config)
                self.traffic = Traffic(
                    self.traffic.tasks + traffic.tasks, self.traffic.bytes + traffic.bytes
                )
                yield shown


def draw_tiles_on_cluster(
    plan: Plan, drawing: Drawing, client: Any, *, progress: Progress | None = None
) -> ClusterTiles:
    """Read and encode all parts on a cluster's workers; the rows are drawn as they are asked for.

    See :func:`splatline.host.large.cluster.draw_on_cluster`. ``progress`` tells of the parts alone.
    """
    grid = Grid.of(plan.view.width, plan.view.height, drawing.config, None)
    shared = hand_out(client, plan, drawing)
    parts = [client.submit(draw_on_worker, *shared, part, pure=False) for part in plan.parts]
    length = grid.columns * drawing.samples
    rows = [_submit_row(client, parts, number, length) for number in range(grid.rows)]
    told = [client.submit(_without_frames, part, pure=False) for part in parts]
    wait_for(told, progress)
    with lost_workers():
        whole = join_parts(client.gather(told))
    check_shown(plan, drawing, whole)
    counts = counts_without_rows(plan, drawing, whole)
    return ClusterTiles(
        grid,
        drawing.config,
        counts,
        whole,
        Traffic(len(parts), 0),
        drawing.close_specks,
        rows,
        client,
        shared,
    )


def _submit_row(client: Any, parts: Sequence[Any], number: int, length: int) -> Any:
    """Submit the tasks that join a row of tiles; return the last one's future."""
    futures = [client.submit(_cut, part, number, length, pure=False) for part in parts]
    while len(futures) > 1:
        groups = [futures[first : first + JOINED] for first in range(0, len(futures), JOINED)]
        futures = [client.submit(_join, group, pure=False) for group in groups]
    return futures[0]


def _cut(part: PartFrames, number: int, length: int) -> _Row:
    """Return a part's frames of a row of tiles, on its worker."""
    frames = part.frames[number * length : (number + 1) * length]
    return _Row(frames, 1, bytes_of(frames))


def _join(rows: Sequence[_Row]) -> _Row:
    """Join several parts' frames of a row, on a worker."""
    frames = join_frames_of([row.frames for row in rows])
    tasks = 1 + sum(row.tasks for row in rows)
    return _Row(frames, tasks, bytes_of(frames) + sum(row.bytes for row in rows))


def _show(
    show: Callable[[list[TileFrames]], Shown], row: _Row, grid: Grid, number: int, close: bool
) -> tuple[Shown, dict[str, int], Traffic]:
    """Draw a row of tiles, on a worker."""
    tiles = tiles_of_row(grid, number, row.frames, close=close)
    return show(tiles), row_counts(tiles), Traffic(row.tasks + 1, row.bytes)


def _without_frames(part: PartFrames) -> PartFrames:
    """Return what is told of a part, on its worker."""
    return dataclasses.replace(part, frames=())
