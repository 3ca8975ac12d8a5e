"""Pictures beside the engine's: the paper's engine, and the exact reference."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from splatline.contract.presets import PAPER
from splatline.host.shading.light_sets import LIGHTS
from splatline.host.visibility.trim import trimmed_radii
from splatline.plots.figure import rgb_levels
from splatline.sim.golden.multisample import average
from splatline.sim.reference import reference
from splatline.sim.reference.metrics import psnr

from .camera import Camera
from .draw import Drawing, Settings, draw
from .live_cloud import LiveCloud
from .pixels import opaque

__all__ = ["Exact", "draw_exact", "draw_paper"]


@dataclass(frozen=True)
class Exact:
    """The exact reference's picture.

    Parameters
    ----------
    picture
        Colours and depths.
    """

    picture: reference.Reference

    @property
    def rgba(self) -> npt.NDArray[np.uint8]:
        """The picture: shape (height, width, 4), uint8."""
        return opaque(rgb_levels(self.picture.rgb))

    def depth_rgba(self, depth_range: tuple[float, float]) -> npt.NDArray[np.uint8]:
        """Return the depth as greys, near is white, over a range of distances along the view."""
        near, far = depth_range
        share = (self.picture.depth - near) / max(far - near, np.finfo(np.float64).tiny)
        bright = np.where(np.isnan(share), 0.0, 1.0 - np.clip(share, 0.0, 1.0))
        return opaque(rgb_levels(bright[..., np.newaxis]))

    def psnr(self, drawing: Drawing) -> float | None:
        """Return an engine's peak signal to noise ratio in dB; None: no error."""
        return psnr(average(drawing.rasters).to_rgb(drawing.background), self.picture.rgb)


def draw_exact(
    live: LiveCloud,
    camera: Camera,
    size: tuple[int, int],
    settings: Settings,
    progress: Callable[[float], None],
) -> Exact:
    """Draw the exact reference of a picture; ``progress`` is told the share that is done."""
    radii, _, cover = live.discs.drawn(close_specks=settings.close_specks)
    view = camera.view(live.cloud, size)
    return Exact(
        reference.render(
            live.index(settings.preset, camera.upward).cloud,
            view,
            trimmed_radii(live.cloud.positions, radii, view, cover),
            LIGHTS[settings.lights],
            background=settings.background,
            progress=progress,
        )
    )


def draw_paper(
    live: LiveCloud,
    camera: Camera,
    size: tuple[int, int],
    settings: Settings,
    check: Callable[[], None],
) -> Drawing:
    """Draw a picture as the paper's engine does: 9-bit colour, one sample, the paper's shapes."""
    return draw(
        live, camera, size, replace(settings, preset=PAPER, quality="paper", samples=1), check=check
    )
