"""A look over the points of the visible blocks, which tells those that the exact tests need.

First the groups that may cover a pixel's centre are listed, then their points are tested. So the
memory of a group is asked for some groups before.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.cloud.prefetch import AHEAD, prefetch
from splatline.host.compiled_cache import cached_njit

from .block_index import BLOCK_POINTS
from .cull import ROUNDING, from_eye
from .groups import GROUP_BYTES, GROUP_POINTS, groups_are_small, seen_groups
from .quick_test import MARGIN, NEARBY, VECTORS, test_points
from .skips import REASONS

__all__ = ["Blocks", "Points", "look_over", "middle_of"]

GROUPS = BLOCK_POINTS // GROUP_POINTS
"""Groups of a block."""

LINE = 64
"""Bytes of a line of the cache."""

NO_PIXEL, FACING_AWAY = REASONS["no_pixel"], REASONS["facing_away"]


class Points(NamedTuple):
    """The points of an index, as the quick test reads them; see ``Index``."""

    total: int
    discs: npt.NDArray[np.float32]
    groups: npt.NDArray[np.float32]


class Blocks(NamedTuple):
    """The blocks of an index.

    Parameters
    ----------
    bounds
        Bounds of every block; see ``BOUND``.
    visible
        Numbers of the blocks that were not culled.
    cuts
        Where each chunk begins in ``visible``, and the end: shape (CHUNKS + 1,).
    turns
        The chunks in the order in which they are done; see ``deal``.
    kept
        The points that the quick test does not leave out. Those of a chunk begin at
        ``BLOCK_POINTS * cuts[chunk]``; their number is that of the reason 0.
    """

    bounds: npt.NDArray[Any]
    visible: npt.NDArray[np.int64]
    cuts: npt.NDArray[np.int64]
    turns: npt.NDArray[np.int64]
    kept: npt.NDArray[np.int32]


@cached_njit(parallel=True, error_model="numpy")
def look_over(points: Any, blocks: Any, camera: Any, rules: Any, reasons: Any) -> None:
    """List the points that are kept, and count all by chunk and reason.

    Parameters
    ----------
    points, blocks
        The index; ``blocks.kept`` is set.
    camera
        The view.
    rules
        Whether each reason counts, by its number.
    reasons
        Set: points of each chunk by reason, those that are kept of reason 0.
    """
    count, discs, groups = points
    bounds, visible, cuts, turns, kept = blocks
    for turn in nb.prange(len(turns)):
        chunk = turns[turn]
        begin, stop = cuts[chunk], cuts[chunk + 1]
        seen = np.empty(GROUPS, np.uint8)
        some, found = np.empty((7, BLOCK_POINTS), np.float32), np.empty(BLOCK_POINTS, np.uint8)
        wanted = np.empty(GROUPS * (stop - begin) + AHEAD, np.int32)
        ends = np.empty(stop - begin, np.int64)
        total = 0
        for number in range(begin, stop):
            block = visible[number]
            of_block = -(-min(BLOCK_POINTS, count - BLOCK_POINTS * block) // GROUP_POINTS)
            _test_groups(bounds[block], groups[block], of_block, camera, rules[NO_PIXEL], seen)
            for group in range(of_block):  # without a branch, as none could be foretold
                wanted[total] = GROUPS * block + group
                total += seen[group]
            ends[number - begin] = total
        wanted[total : total + AHEAD] = 0
        at, first = 0, BLOCK_POINTS * begin
        last = first
        for number in range(begin, stop):
            block, before = visible[number], last
            of_block = min(BLOCK_POINTS, count - BLOCK_POINTS * block)
            end, away = ends[number - begin], 0
            if at < end:
                last, away = _test_points(
                    bounds[block], discs, wanted, at, end, count, camera, rules, some, found, kept,
                    last,
                )  # fmt: skip
                at = end
            reasons[chunk, FACING_AWAY] += away
            reasons[chunk, NO_PIXEL] += of_block - (last - before) - away
        reasons[chunk, 0] = last - first


@nb.njit(inline="always")
def middle_of(bound: Any, camera: Any) -> tuple[float, float, float]:
    """Return the middle of a block's bounding sphere in camera coordinates."""
    return from_eye(camera, bound.centre[0], bound.centre[1], bound.centre[2])


@nb.njit(inline="always")
def _is_tested(bound: Any, middle: Any, camera: Any) -> bool:
    """Return whether a block is far enough for float32, and most of its discs are narrow."""
    is_far = middle[2] > max(NEARBY * bound.reach, camera.near + bound.reach)
    return is_far and bound.mean * camera.focal <= 0.5 * middle[2]


@nb.njit(inline="always")
def _axes(camera: Any) -> Any:
    """Return the directions right, down and ahead in float32."""
    return (
        (np.float32(camera.right_x), np.float32(camera.right_y), np.float32(camera.right_z)),
        (np.float32(camera.down_x), np.float32(camera.down_y), np.float32(camera.down_z)),
        (np.float32(camera.ahead_x), np.float32(camera.ahead_y), np.float32(camera.ahead_z)),
    )


@nb.njit(inline="always")
def _margin(camera: Any) -> float:
    """Return the error of a position in pixels."""
    return ROUNDING + MARGIN * (camera.width + camera.height)


@nb.njit(error_model="numpy")
def _test_groups(
    bound: Any, groups: Any, count: int, camera: Any, may_miss: bool, seen: Any
) -> None:
    """Set whether each group of a block may cover a pixel's centre.

    Parameters
    ----------
    bound, groups, count
        The block's bounds, groups and number of groups.
    camera
        The view.
    may_miss
        Whether points are left out that cover no centre.
    seen
        Set: shape (``GROUPS``,), uint8.
    """
    middle = middle_of(bound, camera)
    if may_miss and _is_tested(bound, middle, camera) and groups_are_small(bound, middle, camera):
        seen_groups(bound, groups, count, _axes(camera), middle, camera, _margin(camera), seen)
    else:
        seen[:] = 1


@nb.njit(error_model="numpy")
def _test_points(
    bound: Any,
    discs: Any,
    wanted: Any,
    begin: int,
    end: int,
    count: int,
    camera: Any,
    rules: Any,
    some: Any,
    found: Any,
    kept: Any,
    last: int,
) -> tuple[int, int]:
    """List the points of a block's groups that are kept.

    Parameters
    ----------
    bound
        The block's bounds.
    discs
        See ``Index``.
    wanted, begin, end
        Numbers of groups; from ``begin`` to ``end`` those of the block.
    count
        Points of the cloud.
    camera, rules
        See :func:`look_over`.
    some, found
        Overwritten: the groups' discs, shape (7, ``BLOCK_POINTS``), and the reasons for them.
    kept, last
        The list, and how long it is.

    Returns
    -------
    last, away
        How long it is then, and how many points show their back.
    """
    middle = middle_of(bound, camera)
    if not (rules[NO_PIXEL] and _is_tested(bound, middle, camera)):
        first = GROUP_POINTS * wanted[begin]  # all groups of the block are wanted
        of_block = min(GROUP_POINTS * (end - begin), count - first)
        for i in range(of_block):
            kept[last + i] = first + i
        return last + of_block, 0
    for k in range(begin, end):
        for line in range(0, GROUP_BYTES, LINE):
            prefetch(discs, GROUP_BYTES * wanted[k + AHEAD] + line)
        group, at = wanted[k], GROUP_POINTS * (k - begin)
        for row in range(7):
            for i in range(GROUP_POINTS):
                some[row, at + i] = discs[group, row, i]
    x, y, z = middle
    # In units of the distance, so that nothing over- or underflows in float32.
    test_points(
        some,
        min(-(-GROUP_POINTS * (end - begin) // VECTORS) * VECTORS, BLOCK_POINTS),
        _axes(camera),
        (np.float32(x / z), np.float32(y / z), np.float32(bound.reach / z)),
        (np.float32(camera.focal), np.float32(camera.middle_x), np.float32(camera.middle_y)),
        np.float32(bound.largest * camera.focal / z),
        np.float32(_margin(camera)),
        rules[FACING_AWAY],
        found,
    )
    away = 0
    for k in range(begin, end):
        first, at = GROUP_POINTS * wanted[k], GROUP_POINTS * (k - begin)
        for i in range(min(GROUP_POINTS, count - first)):
            kept[last] = first + i
            last += found[at + i] == 0
            away += found[at + i] == FACING_AWAY
    return last, away
