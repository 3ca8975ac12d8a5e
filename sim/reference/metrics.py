"""Measures of an engine's error: PSNR, SSIM, holes, silhouette and depth."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from splatline.sim.golden.multisample import Drawn

from .reference import Reference

__all__ = ["compare", "psnr"]

_Floats = npt.NDArray[np.float64]
_Mask = npt.NDArray[np.bool_]

SILHOUETTE = 0.5
"""Coverage above which a pixel of the reference counts as foreground."""

SSIM_WINDOW = 11
"""Width of SSIM's window in pixels; a smaller image has no SSIM."""


def compare(
    raster: Drawn,
    reference: Reference,
    *,
    background: tuple[float, float, float] = (1.0, 1.0, 1.0),
    depth_range: tuple[float, float] | list[float] | None = None,
) -> dict[str, float | None]:
    """Measure the error of an engine's picture.

    Parameters
    ----------
    raster
        The engine's picture. With several samples a pixel, a pixel counts as drawn if at least half
        of its samples are.
    reference
        The exact picture of the same cloud and view, drawn with the same background.
    background
        RGB in 0..1 of the pixels that nothing was drawn into.
    depth_range
        Distances along the view of depth 0 and of the largest depth below the background's:
        ``frame.counts["depth_range"]``. Without it there is no depth error.

    Returns
    -------
    dict
        Plain floats; None if a value is infinite or undefined:

        - ``psnr_db``: peak signal to noise ratio over all pixels and channels, in dB; None where
          the pictures are equal. The peak is 1.
        - ``psnr_foreground_db``: PSNR over the pixels whose coverage is above a half.
        - ``ssim``: structural similarity, the mean over the channels, with the Gaussian weights of
          Wang, Bovik, Sheikh and Simoncelli, *Image quality assessment*, IEEE Trans. Image
          Processing 13 (2004); None where a side has fewer than 11 pixels.
        - ``hole_fraction``: share of background among the pixels that the reference covers fully.
        - ``silhouette_iou``: intersection over union of two sets of pixels: those that the engine
          drew, and those whose coverage is above a half.
        - ``depth_rmse``: root mean square error of depth, as a share of the depth range, over the
          pixels that the reference covers fully and the engine drew. One step of a 9-bit depth is
          1/510 = 0.00196.

    Raises
    ------
    ValueError
        If the pictures have different sizes.
    """
    if raster.depth.shape != reference.depth.shape:
        raise ValueError(
            f"pictures of {raster.depth.shape} and {reference.depth.shape} pixels do not compare"
        )
    picture = raster.to_rgb(background)
    drawn = raster.drawn
    foreground = reference.coverage > SILHOUETTE
    whole = reference.coverage == 1.0
    return {
        "psnr_db": psnr(picture, reference.rgb),
        "psnr_foreground_db": psnr(picture[foreground], reference.rgb[foreground]),
        "ssim": _ssim(picture, reference.rgb),
        "hole_fraction": _share(whole & ~drawn, whole),
        "silhouette_iou": _share(drawn & foreground, drawn | foreground),
        "depth_rmse": _depth_rmse(raster, reference, whole & drawn, depth_range),
    }


def psnr(picture: _Floats, exact: _Floats) -> float | None:
    """Return the PSNR for a peak of 1; None if there are no pixels or no error."""
    if not picture.size:
        return None
    error = float(np.mean((picture - exact) ** 2))
    return -10.0 * math.log10(error) if error > 0.0 else None


def _ssim(picture: _Floats, exact: _Floats) -> float | None:
    """Return the structural similarity, or None if the image is smaller than the window."""
    if min(picture.shape[:2]) < SSIM_WINDOW:
        return None
    from skimage.metrics import structural_similarity  # half a second to import

    value = structural_similarity(
        picture,
        exact,
        channel_axis=2,
        data_range=1.0,
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
    )
    return float(value)


def _share(part: _Mask, whole: _Mask) -> float | None:
    """Return the number of pixels of ``part`` over that of ``whole``, or None if that is 0."""
    total = np.count_nonzero(whole)
    return float(np.count_nonzero(part) / total) if total else None


def _depth_rmse(
    raster: Drawn,
    reference: Reference,
    where: _Mask,
    depth_range: tuple[float, float] | list[float] | None,
) -> float | None:
    """Return the RMS error of depth as a share of the depth range, over the pixels of a mask."""
    largest = raster.config.background_depth - 1
    if depth_range is None or largest == 0 or not where.any():
        return None
    nearest, furthest = depth_range
    if not furthest > nearest:
        return None
    share = (reference.depth[where] - nearest) / (furthest - nearest)
    return float(np.sqrt(np.mean((raster.depth[where] / largest - share) ** 2)))
