"""The built-in scenes: they need no download."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from splatline.contract.errors import InputError
from splatline.host.cloud.cloud import Cloud

__all__ = ["SCENES", "Scene", "load_scene"]


@dataclass(frozen=True)
class Scene:
    """A cloud and its view.

    Parameters
    ----------
    name
        One of ``SCENES``.
    cloud
        The points.
    orbit, fov, up, zoom
        As ``fit_view`` takes them.
    """

    name: str
    cloud: Cloud
    orbit: tuple[float, float]
    fov: float
    up: str
    zoom: float = 1.0


def load_scene(name: str) -> Scene:
    """Return a built-in scene; the same points every time.

    - ``terrain``: the USGS elevation model near Jacksboro, Tennessee, that matplotlib's wheel
      carries, 138,632 points coloured by height.
    - ``knot``: generated closed surfaces, 200,000 points with every direction of normal.

    Raises
    ------
    InputError
        If there is no scene of that name.
    """
    try:
        make = _MAKERS[name]
    except KeyError:
        raise InputError(f"no scene named {name!r}; there are: {', '.join(SCENES)}") from None
    return make()


def _terrain() -> Scene:
    from .terrain import terrain_cloud

    return Scene("terrain", terrain_cloud(), orbit=(-75.0, 48.0), fov=30.0, up="z")


def _knot() -> Scene:
    from .knot import knot_cloud

    return Scene("knot", knot_cloud(), orbit=(-8.0, 8.0), fov=30.0, up="y")


_MAKERS: dict[str, Callable[[], Scene]] = {"terrain": _terrain, "knot": _knot}

SCENES = tuple(_MAKERS)
"""Names of the built-in scenes."""
