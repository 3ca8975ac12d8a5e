"""Colours as files write them, turned into bytes."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["NEUTRAL", "colours_to_bytes"]

NEUTRAL = (214, 164, 124)
"""Colour of points that have none: clay. With three bits a channel its channels change level one
after the other, so it shows finer shades than a grey does, and all of them are warm; a paler tint
would come out as bands of several hues."""


def colours_to_bytes(colours: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
    """Return colours of any usual scale as bytes.

    The array's type and its largest finite value tell the scale:

    - floating point: up to 1 is 0..1, up to 255 is bytes, above is 0..65535;
    - integers: up to 255 is bytes (also in a wider type), above is 0..65535.

    Values outside the scale are clipped to it; colours that are not finite become ``NEUTRAL``.

    Parameters
    ----------
    colours
        Shape (n, 3), any real type.

    Returns
    -------
    ndarray
        Shape (n, 3), uint8.
    """
    if colours.dtype == np.uint8:
        return np.ascontiguousarray(colours)
    values = colours.astype(np.float64)
    finite: npt.NDArray[np.bool_] = np.all(np.isfinite(values), axis=1)
    largest = float(values[finite].max()) if finite.any() else 0.0
    if largest <= 1.0 and not np.issubdtype(colours.dtype, np.integer):
        scale = 255.0
    else:
        scale = 1.0 if largest <= 255.0 else 255.0 / 65535.0
    values = np.where(finite[:, np.newaxis], values * scale, NEUTRAL)
    return np.rint(np.clip(values, 0.0, 255.0)).astype(np.uint8)
