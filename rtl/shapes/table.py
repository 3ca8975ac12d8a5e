"""The shapes of all sizes and normals, in integers, for the shape ROM.

A level of n' is a ratio of two small integers, so the test of a pixel against an ellipse is exact.
The host's table has the same definition in floats. A test compares the two.
"""

from __future__ import annotations

import functools

import numpy as np

from splatline.contract.config import BLOCK, ROWS

__all__ = ["EMPTY", "FOLDED", "LEVELS", "SIZES", "folded_shapes"]

LEVELS = 64
"""Levels of n'x and of n'y."""

FOLDED = LEVELS // 2
"""Levels without their sign: level 63 - l is the opposite of level l."""

SIZES = 2 * BLOCK + 1
"""Diameters: 0..16 pixels."""

EMPTY = sum(1 << 6 * row for row in range(ROWS))
"""SCANS of four empty rows: first 1, last 0."""


@functools.cache
def folded_shapes() -> np.ndarray:
    """Return the SCANS of every size and positive n': shape (17, 32, 32, 4), int64, read-only.

    Indices: diameter in pixels; n'x and n'y, each (2 k + 1) / (63 - 2 k) for k = 0..31; fraction.
    Sizes up to 8 have fraction 0 alone: the upper rows of a block. Larger ones have the upper eight
    rows of a block of sixteen: fractions 0 and 1 the left and right half of rows 0..3, 2 and 3 of
    rows 4..7. A fraction without pixels is ``EMPTY``.

    An n'x of the other sign mirrors the shape left to right, and so does an n'y.
    """
    shapes = np.stack([_shapes_of(size) for size in range(SIZES)])
    shapes.setflags(write=False)
    return shapes


def _shapes_of(size: int) -> np.ndarray:
    """Return the SCANS of one size: shape (32, 32, 4).

    With dx = p / 2, dy = q / 2 and slopes a / b and c / d the pixel is inside where
    ((p^2 + q^2) (b d)^2 + (a d p + c b q)^2) / (2 b d)^2 <= (size / 2)^2.
    """
    half = BLOCK // 2 if size <= BLOCK else BLOCK
    odd = 2 * np.arange(FOLDED) + 1
    a, b = odd[:, None, None, None], 64 - odd[:, None, None, None]
    c, d = odd[:, None, None], 64 - odd[:, None, None]
    p = (2 * np.arange(2 * half) + 1 - 2 * half)[None, :]
    q = (2 * np.arange(half) + 1 - 2 * half)[:, None]
    metric = (p * p + q * q) * (b * d) ** 2 + (a * d * p + c * b * q) ** 2
    inside = metric <= (size * b * d) ** 2
    # An ellipse without a pixel's centre inside gets the nearest pixel of the row above its own.
    thin = ~inside.any(axis=(2, 3))
    nearest = metric[:, :, -1].argmin(axis=2)
    inside[..., -1, :] |= thin[..., None] & (np.arange(2 * half) == nearest[..., None])

    scans = np.full((FOLDED, FOLDED, 4), EMPTY)
    for row in range(half):
        for part in range(2 * half // BLOCK):
            columns = inside[..., row, part * BLOCK : (part + 1) * BLOCK]
            first = columns.argmax(axis=2)
            last = BLOCK - 1 - columns[..., ::-1].argmax(axis=2)
            fraction, shift = 2 * (row // ROWS) + part, 6 * (row % ROWS)
            span = np.where(columns.any(axis=2), first | last << 3, 1)
            scans[..., fraction] += (span - 1) << shift  # of the 1 that stands there
    return scans
