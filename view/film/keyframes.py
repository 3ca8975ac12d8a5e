"""A way of the camera through keyframes, read from JSON or CSV."""

from __future__ import annotations

import csv
import dataclasses
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicHermiteSpline

from splatline.contract.errors import InputError
from splatline.view.camera import MOST_ELEVATION, Camera

__all__ = ["MOST_KEYS", "CameraPath", "read_path"]

MOST_KEYS = 10_000
"""Keyframes of a path."""

MOST_BYTES = 1 << 22
"""Bytes of a path's file."""

COLUMNS = ("time", "azimuth", "elevation", "distance", "x", "y", "z")
"""Names of the values of a keyframe in a CSV file; x, y and z are the target."""

FARTHEST = 1e100
"""Largest size of a value."""


@dataclasses.dataclass(frozen=True)
class CameraPath:
    """A camera that passes through keyframes.

    Between two keyframes each value is a cubic whose slope at a keyframe is that of the line
    through its neighbours: E. Catmull and R. Rom, *A class of local interpolating splines*, 1974,
    with the keyframes' own times. Azimuths go the short way round. The distance is interpolated in
    its logarithm, so that it stays above 0. An elevation beyond 90 degrees is cut off.

    Parameters
    ----------
    times
        Seconds, ascending: shape (n,), n at least 2.
    values
        Azimuth and elevation in degrees, distance, and the target: shape (n, 6).
    lens
        A camera whose up axis and field of view are kept.
    """

    times: npt.NDArray[np.float64]
    values: npt.NDArray[np.float64]
    lens: Camera

    @property
    def seconds(self) -> float:
        """Seconds from the first keyframe to the last."""
        return float(self.times[-1] - self.times[0])

    @property
    def is_closed(self) -> bool:
        """Whether the last keyframe shows what the first one does."""
        turn = (self.values[-1, 0] - self.values[0, 0]) % 360.0
        same = np.allclose(self.values[-1, 1:], self.values[0, 1:], rtol=1e-9, atol=1e-9)
        return bool(same) and min(turn, 360.0 - turn) < 1e-6

    def cameras(self, count: int) -> list[Camera]:
        """Return cameras at even steps of time.

        The last one is at the last keyframe; of a closed path it is a step before it, so that the
        film can be played again and again without a halt.
        """
        track = self.values.copy()
        track[:, 0] = np.unwrap(track[:, 0], period=360.0)
        track[:, 2] = np.log(track[:, 2])
        spline = CubicHermiteSpline(self.times, track, self._slopes(track))
        steps = count if self.is_closed else max(count - 1, 1)
        found = spline(self.times[0] + self.seconds * np.arange(count) / steps)
        found[:, 1] = np.clip(found[:, 1], -MOST_ELEVATION, MOST_ELEVATION)
        found[:, 2] = np.exp(found[:, 2])
        return [
            dataclasses.replace(
                self.lens,
                azimuth=(azimuth + 180.0) % 360.0 - 180.0,
                elevation=elevation,
                distance=distance,
                target=(x, y, z),
            )
            for azimuth, elevation, distance, x, y, z in found.tolist()
        ]

    def _slopes(self, track: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the slopes at the keyframes; those of both ends are equal on a closed path."""
        times = self.times
        slopes = np.empty_like(track)
        slopes[1:-1] = (track[2:] - track[:-2]) / (times[2:] - times[:-2])[:, np.newaxis]
        first, last = (track[[1, -1]] - track[[0, -2]]) / (times[[1, -1]] - times[[0, -2]])[:, None]
        if self.is_closed and len(times) > 2:
            step = times[1] - times[0] + times[-1] - times[-2]
            first = last = (track[1] - track[0] + track[-1] - track[-2]) / step
        slopes[0], slopes[-1] = first, last
        return slopes


def read_path(path: Path, home: Camera) -> CameraPath:
    """Return the camera's path from a file.

    Parameters
    ----------
    path
        JSON: a list of objects with ``time`` and any of ``azimuth``, ``elevation``, ``distance``
        and ``target``; or CSV with a heading of ``time`` and any of ``azimuth``, ``elevation``,
        ``distance``, ``x``, ``y`` and ``z``.
    home
        The camera that gives what a keyframe leaves out.

    Raises
    ------
    InputError
        If the file cannot be read, has less than two keyframes, or a value that is none.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise InputError(f"has more than {MOST_BYTES:,} bytes")
        text = data.decode("utf-8-sig")
        rows = _json_rows(text) if path.suffix.lower() == ".json" else _csv_rows(text)
        return _assemble(rows, home)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is no text; a camera's path is JSON or CSV") from None
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _json_rows(text: str) -> list[Mapping[str, Any]]:
    """Return the keyframes of a JSON file, each by the names of ``COLUMNS``."""
    try:
        keys = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"is no JSON ({error})") from None
    if not isinstance(keys, list) or not all(isinstance(key, dict) for key in keys):
        raise InputError('must be a list of objects such as {"time": 0, "azimuth": 30}')
    rows: list[Mapping[str, Any]] = []
    for number, key in enumerate(keys, 1):
        row = dict(key)
        target = row.pop("target", None)
        if target is not None:
            if not isinstance(target, list) or len(target) != 3:
                raise InputError(f"the target of keyframe {number} must be three numbers")
            row |= zip("xyz", target, strict=True)
        rows.append(row)
    return rows


def _csv_rows(text: str) -> list[Mapping[str, Any]]:
    """Return the keyframes of a CSV file."""
    try:
        lines = [line for line in csv.reader(text.splitlines()) if any(map(str.strip, line))]
    except csv.Error as error:
        raise InputError(f"is no CSV ({error})") from None
    head = [name.strip().lower() for name in lines[0]] if lines else []
    for number, line in enumerate(lines[1:], 1):
        if len(line) != len(head):
            raise InputError(f"keyframe {number} has {len(line)} values, not {len(head)}")
    return [
        {name: value for name, value in zip(head, line, strict=True) if value.strip()}
        for line in lines[1:]
    ]


def _assemble(rows: list[Mapping[str, Any]], home: Camera) -> CameraPath:
    """Return the path of keyframes, each a mapping by the names of ``COLUMNS``."""
    if not 2 <= len(rows) <= MOST_KEYS:
        raise InputError(f"needs 2 to {MOST_KEYS:,} keyframes, not {len(rows):,}")
    usual = dict(zip(COLUMNS[1:], (*home.orbit, home.distance, *home.target), strict=True))
    table = np.empty((len(rows), len(COLUMNS)))
    for number, row in enumerate(rows, 1):
        if unknown := sorted(set(row) - set(COLUMNS)):
            raise InputError(
                f"keyframe {number} has {unknown[0]!r}, which is none of {', '.join(COLUMNS)}"
            )
        if "time" not in row:
            raise InputError(f"keyframe {number} has no time")
        table[number - 1] = [
            _number(row.get(name, usual.get(name)), name, number) for name in COLUMNS
        ]
    times, values = table[:, 0], table[:, 1:]
    if not (np.diff(times) > 0.0).all():
        raise InputError("the times of the keyframes must ascend")
    if not (values[:, 2] > 0.0).all():
        raise InputError("the distances must be above 0")
    if not (np.abs(values[:, 1]) <= MOST_ELEVATION).all():
        raise InputError("the elevations must lie in -90 to 90 degrees")
    return CameraPath(times, values, home)


def _number(value: Any, name: str, number: int) -> float:
    """Return a value of a keyframe as a finite number."""
    try:
        found = float(value) if not isinstance(value, bool) else math.nan
    except (TypeError, ValueError, OverflowError):
        found = math.nan
    if not abs(found) <= FARTHEST:  # true for NaN
        raise InputError(f"{name} of keyframe {number} must be a number, not {value!r}")
    return found
