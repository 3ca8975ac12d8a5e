"""Sheets of pictures for ``bench accuracy``: enlarged parts, one sheet for each scene and view."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.sim.reference.reference import Reference

from .sheet import DPI, FAINT, INK, PAPER, Pen

__all__ = ["SHOWN", "Crops", "compose_pictures"]

_Pixels = npt.NDArray[np.uint8]

SIDE = 96
"""Side of a part in pixels."""

ENLARGED = 2
"""Enlargement of a part on the sheet."""

OVERVIEW = 2
"""Reduction of the whole picture for the overview."""

NARROWEST = 150
"""Least width of the overview's column on the sheet in pixels, for the text above it."""

COLUMNS = (
    ("reference", None),
    ("float", None),
    ("exact \N{MULTIPLICATION SIGN}4", "plane"),
    ("exact", "plane"),
    ("exact", "rgb24"),
    ("paper", "paper"),
)
"""Quality and preset of each picture of a row."""

SHOWN = (None, 7.0)
"""Sizes of splats with a row in the sheet; None: by the points' spacing."""

MARGIN, GAP, TITLE, HEADING = 32, 14, 80, 44  # pixels of the sheet

FRAME = (255, 255, 255)
"""RGB of the frame around the part in the overview."""


class Crops:
    """The same part of every picture of a case.

    Parameters
    ----------
    scene, orbit, splats
        The case: scene, orbit and size of splats in pixels (None: by the points' spacing).
    exact
        The reference's picture.
    part
        Lines and columns of the part; by default those where the reference has most detail.
    """

    def __init__(
        self,
        scene: str,
        orbit: tuple[float, float],
        splats: float | None,
        exact: Reference,
        part: tuple[slice, slice] | None = None,
    ) -> None:
        self.scene, self.orbit, self.splats = scene, orbit, splats
        self.part = part or busiest(exact.rgb, min(SIDE, *exact.rgb.shape[:2]))
        self.parts: dict[tuple[str, str | None], _Pixels] = {}
        self.add("reference", None, exact.rgb)
        self.overview = _reduce(_frame(_bytes(exact.rgb), self.part))

    def add(self, quality: str, preset: str | None, rgb: npt.NDArray[np.float64]) -> None:
        """Keep the part of a picture: shape (height, width, 3), 0..1."""
        if (quality, preset) in COLUMNS:
            self.parts[quality, preset] = _bytes(rgb[self.part])


def busiest(rgb: npt.NDArray[np.float64], side: int) -> tuple[slice, slice]:
    """Return the square part of a picture with the largest differences between neighbours."""
    grey = rgb.mean(axis=2)
    change = np.zeros_like(grey)
    change[:, 1:] += np.abs(np.diff(grey, axis=1))
    change[1:] += np.abs(np.diff(grey, axis=0))
    total = np.zeros((grey.shape[0] + 1, grey.shape[1] + 1))
    total[1:, 1:] = change.cumsum(axis=0).cumsum(axis=1)
    sums = total[side:, side:] - total[:-side, side:] - total[side:, :-side] + total[:-side, :-side]
    line, column = np.unravel_index(int(sums.argmax()), sums.shape)
    return slice(int(line), int(line) + side), slice(int(column), int(column) + side)


def compose_pictures(
    cases: Sequence[Crops], psnr: Mapping[tuple[Any, str, str | None], float | None]
) -> bytes:
    """Return a sheet of a scene's cases, a row each, as a PNG.

    Parameters
    ----------
    cases
        One scene and view, several sizes of splats.
    psnr
        PSNR in dB, by (splats, quality, preset).
    """
    from matplotlib.figure import Figure

    high, wide = next(iter(cases[0].parts.values())).shape[:2]
    high, wide = high * ENLARGED, wide * ENLARGED
    over_high, over_wide = cases[0].overview.shape[:2]
    left = MARGIN + max(over_wide, NARROWEST) + 2 * GAP
    width = left + len(COLUMNS) * (wide + GAP) - GAP + MARGIN
    rows = TITLE + len(cases) * (HEADING + high + GAP)
    height = max(rows, TITLE + HEADING + over_high + GAP) + MARGIN // 2
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor=PAPER)
    pen = Pen(figure, width, height)

    azimuth, elevation = cases[0].orbit
    pen.text(MARGIN, 44, cases[0].scene, 26, INK, weight="bold")
    pen.text(MARGIN, 68, f"orbit {azimuth:g}\N{DEGREE SIGN}, {elevation:g}\N{DEGREE SIGN};"
             " quality and preset above each picture, with its PSNR over the whole image",
             15, FAINT)  # fmt: skip
    pen.text(MARGIN, TITLE + 32, "reference", 14, FAINT)
    pen.picture(MARGIN, TITLE + HEADING, cases[0].overview / 255.0)
    for row, case in enumerate(cases):
        top = TITLE + row * (HEADING + high + GAP)
        size = "splats fitted" if case.splats is None else f"splats of {case.splats:g} px"
        for column, key in enumerate(COLUMNS):
            if key not in case.parts:
                continue
            x = left + column * (wide + GAP)
            name = " ".join(part for part in key if part)
            value = psnr.get((case.splats, *key))
            line = size if key[0] == "reference" else "" if value is None else f"{value:.2f} dB"
            pen.text(x, top + 20, name, 16, INK, weight="bold")
            pen.text(x, top + 37, line, 13, FAINT)
            enlarged = case.parts[key].repeat(ENLARGED, axis=0).repeat(ENLARGED, axis=1)
            pen.picture(x, top + HEADING, enlarged / 255.0)
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=DPI, facecolor=PAPER)
    return data.getvalue()


def _bytes(rgb: npt.NDArray[np.float64]) -> _Pixels:
    """Return a picture as 8-bit RGB."""
    return np.rint(rgb.clip(0.0, 1.0) * 255.0).astype(np.uint8)


def _frame(pixels: _Pixels, part: tuple[slice, slice]) -> _Pixels:
    """Draw a frame around a part, one pixel of the overview wide."""
    lines, columns = part
    inner = pixels[part].copy()[OVERVIEW:-OVERVIEW, OVERVIEW:-OVERVIEW]
    pixels[part] = FRAME
    pixels[lines.start + OVERVIEW : lines.stop - OVERVIEW,
           columns.start + OVERVIEW : columns.stop - OVERVIEW] = inner  # fmt: skip
    return pixels


def _reduce(pixels: _Pixels) -> _Pixels:
    """Return a picture reduced by ``OVERVIEW``, without the rest of its lines and columns."""
    height, width = (length // OVERVIEW for length in pixels.shape[:2])
    even = pixels[: height * OVERVIEW, : width * OVERVIEW].astype(np.float64)
    blocks = even.reshape(height, OVERVIEW, width, OVERVIEW, 3)
    return np.rint(blocks.mean(axis=(1, 3))).astype(np.uint8)
