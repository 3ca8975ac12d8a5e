"""Picture files of a run: single PNGs, and a figure of them side by side with the statistics."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.atomic_write import atomic_write
from splatline.sim.golden.multisample import Drawn, mismatches
from splatline.sim.reference.reference import Reference

__all__ = [
    "BACKGROUND",
    "GAIN",
    "depth_levels",
    "picture_set",
    "png_bytes",
    "rgb_levels",
    "save_depth",
    "save_rgb",
]

_Floats = npt.NDArray[np.float64]

BACKGROUND = (23 / 255, 26 / 255, 31 / 255)
"""RGB of the background: dark, so that lit surfaces stand out."""

GAIN = 4
"""Amplification of the difference picture."""

DEPTHS = "viridis_r"
"""Colour map of depth in the figure."""


def save_rgb(path: str | Path, rgb: npt.ArrayLike) -> None:
    """Write a picture as an 8-bit PNG, atomically.

    Parameters
    ----------
    path
        The file; its folder must exist.
    rgb
        Shape (height, width, 3), float; clipped to 0..1.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    _save(path, rgb_levels(rgb))


def save_depth(path: str | Path, raster: Drawn) -> None:
    """Write a raster's depth as a 16-bit grey PNG: near is white, the background is 0.

    Depth d is stored as ``(b - d) 65535 / b``, rounded, where b is the background's depth. The
    conversion is lossless.

    Parameters
    ----------
    path
        The file; its folder must exist.
    raster
        The picture.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    _save(path, depth_levels(raster))


def rgb_levels(rgb: npt.ArrayLike) -> npt.NDArray[np.uint8]:
    """Return a picture's levels, as :func:`save_rgb` writes them."""
    levels = np.rint(np.clip(np.asarray(rgb, np.float64), 0.0, 1.0) * 255.0)
    return levels.astype(np.uint8)


def depth_levels(raster: Drawn) -> npt.NDArray[np.uint16]:
    """Return the levels of a raster's depth, as :func:`save_depth` writes them."""
    background = raster.config.background_depth
    nearness = background - np.arange(background + 1.0)
    levels = np.rint(nearness * (65535.0 / background)).astype(np.uint16)
    return levels[raster.depth]


def picture_set(
    out_dir: str | Path,
    *,
    rtl: Drawn | None,
    golden: Drawn,
    reference: Reference,
    background: tuple[float, float, float] = BACKGROUND,
    stats: Mapping[str, Any] | None = None,
) -> list[Path]:
    """Write the pictures of a run, and a figure of all of them.

    Parameters
    ----------
    out_dir
        An existing folder. It gets ``engine.png``, ``golden.png``, ``reference.png``,
        ``difference.png`` (engine against reference, ``GAIN`` times), ``depth.png`` and
        ``figure.png``.
    rtl
        The Verilog's picture; if None, the golden renderer's picture is shown as the engine's.
    golden
        The golden renderer's picture.
    reference
        The exact picture, drawn with the same background.
    background
        RGB in 0..1 of the background.
    stats
        Statistics of the run, as ``splatline render --stats`` writes them; the figure shows some.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InputError
        If a file cannot be written.
    ValueError
        If the pictures have different sizes.
    """
    folder = Path(out_dir)
    engine = golden if rtl is None else rtl
    if engine.depth.shape != reference.depth.shape:
        raise ValueError("the engine's picture and the reference have different sizes")
    drawn = engine.to_rgb(background)
    difference = np.minimum(GAIN * np.abs(drawn - reference.rgb), 1.0)
    pictures = {
        "engine.png": drawn,
        "golden.png": golden.to_rgb(background),
        "reference.png": reference.rgb,
        "difference.png": difference,
    }
    for name, rgb in pictures.items():
        save_rgb(folder / name, rgb)
    save_depth(folder / "depth.png", engine)

    from .sheet import Panel, compose

    if rtl is None:
        panels = [Panel(drawn, "Engine", "the golden renderer, exact to the bit")]
    else:
        unlike = f"{mismatches(rtl, golden):,} of {rtl.depth.size:,} pixels unlike the Verilog's"
        panels = [
            Panel(drawn, "Engine", "the generated Verilog, simulated"),
            Panel(pictures["golden.png"], "Golden renderer", unlike),
        ]
    error = f"|engine \N{MINUS SIGN} reference|, amplified {GAIN} times"
    steps = f"{engine.config.depth_bits} bits: near is bright, far is dark"
    panels += [
        Panel(reference.rgb, "Exact reference", "true discs in perspective, supersampled"),
        Panel(difference, "Difference", error),
        Panel(_false_colours(engine, background), "Depth", steps),
    ]
    atomic_write(folder / "figure.png", compose(panels, stats or {}))
    return [folder / name for name in (*pictures, "depth.png", "figure.png")]


def png_bytes(pixels: npt.NDArray[Any]) -> bytes:
    """Return pixels as a PNG: shape (height, width) or (height, width, 3 or 4), uint8 or uint16."""
    from PIL import Image

    data = io.BytesIO()
    Image.fromarray(pixels).save(data, "PNG")
    return data.getvalue()


def _save(path: str | Path, pixels: npt.NDArray[Any]) -> None:
    """Write pixels as a PNG, atomically."""
    atomic_write(path, png_bytes(pixels))


def _false_colours(raster: Drawn, background: tuple[float, float, float]) -> _Floats:
    """Return depth in false colours, stretched over the range of the drawn pixels."""
    from matplotlib import colormaps

    drawn = raster.drawn
    rgb = np.empty((*raster.depth.shape, 3))
    rgb[:] = background
    if drawn.any():
        depth = raster.depth[drawn].astype(np.float64)
        depth -= depth.min()
        rgb[drawn] = colormaps[DEPTHS](depth / max(float(depth.max()), 1.0))[:, :3]
    return rgb
