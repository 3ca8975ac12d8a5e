"""How few cycles the code words of a frame can take, by how the window's memory is laid out.

A memory word holds four neighbouring pixels; a bank reads one word and writes one word a cycle. No
order of work draws an element in fewer cycles than its busiest bank has words of it.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..host.frame import Frame
from ..rtl.format import BLOCK, ROWS
from .golden import decode

__all__ = ["LAYOUTS", "least_cycles"]

LAYOUTS = {
    "whole columns": "bank = line mod 8; all lines take the same column of words at a time",
    "lines apart": "bank = line mod 8; each line takes the words that its row touches",
    "interleaved": "bank = (line + 4 (word mod 2)) mod 8, as the engine has it",
}
"""The layouts compared, all with the same sixteen block RAMs."""


def least_cycles(frame: Frame) -> dict[str, float]:
    """Return the mean least cycles of an element, for each of ``LAYOUTS``.

    Clipping is left out: a word that lies outside the image counts as one inside.
    """
    touched = _touched_words(frame)
    columns = touched.any(axis=1).sum(axis=1)
    rows = touched.sum(axis=2).max(axis=1)
    upper, lower = touched[:, :ROWS], touched[:, ROWS:]
    # Of three neighbouring words a bank holds the outer two of one line and the middle one of the
    # line four above or below.
    outer_upper = upper[..., 0] + upper[..., 2] + lower[..., 1]
    outer_lower = lower[..., 0] + lower[..., 2] + upper[..., 1]
    banks = np.maximum(outer_upper, outer_lower).max(axis=1)
    cycles = dict(zip(LAYOUTS, (columns, rows, banks), strict=True))
    return {name: float(np.maximum(taken, 1).mean()) for name, taken in cycles.items()}


def _touched_words(frame: Frame) -> npt.NDArray[np.int64]:
    """Return which of three neighbouring words each row touches: shape (elements, 8, 3), 0 or 1."""
    fields = decode(frame.codewords, frame.config)
    fields = fields[~fields["control"]]
    first, last = fields["first"], fields["last"]
    symmetric = (fields["mode"] == 0)[:, np.newaxis]
    # The lower rows are the upper ones turned, or empty.
    first = np.concatenate([first, np.where(symmetric, BLOCK - 1 - last[:, ::-1], 1)], axis=1)
    last = np.concatenate(
        [last, np.where(symmetric, BLOCK - 1 - fields["first"][:, ::-1], 0)], axis=1
    )
    offset = (fields["x"] % frame.config.pixels_per_word)[:, np.newaxis]
    begin, end = (first + offset) // 4, (last + offset) // 4
    word = np.arange(3)
    inside = (begin[..., np.newaxis] <= word) & (word <= end[..., np.newaxis])
    return (inside & (first <= last)[..., np.newaxis]).astype(np.int64)
