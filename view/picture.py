"""A still picture in one call."""

from __future__ import annotations

import dataclasses
import os
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.atomic_write import atomic_write
from splatline.contract.errors import InputError
from splatline.host.cloud.upward import upward_of
from splatline.host.files.wanted import ColourBy
from splatline.host.visibility.view import fit_view
from splatline.plots.figure import png_bytes

from .camera import Camera
from .draw import Drawing, draw, draw_view
from .prepared import Drawable, prepare
from .settings_of import settings_of

__all__ = ["Picture", "render"]


@dataclasses.dataclass(frozen=True, repr=False)
class Picture:
    """A picture as the engine draws it. A notebook shows it.

    Parameters
    ----------
    drawing
        The picture, its code words and its statistics.
    """

    drawing: Drawing

    @property
    def rgb(self) -> npt.NDArray[np.uint8]:
        """The pixels: shape (height, width, 3), uint8."""
        return self.drawing.rgba[..., :3]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.drawing.view.width, self.drawing.view.height

    @property
    def counts(self) -> dict[str, Any]:
        """Statistics, as of ``make_frames``: points drawn and left out, code words, seconds."""
        return self.drawing.counts

    @cached_property
    def png(self) -> bytes:
        """The file that ``save`` writes."""
        return png_bytes(np.ascontiguousarray(self.rgb))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture as a PNG, whole or not at all.

        Raises
        ------
        InputError
            If the name does not end in .png, or the file cannot be written.
        """
        if Path(path).suffix.lower() != ".png":
            raise InputError(f"{Path(path)}: the name must end in .png, the format that is written")
        atomic_write(path, self.png)

    def _repr_png_(self) -> bytes:
        """Return what a notebook shows."""
        return self.png

    def __repr__(self) -> str:
        width, height = self.size
        engine = self.drawing.frames[0].config.name if self.drawing.frames else "no engine"
        return f"<Picture {width}x{height}: {self.counts['codewords']:,} code words for {engine}>"


def render(
    cloud: Drawable,
    *,
    size: tuple[int, int] = (512, 512),
    orbit: tuple[float, float] | None = None,
    fov: float | None = None,
    up: str | None = None,
    zoom: float | None = None,
    camera: Camera | None = None,
    colour: str | ColourBy | None = None,
    fit: str = "bulk",
    splat_size: float | None = None,
    **settings: Any,
) -> Picture:
    """Draw a cloud: bit for bit the picture of ``splatline render`` with the same options.

    Parameters
    ----------
    cloud
        A cloud, a scene, or the name of a cloud's file.
    size
        Width and height of the image in pixels; more than the engine's are drawn in tiles.
    orbit, fov, up, zoom
        As of ``fit_view``. None: the scene's, or 30 and 20 degrees, 35 degrees, ``Cloud.up``, 1.
    camera
        A camera, in place of these four.
    colour, fit, splat_size
        As of ``prepare``.
    **settings
        ``preset``, ``samples``, ``quality``, ``lights``, ``background``, ``skips`` and
        ``close_specks``; see ``settings_of``.

    Raises
    ------
    InputError
        If the file is bad, or an option has no such value.
    """
    chosen = settings_of(**settings)
    prepared = prepare(cloud, colour=colour, up=up, fit=fit, splat_size=splat_size)
    live = prepared.live
    if camera is None:
        options = prepared.camera(orbit=orbit, fov=fov, up=up, zoom=zoom)
        view = fit_view(live.cloud, size=size, radii=live.discs.radii, **options)
        upward = upward_of(options["orbit"], options["up"])
        return Picture(draw_view(live, view, upward, chosen))
    if any(option is not None for option in (orbit, fov, up, zoom)):
        raise InputError("give a camera, or orbit, fov, up and zoom, not both")
    return Picture(draw(live, camera, size, chosen))
