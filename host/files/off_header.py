"""The counts of an OFF file, and whether it has as many lines."""

from __future__ import annotations

import re
from collections.abc import Iterator

from splatline.contract.errors import InputError

from .numbers import lines_of
from .source import Source

__all__ = ["check_off"]

_FIRST = re.compile(r"(ST)?C?N?4?OFF\b(?P<rest>.*)", re.IGNORECASE | re.DOTALL)


def check_off(source: Source) -> None:
    """Raise ``InputError`` if a file is no OFF, or has less than its counts say."""
    lines = _content(source)
    first = _FIRST.match(next(lines, ""))
    if first is None:
        raise InputError("cannot be read as OFF: it does not begin with OFF")
    counts = first["rest"].split() or next(lines, "").split()
    if len(counts) < 2 or not all(count.isdecimal() for count in counts[:2]):
        raise InputError("cannot be read as OFF: it does not count its vertices and faces")
    vertices, faces = map(int, counts[:2])
    wanted = vertices + faces
    found, last = 0, ""
    for found, last in zip(range(1, wanted + 1), lines, strict=False):
        # A corner takes a digit and a blank.
        if found > vertices and found < wanted and 2 * _number(last.split(None, 1)) > len(last):
            raise InputError("has a face of more corners than its line holds; is it damaged?")
    corners = last.split()
    is_cut = bool(faces) and not len(corners) - _number(corners) > 0
    if found < wanted or is_cut:
        raise InputError(
            f"ends after {found:,} of its {wanted:,} vertices and faces;"
            " is it damaged, or truncated?"
        )


def _number(words: list[str]) -> int:
    """Return the number of corners that a face promises."""
    return int(words[0]) if words and words[0].isdecimal() else 0


def _content(source: Source) -> Iterator[str]:
    """Yield the lines that are neither empty nor comments."""
    for line in lines_of(source, 0):
        if text := line.split("#", 1)[0].strip():
            yield text
