"""Colours of every kind that files have, as bytes."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

__all__ = [
    "NEUTRAL",
    "are_known",
    "brightest",
    "colours_to_bytes",
    "greys",
    "harmonics_to_bytes",
    "robust_range",
    "unpack_colours",
]

NEUTRAL = (214, 164, 124)
"""Colour of points that have none: clay. With three bits a channel its channels change level one
after the other, so it shows finer shades than a grey does. All of its shades are warm; a paler tint
would show bands of several hues."""

HARMONIC = 0.28209479177387814
"""The constant spherical harmonic: 1 / (2 sqrt(pi))."""

DARKEST, LIGHTEST = 40.0, 235.0
"""Greys of the least and the greatest intensity."""

PIECE = 1 << 20
"""Values that are counted at once."""

LARGEST = 1e100
"""Values beyond this stand for no value."""

OUTLIERS = 0.02
"""Most values above a scale, as a share of those above black, that may be mistakes."""

_Bytes = npt.NDArray[np.uint8]


def brightest(colours: npt.NDArray[Any]) -> float:
    """Return the value of full brightness of colours: 1, 255 or 65535; see ``colours_to_bytes``."""
    if colours.dtype in (np.uint8, np.int8):
        return 255.0
    if colours.dtype == np.uint16:
        return _brightest_of_16_bits(colours)
    values = colours.astype(np.float64)
    finite = np.isfinite(values).all(axis=1)
    return _largest_of_scale(values[finite], bool(np.issubdtype(colours.dtype, np.integer)))


def colours_to_bytes(colours: npt.NDArray[Any], full: float | None = None) -> _Bytes:
    """Return colours of any usual scale as bytes.

    The array's type and most of its values tell the scale, so that a few values beyond it do not:

    - floating point: 0..1, bytes, or 0..65535;
    - integers: bytes (also in a wider type), or 0..65535. A signed byte has the bits of a byte.

    Values outside the scale are clipped to it; colours that are not finite become ``NEUTRAL``.

    Parameters
    ----------
    colours
        Shape (n, 3), any real type.
    full
        The value of full brightness, if it is known; see :func:`brightest`. None: as above.

    Returns
    -------
    ndarray
        Shape (n, 3), uint8.
    """
    if colours.dtype in (np.uint8, np.int8):
        return np.ascontiguousarray(colours).view(np.uint8)
    if colours.dtype == np.uint16:
        full = full or _brightest_of_16_bits(colours)
        table = np.rint(np.minimum(np.arange(1 << 16) * (255.0 / full), 255.0)).astype(np.uint8)
        return table[colours]
    values = colours.astype(np.float64)
    finite: npt.NDArray[np.bool_] = np.all(np.isfinite(values), axis=1)
    values[~finite] = 0.0
    full = full or _largest_of_scale(values, bool(np.issubdtype(colours.dtype, np.integer)))
    values = np.clip(values * (255.0 / full), 0.0, 255.0)
    values[~finite] = NEUTRAL
    return np.rint(values).astype(np.uint8)


def _brightest_of_16_bits(colours: npt.NDArray[np.uint16]) -> float:
    """Return the value of full brightness, 255 or 65535, by the counts of all values."""
    flat = colours.reshape(-1)
    counts = np.zeros(1 << 16, np.int64)
    for start in range(0, len(flat), PIECE):
        counts += np.bincount(flat[start : start + PIECE], minlength=1 << 16)
    counts[0] = 0
    largest = int(np.flatnonzero(counts)[-1]) if counts.any() else 0
    mostly_bytes = int(counts[257:].sum()) < OUTLIERS * int(counts.sum())
    return 255.0 if largest <= 255 or mostly_bytes else 65535.0


def _largest_of_scale(values: npt.NDArray[np.float64], whole: bool) -> float:
    """Return 1, 255 or 65535: the value of full brightness.

    Black is black in every scale, so only values above 0 count. A dark picture of 0..65535 may have
    most of its values below 256, but not nearly all of them. Values between 0 and 1 are rare among
    bytes.
    """
    bright = values[values > 0.0]
    largest = float(bright.max()) if bright.size else 0.0
    if largest <= 1.0:
        return 255.0 if whole else 1.0
    if not whole:
        fractions = np.count_nonzero(bright < 1.0)
        ones = np.count_nonzero(bright == 1.0)
        if 2 * fractions > bright.size or (largest <= 2.0 and 2 * (fractions + ones) > bright.size):
            return 1.0
    if largest <= 255.0 or np.count_nonzero(bright > 256.0) < OUTLIERS * bright.size:
        return 255.0
    return 65535.0


def unpack_colours(packed: npt.NDArray[Any]) -> _Bytes:
    """Return red, green and blue of packed colours: 0xRRGGBB as integers or in floats' bits.

    Double precision holds the integers if all of its values are whole, else the floats.
    """
    packed = np.ascontiguousarray(packed)
    if packed.dtype == np.float64:
        known = packed[np.isfinite(packed)]
        if np.all(np.trunc(known) == known) and np.all(np.abs(known) < 2.0**32):
            packed = np.where(np.isfinite(packed), packed, 0.0).astype(np.int64)
        else:
            packed = packed.astype(np.float32)
    if packed.dtype.kind == "f" and packed.dtype.itemsize == 4:
        bits = packed.astype(np.float32).view(np.uint32)
    elif packed.dtype.kind in "iu" and packed.dtype.itemsize >= 4:
        bits = packed.astype(np.uint32)
    else:
        raise InputError(f"packs its colours in {packed.dtype}; use 32 bits")
    return np.stack([bits >> 16 & 255, bits >> 8 & 255, bits & 255], axis=-1).astype(np.uint8)


def harmonics_to_bytes(constant: npt.NDArray[Any]) -> _Bytes:
    """Return the colours of Gaussian splats, whose files hold the constant harmonic's factors."""
    values = 0.5 + HARMONIC * constant.astype(np.float64)
    finite = np.isfinite(values).all(axis=1)
    values[~finite] = 0.0
    values = 255.0 * np.clip(values, 0.0, 1.0)
    values[~finite] = NEUTRAL
    return np.rint(values).astype(np.uint8)


def are_known(values: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Return which values are finite, and not those that stand for no value, such as 1e308."""
    known: npt.NDArray[np.bool_] = np.isfinite(values) & (np.abs(values) < LARGEST)
    return known


def robust_range(values: npt.NDArray[np.float64]) -> tuple[float, float] | None:
    """Return the range of 98 % of finite values, or of all if those are one; None without any."""
    if not values.size:
        return None
    low, high = np.percentile(values, (1.0, 99.0))
    if low == high:
        low, high = values.min(), values.max()
    return float(low), float(high)


def greys(intensity: npt.NDArray[Any], ends: tuple[float, float] | None = None) -> _Bytes:
    """Return greys of an intensity: dark for the least, light for the greatest of 98 % of them.

    ``ends`` are other values for the darkest and the lightest grey. Points without a finite
    intensity are ``NEUTRAL``, and so are all if there is only one value.
    """
    values = intensity.astype(np.float64)
    known = are_known(values)
    grey = np.tile(np.array(NEUTRAL, np.uint8), (len(values), 1))
    low, high = ends or robust_range(values[known]) or (0.0, 0.0)
    if low == high:
        return grey
    share = np.clip((values[known] - low) / (high - low), 0.0, 1.0)
    level = np.rint(DARKEST + share * (LIGHTEST - DARKEST)).astype(np.uint8)
    grey[known] = level[:, np.newaxis]
    return grey
