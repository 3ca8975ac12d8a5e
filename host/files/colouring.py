"""Values as colours: along one of matplotlib's colour maps, as greys, or a colour a class."""

from __future__ import annotations

import dataclasses
import difflib
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.host.cloud.cloud import Cloud

from .asprs import class_colours, class_name
from .colours import NEUTRAL, are_known, greys, robust_range
from .wanted import CLASSIFICATION, HEIGHT, INTENSITY, RGB, ColourBy

__all__ = ["DEFAULT_MAP", "Coloured", "check_map", "colour_scene", "colour_values", "heights"]

DEFAULT_MAP = "viridis"
"""Perceptually even, and told apart by those who see few colours."""

EXAMPLES = ("viridis", "cividis", "magma", "turbo", "terrain", "coolwarm", "gray")

MOST_CLASSES = 256
"""Classes that the key lists, the most frequent first."""

_Values = npt.NDArray[Any]


class Coloured(NamedTuple):
    """Colours, shape (n, 3), uint8, and their key: see ``Cloud.colour_key``."""

    colours: npt.NDArray[np.uint8]
    key: dict[str, Any]


def check_map(colour: ColourBy | None) -> None:
    """Raise ``InputError`` if there is no colour map of the name that is asked for."""
    if colour is not None and colour.map is not None:
        _table(colour.map)


def colour_values(
    values: _Values, colour: ColourBy, usual: npt.NDArray[np.bool_] | None = None
) -> Coloured:
    """Return the colours of a value for each point.

    Without a range the map's ends are the least and the greatest of the heights of ``usual``
    points, and of 98 % of other values. Values beyond the ends have the ends' colours. Points
    without a finite value are ``NEUTRAL``. If all values are one, its colour is the map's middle.

    Parameters
    ----------
    values
        Shape (n,), any real type.
    colour
        The field, its map and its range.
    usual
        Which points count for the range of heights: shape (n,).
    """
    values = values.astype(np.float64)
    if colour.kind == CLASSIFICATION:
        return _classes(values)
    known = are_known(values)
    ends = colour.range
    if ends is None and colour.kind == HEIGHT:
        counted = values[known if usual is None else known & usual]
        ends = (float(counted.min()), float(counted.max())) if counted.size else None
    elif ends is None:
        ends = robust_range(values[known])
    grey = colour.kind == INTENSITY and colour.map is None
    key = {
        "by": colour.kind,
        "map": "grey" if grey else colour.map or DEFAULT_MAP,
        "range": None if ends is None else list(ends),
        "without_value": int(np.count_nonzero(~known)),
    }
    if colour.kind == HEIGHT:
        key["up"] = colour.up
    if grey:
        return Coloured(greys(values, ends), key)
    table = _table(colour.map or DEFAULT_MAP)
    colours = np.tile(np.array(NEUTRAL, np.uint8), (len(values), 1))
    if ends is None:
        return Coloured(colours, key)
    low, high = ends
    share = np.full(len(values), 0.5)
    if low < high:
        share[known] = np.clip((values[known] - low) / (high - low), 0.0, 1.0)
    level = np.minimum((share * len(table)).astype(np.int64), len(table) - 1)
    colours[known] = table[level[known]]
    return Coloured(colours, key)


def heights(
    positions: npt.NDArray[np.float64], origin: npt.NDArray[np.float64], up: str
) -> npt.NDArray[np.float64]:
    """Return the coordinate of each point along an axis, in the file's own coordinates.

    Raises
    ------
    InputError
        If the axis is none of x, y and z, with or without a minus.
    """
    if up.removeprefix("-") not in ("x", "y", "z"):
        raise InputError(f"the axis that points up must be x, y, z, -x, -y or -z, not {up!r}")
    axis = "xyz".index(up[-1])
    height: npt.NDArray[np.float64] = positions[:, axis] + origin[axis]
    return -height if up[0] == "-" else height


def colour_scene(cloud: Cloud, colour: ColourBy) -> Cloud:
    """Return a built-in scene in other colours: by height, or as it is for ``rgb``.

    Raises
    ------
    InputError
        If another field is asked for.
    """
    if colour.kind == RGB:
        return cloud
    if colour.kind != HEIGHT:
        raise InputError(
            f"the scene {cloud.name} has no field {colour.field!r}; it has rgb and height"
        )
    coloured = colour_values(heights(cloud.positions, cloud.origin, colour.up), colour)
    return dataclasses.replace(cloud, colours=coloured.colours, colour_key=coloured.key)


def _classes(values: npt.NDArray[np.float64]) -> Coloured:
    """Return the colours of classes. A value that is no whole number is none."""
    known = are_known(values) & (np.trunc(values) == values) & (np.abs(values) < 2.0**31)
    numbers, which, counts = np.unique(
        values[known].astype(np.int64), return_inverse=True, return_counts=True
    )
    found = class_colours(numbers)
    colours = np.tile(np.array(NEUTRAL, np.uint8), (len(values), 1))
    colours[known] = found[which]
    frequent = np.argsort(-counts, kind="stable")[:MOST_CLASSES]
    classes = [
        {
            "class": int(numbers[i]),
            "name": class_name(int(numbers[i])),
            "colour": "#{:02x}{:02x}{:02x}".format(*found[i]),
            "points": int(counts[i]),
        }
        for i in frequent
    ]
    key = {
        "by": CLASSIFICATION,
        "classes": classes,
        "other_classes": max(0, len(numbers) - MOST_CLASSES),
        "without_value": int(np.count_nonzero(~known)),
    }
    return Coloured(colours, key)


def _table(name: str) -> npt.NDArray[np.uint8]:
    """Return the colours of one of matplotlib's maps: shape (n, 3)."""
    # Here, since it takes a tenth of a second and most pictures need no map.
    from matplotlib import colormaps

    spelled = {known.lower(): known for known in colormaps}
    if name.lower() not in spelled:
        near = difflib.get_close_matches(name.lower(), spelled, 3)
        some = dict.fromkeys([*(spelled[each] for each in near), *EXAMPLES])
        raise InputError(f"there is no colour map {name!r}; there are: {', '.join(some)} and more")
    chosen = colormaps[spelled[name.lower()]]
    table: npt.NDArray[np.uint8] = chosen(np.arange(chosen.N), bytes=True)[:, :3]
    return table
