"""The indices of an OBJ file, checked before trimesh makes arrays as long as the largest."""

from __future__ import annotations

import re

from splatline.contract.errors import InputError

from .source import Source

__all__ = ["check_obj"]


def check_obj(source: Source) -> None:
    """Raise ``InputError`` if a face has an index with more digits than the file's size has."""
    source.stream.seek(0)
    digits = len(str(source.size)) + 1
    found = re.search(rb"(?m)^[ \t]*f[ \t][^\n]*\d{%d}" % digits, source.stream.read())
    if found is not None:
        raise InputError("has a face of vertices that it lacks; is it damaged?")
