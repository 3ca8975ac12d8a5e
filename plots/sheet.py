"""The layout of a figure: pictures in a grid, with titles, and a table of numbers.

Laid out in pixels, so that a pixel of a picture is a whole pixel of the figure, or several.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Panel", "compose"]

DPI = 100

# Sizes in pixels.
SMALLEST = 360  # a picture with shorter sides only is enlarged, by a whole factor
LARGEST = 1024  # one with a longer side is reduced
NARROWEST = 360  # a column, so that titles and the table fit
MARGIN = 44
GAP = 36
TITLE = 96  # above the grid
HEADING = 58  # above each picture
ROW = 24  # of the table
SECTION = 34  # a heading within the table
APART = 26  # between sections of the table

PAPER = "#0d0f12"
INK = "#eef1f5"
FAINT = "#9aa3af"
RULE = "#2e343d"
GOOD = "#7ddc9a"
BAD = "#ff7a70"

# Statistics that the table shows, by section: key, label, format.
CLOUD = (
    ("points", "Points", "{:,}"),
    ("culled", "Left out", "{:,}"),
    ("elements", "Elements drawn", "{:,}"),
    ("codewords", "Code words", "{:,}"),
    ("control_words", "of them control words", "{:,}"),
)
MACHINE = (
    ("cycles", "Clock cycles", "{:,}"),
    ("cycles_per_element", "Cycles an element", "{:.3f}"),
    ("mismatched_pixels", "Pixels unlike golden", "{:,}"),
)
ERROR = (
    ("psnr_db", "PSNR", "{:.2f} dB"),
    ("psnr_foreground_db", "PSNR, foreground", "{:.2f} dB"),
    ("ssim", "SSIM", "{:.4f}"),
    ("hole_fraction", "Holes", "{:.2%}"),
    ("silhouette_iou", "Silhouette IoU", "{:.4f}"),
    ("depth_rmse", "Depth error, RMS of range", "{:.2%}"),
)


@dataclass(frozen=True)
class Panel:
    """A picture of a figure.

    Parameters
    ----------
    rgb
        Shape (height, width, 3), float64, 0..1; the same shape in all panels of a figure.
    title, line
        What it is, and a line about it.
    """

    rgb: npt.NDArray[np.float64]
    title: str
    line: str


@dataclass(frozen=True)
class Row:
    """A line of the table; a section's heading has no value."""

    label: str
    value: str | None = None
    colour: str = INK


def compose(panels: Sequence[Panel], stats: Mapping[str, Any]) -> bytes:
    """Return a figure of four or five pictures and a table, as a PNG.

    Parameters
    ----------
    panels
        Four or five pictures of one size: the table takes the last column, or its lower cell.
    stats
        The numbers of the run, as ``splatline render --stats`` writes them; those that the table
        does not know, or that are None, are left out.

    Raises
    ------
    ValueError
        If there are not four or five pictures, or they have different sizes.
    """
    if len(panels) not in (4, 5):
        raise ValueError(f"the figure has room for four or five pictures, not {len(panels)}")
    if len({panel.rgb.shape for panel in panels}) != 1:
        raise ValueError("the pictures of a figure have one size")
    from matplotlib.figure import Figure

    pictures = [_fit(panel.rgb) for panel in panels]
    high, wide = pictures[0].shape[:2]
    column = max(wide, NARROWEST) + GAP
    line = HEADING + high + GAP
    columns = 2 if len(panels) == 4 else 3
    places = [(n % columns, n // columns) for n in range(len(panels))]
    table_line = 0 if len(panels) == 4 else 1
    rows = _rows(stats)
    table_high = _draw_table(None, rows, 0, 0, 0)

    width = 2 * MARGIN + 3 * column - GAP
    height = max(2 * line - GAP, table_line * line + table_high) + TITLE + MARGIN
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor=PAPER)
    pen = Pen(figure, width, height)

    pen.text(MARGIN, 50, _name(stats), 30, INK, weight="bold")
    pen.text(MARGIN, 78, _subtitle(stats), 17, FAINT)
    for panel, picture, (across, down) in zip(panels, pictures, places, strict=True):
        left = MARGIN + across * column
        top = TITLE + down * line
        pen.text(left, top + 24, panel.title, 20, INK, weight="bold")
        pen.text(left, top + 46, panel.line, 15, FAINT)
        pen.picture(left, top + HEADING, picture)
    left = MARGIN + 2 * column
    _draw_table(pen, rows, left, left + column - GAP, TITLE + table_line * line)

    data = io.BytesIO()
    with warnings.catch_warnings():
        # A cloud may be named in letters that the font has not; boxes stand for them.
        warnings.filterwarnings("ignore", message="Glyph")
        figure.savefig(data, format="png", dpi=DPI, facecolor=PAPER)
    return data.getvalue()


class Pen:
    """Draws on a figure in pixels, from its upper left corner."""

    def __init__(self, figure: Figure, width: int, height: int) -> None:
        self._figure = figure
        self._width = width
        self._height = height

    def text(self, x: int, y: int, text: str, size: int, colour: str, **style: Any) -> None:
        """Write a line of text on the base line y; ``size`` is the font's, in pixels."""
        self._figure.text(
            x / self._width,
            1.0 - y / self._height,
            text,
            color=colour,
            fontsize=size * 72 / DPI,
            fontfamily="DejaVu Sans",  # comes with matplotlib: the figure is the same anywhere
            parse_math=False,
            **style,
        )

    def picture(self, x: int, y: int, rgb: npt.NDArray[np.float64]) -> None:
        """Put a picture's upper left corner at (x, y), with a thin frame around it."""
        from matplotlib.patches import Rectangle

        high, wide = rgb.shape[:2]
        below = self._height - y - high
        levels = np.rint(rgb.clip(0.0, 1.0) * 255.0).astype(np.uint8)
        self._figure.figimage(levels, x, below, origin="upper")
        frame = Rectangle((x - 1, below - 1), wide + 2, high + 2, transform=None)
        frame.set(facecolor=RULE, linewidth=0, antialiased=False, zorder=-1)  # under the picture
        self._figure.add_artist(frame)

    def rule(self, left: int, right: int, y: int) -> None:
        """Draw a thin horizontal line."""
        from matplotlib.lines import Line2D

        place = self._height - y + 0.5
        line = Line2D([left, right], [place, place], transform=None, color=RULE, linewidth=72 / DPI)
        self._figure.add_artist(line)


def _fit(rgb: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return a picture, enlarged or reduced by a whole factor if it is very small or very large."""
    height, width = rgb.shape[:2]
    longest = max(height, width)
    if longest < SMALLEST:
        factor = -(-SMALLEST // longest)
        return rgb.repeat(factor, axis=0).repeat(factor, axis=1)
    factor = -(-longest // LARGEST)
    if factor == 1:
        return rgb
    padded = np.pad(rgb, ((0, -height % factor), (0, -width % factor), (0, 0)), mode="edge")
    blocks = padded.reshape(len(padded) // factor, factor, -1, factor, 3)
    mean: npt.NDArray[np.float64] = blocks.mean(axis=(1, 3))
    return mean


def _name(stats: Mapping[str, Any]) -> str:
    """Return what was drawn: the scene's name or the file's."""
    return PurePath(str(stats.get("cloud", "Splatline")).removeprefix("scene ")).name


def _subtitle(stats: Mapping[str, Any]) -> str:
    """Return a line about the picture and the engine."""
    parts = []
    if stats.get("size"):
        width, height = stats["size"]
        parts.append(f"{width} \N{MULTIPLICATION SIGN} {height} pixels")
    if stats.get("preset"):
        parts.append(f"engine preset {stats['preset']}")
    view = stats.get("view") or {}
    if view.get("orbit"):
        azimuth, elevation = view["orbit"]
        parts.append(f"orbit {azimuth:g}\N{DEGREE SIGN}, {elevation:g}\N{DEGREE SIGN}")
    if view.get("fov"):
        parts.append(f"field of view {view['fov']:g}\N{DEGREE SIGN}")
    return "   \N{MIDDLE DOT}   ".join(parts)


def _rows(stats: Mapping[str, Any]) -> list[Row]:
    """Return the table's lines: the sections that there are numbers for."""
    stats = dict(stats)
    if isinstance(stats.get("culled"), Mapping):
        stats["culled"] = sum(stats["culled"].values())
    rows = []
    for heading, entries in (
        ("Cloud", CLOUD),
        ("Verilog", MACHINE),
        ("Engine against reference", ERROR),
    ):
        section = [
            Row(label, template.format(stats[key]), _colour(key, stats[key]))
            for key, label, template in entries
            if stats.get(key) is not None
        ]
        if section:
            rows += [Row(heading), *section]
    return rows


def _colour(key: str, value: Any) -> str:
    """Return the colour of a value: good or bad, where one can tell."""
    if key != "mismatched_pixels":
        return INK
    return BAD if value else GOOD


def _draw_table(pen: Pen | None, rows: Sequence[Row], left: int, right: int, top: int) -> int:
    """Draw the table from ``top`` on, or measure it where there is no pen; return its height."""
    y = top
    for row in rows:
        if row.value is None:
            y += 0 if y == top else APART
            if pen:
                pen.text(left, y + 24, row.label, 20, INK, weight="bold")
                pen.rule(left, right, y + SECTION)
            y += SECTION + 8
        else:
            if pen:
                pen.text(left, y + 18, row.label, 16, FAINT)
                pen.text(right, y + 18, row.value, 16, row.colour, horizontalalignment="right")
            y += ROW
    return y - top
