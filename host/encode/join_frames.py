"""Joins frames of parts of a cloud to one frame of the words that a pixel shows.

The joined frame draws the picture of all words together, bit for bit. A word that shows no pixel
among some words shows none among more, since the order of two words that share a pixel depends on
these two alone (:func:`splatline.host.encode.sort_by_line.sort_by_line`). So frames may be joined
in any order and in any groups, and a joined frame has at most one word for each pixel.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from splatline.contract.errors import InputError
from splatline.contract.frame import Frame

from .owners import as_encoded, elements_of, find_owners
from .sort_by_line import sort_by_line

__all__ = ["join_frames"]


def join_frames(frames: Sequence[Frame]) -> Frame:
    """Return the frame of all elements of some frames, without those that no pixel shows.

    Parameters
    ----------
    frames
        At least one; all have one size, configuration and tables, and no compact words.

    Returns
    -------
    Frame
        Its ``counts`` has ``elements`` and ``codewords``, those of the stream, and
        ``control_words``.

    Raises
    ------
    InputError
        If the frames do not belong together, or one has no end word.
    """
    first = frames[0]
    for frame in frames:
        _check_alike(frame, first)
    config = first.config
    words, lines = elements_of(frames, config)
    stream, _ = sort_by_line(as_encoded(words, lines, first.height), config)
    # Again, in the order in which they are drawn.
    sorted_words, sorted_lines = elements_of([dataclasses.replace(first, codewords=stream)], config)
    _, owner = find_owners(sorted_words, sorted_lines, (first.width, first.height), config)
    shown = np.zeros(len(sorted_words), np.bool_)
    shown[owner[owner >= 0]] = True
    seen = as_encoded(sorted_words[shown], sorted_lines[shown], first.height)
    stream, control_words = sort_by_line(seen, config)
    counts = {
        "elements": int(np.count_nonzero(shown)),
        "codewords": len(stream),
        "control_words": control_words,
    }
    return dataclasses.replace(first, codewords=stream, counts=counts)


def _check_alike(frame: Frame, first: Frame) -> None:
    """Raise ``InputError`` unless two frames are parts of one picture."""
    if (frame.width, frame.height, frame.config) != (first.width, first.height, first.config):
        raise InputError("frames of two sizes or engines cannot be joined")
    for name in ("ambient", "diffuse", "specular"):
        if not np.array_equal(getattr(frame.tables, name), getattr(first.tables, name)):
            raise InputError(f"frames with two tables {name!r} cannot be joined")
