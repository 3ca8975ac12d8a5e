"""Checks that every stream of code words must pass, whatever the input was."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.config import BLOCK, ROWS
from splatline.contract.frame import Frame
from splatline.host.cloud.cloud import Cloud
from splatline.host.visibility.view import View
from splatline.sim.golden.renderer import block_rows, decode

from .plane_words import decode_planes, depth_at, plane_rows

__all__ = [
    "Fragments",
    "contested",
    "elements_of",
    "faults",
    "fragments",
    "most_words",
    "sorted_elements",
]

_Ints = npt.NDArray[np.int64]


class Fragments(NamedTuple):
    """The pixels of all elements inside the image, one entry a pixel, in stream order.

    ``word`` is the index of the code word.
    """

    word: _Ints
    line: _Ints
    column: _Ints
    depth: _Ints


def elements_of(frame: Frame) -> tuple[npt.NDArray[Any], _Ints, _Ints]:
    """Return the decoded elements of a frame, the line of each, and their indices as code words."""
    fields = _decode(frame)
    step = np.where(fields["control"] & ~fields["end"], fields["x"], 0).astype(np.int64)
    line = np.cumsum(step)
    at = np.flatnonzero(~fields["control"])
    return fields[at], line[at], at


def fragments(frame: Frame) -> Fragments:
    """Return the pixels of a frame's elements, by a plain numpy version of the contract.

    It is slow and needs memory for every pixel. It shares no code with the golden renderer's loops,
    and it keeps all elements that cover a pixel, not only the nearest.
    """
    fields, line, at = elements_of(frame)
    parts = []
    planes = frame.config.plane
    firsts, lasts = plane_rows(fields) if planes else block_rows(fields)
    for row in range(BLOCK):
        first, last = firsts[:, row], lasts[:, row]
        for column in range(BLOCK + 1):  # a block shifted by half a pixel has nine columns
            x = fields["x"].astype(np.int64) + column
            y = line - ROWS + row
            inside = (first <= column) & (column <= last)
            inside &= (x < frame.width) & (y >= 0) & (y < frame.height)
            here = np.flatnonzero(inside)
            depth = (
                depth_at(fields[here], row, column, frame.config) if planes else fields["z"][here]
            )
            parts.append((at[here], y[here], x[here], depth.astype(np.int64)))
    columns = [np.concatenate(group) for group in zip(*parts, strict=True)]
    order = np.argsort(columns[0], kind="stable")
    return Fragments(*(group[order] for group in columns))


def sorted_elements(frame: Frame) -> npt.NDArray[np.uint64]:
    """Return lines and code words of a frame's elements, sorted, so that their order is lost."""
    _, line, at = elements_of(frame)
    words = frame.codewords[at].reshape(len(at), -1).T
    order = np.lexsort([*words, line])
    return np.stack([line[order].astype(np.uint64), *words[:, order]])


def _decode(frame: Frame) -> npt.NDArray[Any]:
    """Return the fields of a frame's code words, with planes or without."""
    config = frame.config
    return (decode_planes if config.plane else decode)(frame.codewords, config)


def contested(frame: Frame) -> npt.NDArray[np.bool_]:
    """Return which pixels have their nearest depth from several elements: shape (height, width).

    Only at these pixels does the picture depend on the order of the elements.
    """
    part = fragments(frame)
    pixel = part.line * frame.width + part.column
    nearest = np.full(frame.width * frame.height, frame.config.background_depth)
    np.minimum.at(nearest, pixel, part.depth)
    ties = np.bincount(pixel[part.depth == nearest[pixel]], minlength=len(nearest))
    return (ties > 1).reshape(frame.height, frame.width)


def most_words(cloud: Cloud, view: View, radii: npt.NDArray[np.float64], quality: str) -> int:
    """Return an upper bound of a cloud's code words, control words included.

    A splat's image lies in a circle of radius R focal / z sqrt(1 + a^2 + b^2), with a and b the
    centre's x / z and y / z; the root is the elongation of a slanted disc towards the border. Two
    pixels more allow for rounding of positions and diameters. The splat takes one code word for
    every four lines and eight columns that the circle and the image share, and one more in each
    direction. In ``exact`` a code word covers half as many lines or columns.
    """
    centres = (cloud.positions - view.eye) @ view.axes.T
    centres = np.ascontiguousarray(centres)
    front = centres[:, 2] >= 0.5 * view.near
    z = centres[front, 2]
    # Overflow is harmless: the values are limited to more than any image.
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        away = np.linalg.norm(centres[front], axis=1) / z
        across = np.minimum(2.0 * radii[front] * view.focal / z * away, 1e6) + 4.0
    across = np.where(np.isnan(across), 1e6, across)

    def words(lines: int, columns: int) -> npt.NDArray[np.float64]:
        down = np.minimum(np.ceil(across / lines) + 2, view.height // lines + 3)
        return down * np.minimum(np.ceil(across / columns) + 2, view.width // columns + 3)

    most = words(ROWS, BLOCK)
    if quality == "exact":
        most = np.maximum(words(ROWS // 2, BLOCK), words(ROWS, BLOCK // 2))
    control = view.height + 2 * BLOCK + 1
    return int(most.sum()) + control


def faults(
    frame: Frame, cloud: Cloud, view: View, radii: npt.NDArray[np.float64], quality: str
) -> list[str]:
    """Return the faults of a frame, one line each; an empty list if the frame is sound."""
    config = frame.config
    found = []
    whole = _decode(frame)
    if whole["end"].sum() != 1 or not whole["end"][-1]:
        found.append("the stream has no end word at its end, or more than one")
    fields, line, at = elements_of(frame)
    if not config.plane and (fields["z"] >= config.background_depth).any():
        found.append("an element lies at the background's depth, where it draws nothing")
    idle = ~np.isin(at, fragments(frame).word)
    if (idle & (fields["mode"] == 1)).any():
        found.append("a fraction draws nothing inside the image")
    # A symmetric word may draw nothing although its block overlaps the image: the shape may leave
    # that corner of the block empty.
    outside = (fields["x"] >= frame.width) | (line - ROWS >= frame.height)
    if (idle & outside).any():
        found.append("a word's block lies outside the image")
    limit = most_words(cloud, view, radii, quality)
    if len(frame.codewords) > limit:
        found.append(f"{len(frame.codewords)} words, at most {limit} are needed")
    counts = frame.counts
    if counts["elements"] + sum(counts["culled"].values()) != len(cloud):
        found.append("points are neither drawn nor counted as left out")
    low, high = counts["depth_range"]
    if not (np.isfinite([low, high]).all() and 0.0 < low <= high):
        found.append(f"the depth range is {low:g}..{high:g}")
    return found
