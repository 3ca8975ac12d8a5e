"""``splatline.show``: a cloud in a notebook, to be turned by hand."""

from __future__ import annotations

import importlib.util
import sys
from typing import TYPE_CHECKING, Any

from splatline.contract.errors import InputError, install_hint
from splatline.host.files.wanted import ColourBy
from splatline.host.visibility.view import check_camera
from splatline.view.camera import Camera
from splatline.view.choices import Choices
from splatline.view.events import LARGEST, SMALLEST
from splatline.view.picture import Picture, render
from splatline.view.prepared import Drawable, prepare
from splatline.view.session import Session
from splatline.view.settings_of import settings_of
from splatline.view.subject import Subject

if TYPE_CHECKING:
    from .widget import CloudView

__all__ = ["show"]


def show(
    cloud: Drawable,
    *,
    size: tuple[int, int] = (512, 512),
    orbit: tuple[float, float] | None = None,
    fov: float | None = None,
    up: str | None = None,
    camera: Camera | None = None,
    colour: str | ColourBy | None = None,
    fit: str = "bulk",
    splat_size: float | None = None,
    **settings: Any,
) -> CloudView | Picture:
    """Show a cloud in a notebook: drag, wheel and keys move the camera as in ``splatline view``.

    Every picture is the engine's, bit for bit. While the camera moves, pictures are as coarse as
    they must be to be in time. Without anywidget (the extra ``notebook``) it is a still picture,
    and a line on the standard error says so.

    Parameters
    ----------
    cloud
        A cloud, a scene, or the name of a cloud's file.
    size
        Width and height in pixels of the page; a dense display has more pixels for each.
    orbit, fov, up, camera, colour, fit, splat_size, **settings
        As of ``render``.

    Raises
    ------
    InputError
        If the file is bad, or an option has no such value.
    """
    if not all(SMALLEST <= side <= LARGEST for side in size):
        raise InputError(
            f"the sides of the view must be {SMALLEST} to {LARGEST} pixels, not {size}"
        )
    if importlib.util.find_spec("anywidget") is None:
        hint = install_hint("notebook")
        print(f"splatline: a view that turns needs anywidget: {hint}", file=sys.stderr)
        return render(
            cloud, size=size, orbit=orbit, fov=fov, up=up, camera=camera, colour=colour, fit=fit,
            splat_size=splat_size, **settings,
        )  # fmt: skip
    from .widget import CloudView

    choices = Choices(settings_of(**settings))
    prepared = prepare(cloud, colour=colour, up=up, fit=fit, splat_size=splat_size)
    live = prepared.live
    if camera is not None:
        values: dict[str, Any] = {
            name: getattr(camera, name) for name in ("target", "distance", "orbit", "fov", "up")
        }
    else:
        values = prepared.camera(orbit=orbit, fov=fov, up=up, zoom=1.0)
        check_camera(values["orbit"], values["fov"], size, values["up"], values.pop("zoom"))
    session = Session(Subject(name=live.cloud.name, **values), choices)
    session.size = size
    session.take(live, choices.colour)
    return CloudView(session, size)
