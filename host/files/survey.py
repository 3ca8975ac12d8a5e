"""Contents of a cloud file: its header at once, its values where that is quick or asked for."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from splatline.contract.errors import InputError
from splatline.host.cloud.bulk import bounds, far_points
from splatline.host.cloud.typical_spacing import typical_size

from .assemble import assemble_cloud
from .columns import Columns
from .listing import HEADERS, Listing, taken_for
from .readers import open_cloud_file, parser_errors, read_columns
from .source import PIECE, Source
from .wanted import USUAL, Wanted

__all__ = ["DEPTHS", "survey"]

DEPTHS = ("quick", "header", "full")
"""Extent of the reading: values if the file is small, its header alone, its values anyway."""

SMALL = 1 << 28
"""Bytes of a binary file whose values are read at once, in a second."""

SMALL_PACKED = {".laz": 1 << 24, ".npz": 1 << 26, ".e57": 1 << 26}
SMALL_TEXT = 1 << 24
"""The same of those that must be unpacked, and of a text."""


def survey(
    path: str | os.PathLike[str],
    depth: str = "quick",
    *,
    format: str | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> dict[str, Any]:
    """Return what a cloud file holds, ready for JSON.

    From the header: ``format``, ``points``, ``fields`` (name and type of each column), what they
    are taken for, and what else it says, such as ``coordinate_system``. ``low`` and ``high``, the
    extent, are there if the header has them.

    From the values: each column's ``low`` and ``high``, its values that are ``not_finite``, the
    extent of the points that can be drawn, and ``splat_size``, the usual diameter of a disc: see
    ``typical_size``. What is not known is None.

    Parameters
    ----------
    path
        A file of any format that ``read_cloud`` reads.
    depth
        ``header``: the header alone. ``full``: the values too. ``quick``: the values if the file is
        small enough for about a second.
    format
        A format of ``read_cloud``, whatever the name is.
    progress
        Called now and then with a stage, ``read`` or ``spacing``, and the share that is done.

    Raises
    ------
    InputError
        As ``read_cloud`` does. Damage behind the header shows only if the values are read.
    """
    if depth not in DEPTHS:
        raise InputError(f"the depth must be one of {', '.join(DEPTHS)}, not {depth!r}")
    read = None if progress is None else functools.partial(progress, "read")
    with open_cloud_file(Path(path), Wanted(ranges=True), read, format) as source:
        listing = _listing(source)
        small = listing is None or source.size <= _limit(listing, source.suffix)
        if listing is None or depth == "full" or (depth == "quick" and small):
            columns = _columns(source)
            if progress is not None:
                progress("spacing", 0.0)
            listing = listing or Listing(source.suffix[1:].upper(), None, _types(columns))
            return {**_of_header(listing, columns), **_of_values(columns)}
        if listing.points is None:
            listing = replace(listing, points=_count_lines(source))
    return {
        **_of_header(listing, None),
        "notes": ["only the header was read, so ranges and spacing are not known; see --full"],
    }


def _listing(source: Source) -> Listing | None:
    """Return what the header tells; None if the format has none that is read alone."""
    if source.suffix not in HEADERS:
        return None
    with parser_errors(source):
        listing = HEADERS[source.suffix](source)
    source.stream.seek(0)
    return listing


def _limit(listing: Listing, suffix: str) -> int:
    """Return the bytes up to which a file of a format is small."""
    is_text = "text" in listing.form or "ascii" in listing.form
    return SMALL_TEXT if is_text else SMALL_PACKED.get(suffix, SMALL)


def _columns(source: Source) -> Columns:
    """Return the columns with the ranges of all that hold numbers throughout."""
    try:
        return read_columns(source)
    except InputError:
        # A column that is not used may hold words further down; or the file is damaged.
        source.stream.seek(0)
        return read_columns(replace(source, wanted=USUAL))


def _count_lines(source: Source) -> int:
    """Return the lines of a text: comments and titles count too."""
    source.stream.seek(0)
    lines, last = 0, b"\n"
    while piece := source.stream.read(PIECE):
        lines += piece.count(b"\n")
        last = piece[-1:]
        source.tell()
    return lines + (last != b"\n")


def _types(columns: Columns) -> dict[str, str]:
    """Return the columns that a reader named; their types are not known."""
    return dict.fromkeys([*columns.used, *columns.ignored], "")


def _of_header(listing: Listing, columns: Columns | None) -> dict[str, Any]:
    """Return the facts of the header, with what the columns are taken for and their ranges."""
    used, ignored = taken_for(listing) if columns is None else (columns.used, columns.ignored)
    ranges = {} if columns is None else columns.ranges
    fields = []
    for name, kind in listing.types.items():
        low, high, missing = ranges.get(name, (None, None, None))
        fields.append(
            {
                "name": name,
                "type": kind or None,
                "low": low,
                "high": high,
                "not_finite": missing,
                "used_as": used.get(name),
            }
        )
    extent = listing.extent
    facts = {**listing.facts, **({} if columns is None else columns.facts)}
    return {
        "format": listing.form,
        "points": listing.points,
        **{name.replace(" ", "_"): fact for name, fact in facts.items()},
        "low": None if extent is None else list(extent[0]),
        "high": None if extent is None else list(extent[1]),
        "extent": None if extent is None else np.subtract(extent[1], extent[0]).tolist(),
        "splat_size": None,
        "dropped": None,
        "far_from_the_rest": None,
        "estimated_normals": None,
        "colours": None,
        "columns_used": used,
        "columns_ignored": list(ignored),
        "notes": [],
        "fields": fields,
    }


def _of_values(columns: Columns) -> dict[str, Any]:
    """Return the facts of the points that can be drawn."""
    cloud = assemble_cloud(columns, "", estimate=False)
    low, high = bounds(cloud.positions)
    seen = np.zeros(1 << 24, np.bool_)
    red, green, blue = cloud.colours.astype(np.int32).T
    seen[red << 16 | green << 8 | blue] = True
    return {
        "points": len(cloud),
        "low": (low + cloud.origin).tolist(),
        "high": (high + cloud.origin).tolist(),
        "extent": (high - low).tolist(),
        "splat_size": typical_size(cloud),
        "dropped": cloud.dropped,
        "far_from_the_rest": int(np.count_nonzero(far_points(cloud.positions))),
        "estimated_normals": int(np.count_nonzero(cloud.two_sided)),
        "colours": int(np.count_nonzero(seen)),
        "notes": list(cloud.notes),
    }
