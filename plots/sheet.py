"""The layout of a figure: pictures in a grid, with titles, and a table of numbers.

The layout is in pixels, so that a pixel of a picture is a whole number of pixels of the figure.
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
SMALLEST = 360  # a picture whose longer side is shorter is enlarged by a whole factor
LARGEST = 1024  # a picture with a longer side is reduced by a whole factor
NARROWEST = 360  # least width of a column, so that titles and the table fit
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
    """A picture of a figure, with its title.

    Parameters
    ----------
    rgb
        Shape (height, width, 3), float64, 0..1; the same shape in all panels of a figure.
    title, line
        Title of the picture, and a line of explanation.
    """

    rgb: npt.NDArray[np.float64]
    title: str
    line: str


@dataclass(frozen=True)
class Row:
    """A row of the table; the heading of a section has no value."""

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
        Statistics of the run, as ``splatline render --stats`` writes them. Only those with a row in
        the table are shown, and only if they are not None.

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
    cells = [(n % columns, n // columns) for n in range(len(panels))]
    table_line = 0 if len(panels) == 4 else 1
    rows = _rows(stats)
    table_high = _draw_table(None, rows, 0, 0, 0)

    width = 2 * MARGIN + 3 * column - GAP
    height = max(2 * line - GAP, table_line * line + table_high) + TITLE + MARGIN
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor=PAPER)
    pen = Pen(figure, width, height)

    pen.text(MARGIN, 50, _name(stats), 30, INK, weight="bold")
    pen.text(MARGIN, 78, _subtitle(stats), 17, FAINT)
    for panel, picture, (across, down) in zip(panels, pictures, cells, strict=True):
        left = MARGIN + across * column
        top = TITLE + down * line
        pen.text(left, top + 24, panel.title, 20, INK, weight="bold")
        pen.text(left, top + 46, panel.line, 15, FAINT)
        pen.picture(left, top + HEADING, picture)
    left = MARGIN + 2 * column
    _draw_table(pen, rows, left, left + column - GAP, TITLE + table_line * line)

    data = io.BytesIO()
    with warnings.catch_warnings():
        # The cloud's name may have letters that the font lacks; they are drawn as boxes.
        warnings.filterwarnings("ignore", message="Glyph")
        figure.savefig(data, format="png", dpi=DPI, facecolor=PAPER)
    return data.getvalue()


class Pen:
    """Drawing on a figure in pixels, with the origin in its upper left corner."""

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
            fontfamily="DejaVu Sans",  # part of matplotlib, so figures do not depend on the machine
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

        level = self._height - y + 0.5
        line = Line2D([left, right], [level, level], transform=None, color=RULE, linewidth=72 / DPI)
        self._figure.add_artist(line)


def _fit(rgb: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return a picture, enlarged or reduced by a whole factor if it is too small or too large."""
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
    """Return the name of the scene or of the file."""
    name = PurePath(str(stats.get("cloud", "Splatline")).removeprefix("scene ")).name
    return name.encode("utf-8", "backslashreplace").decode()  # a name may be no text


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
    """Return the rows of the table, without empty sections."""
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
    """Return the colour of a value; the number of wrong pixels is good or bad."""
    if key != "mismatched_pixels":
        return INK
    return BAD if value else GOOD


def _draw_table(pen: Pen | None, rows: Sequence[Row], left: int, right: int, top: int) -> int:
    """Draw the table from ``top`` on and return its height; without a pen, only measure it."""
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
