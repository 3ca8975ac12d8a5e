"""Clouds ready to be drawn, of whatever a person has: a file's name, a cloud or a scene."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path
from typing import Any, NamedTuple

from splatline.contract.errors import InputError
from splatline.host.cloud.cloud import Cloud
from splatline.host.files.colouring import check_map, colour_scene
from splatline.host.files.readers import read_cloud
from splatline.host.files.source import usual_up
from splatline.host.files.wanted import HEIGHT, RGB, ColourBy
from splatline.host.scenes.scenes import Scene

from .live_cloud import LiveCloud, live_cloud

__all__ = ["Drawable", "Prepared", "prepare"]

Drawable = Cloud | Scene | str | os.PathLike[str]
"""Subjects of a view: a cloud, a built-in scene, or the name of a cloud's file."""


class Prepared(NamedTuple):
    """A cloud ready to be drawn, and how it is usually seen.

    Parameters
    ----------
    live
        The cloud.
    usual
        ``orbit``, ``fov``, ``up`` and ``zoom``, as of ``fit_view``.
    """

    live: LiveCloud
    usual: dict[str, Any]

    def camera(self, **asked: Any) -> dict[str, Any]:
        """Return ``orbit``, ``fov``, ``up`` and ``zoom``: those asked for, else the usual ones."""
        return {name: usual if asked[name] is None else asked[name]
                for name, usual in self.usual.items()}  # fmt: skip


class _Last(NamedTuple):
    """The cloud that was drawn last, as it was prepared."""

    cloud: Cloud
    options: tuple[object, ...]
    live: LiveCloud


_last: _Last | None = None


def prepare(
    what: Drawable,
    *,
    colour: str | ColourBy | None = None,
    up: str | None = None,
    fit: str = "bulk",
    splat_size: float | None = None,
) -> Prepared:
    """Return a cloud ready to be drawn.

    The last cloud or scene is kept, so that its next picture takes less time. Its arrays must not
    be changed in between.

    Parameters
    ----------
    what
        A cloud, a scene, or the name of a file, which is read.
    colour
        What colours a point, as of ``read_cloud``. A cloud in memory has ``rgb`` and ``height``.
    up
        The axis of the height; None: ``Cloud.up``.
    fit, splat_size
        As of ``live_cloud``.

    Raises
    ------
    InputError
        If the file is bad, or lacks what is to colour a point.
    """
    global _last
    by = ColourBy(colour) if isinstance(colour, str) else colour
    if not isinstance(what, Cloud | Scene):
        by = None if by is None else dataclasses.replace(by, up=up or usual_up(Path(what)))
        cloud = read_cloud(what, colour=by)
        return Prepared(live_cloud(cloud, fit=fit, splat_size=splat_size), _usual(cloud))
    cloud = what.cloud if isinstance(what, Scene) else what
    by = None if by is None else dataclasses.replace(by, up=up or cloud.up)
    options = (by, fit, splat_size)
    if _last is None or _last.cloud is not cloud or _last.options != options:
        coloured = cloud if by is None else _coloured(cloud, by)
        live = live_cloud(coloured, fit=fit, splat_size=splat_size)
        _last = _Last(cloud, options, live)
    usual = _usual(cloud)
    if isinstance(what, Scene):
        usual = {name: getattr(what, name) for name in usual}
    return Prepared(_last.live, usual)


def _usual(cloud: Cloud) -> dict[str, Any]:
    """Return how a cloud is usually seen."""
    return {"orbit": (30.0, 20.0), "fov": 35.0, "up": cloud.up, "zoom": 1.0}


def _coloured(cloud: Cloud, by: ColourBy) -> Cloud:
    """Return a cloud in memory in other colours."""
    if by.kind not in (RGB, HEIGHT):
        raise InputError(
            f"a cloud in memory has no field {by.field!r}, only rgb and height; give the colour"
            " when the file is read: read_cloud(path, colour=...)"
        )
    check_map(by)
    return colour_scene(cloud, by)
