"""The order in which chunks of splats are encoded."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from splatline.host.deal import deal

__all__ = ["waves_of"]

WAVES = 4
"""Parts of the work if hidden splats are left out: each knows what the ones before it hide."""


def waves_of(nearest: npt.NDArray[np.float64], skip_hidden: bool) -> list[npt.NDArray[np.int64]]:
    """Return the chunks in waves, each dealt out to threads.

    Parameters
    ----------
    nearest
        Least depth of each chunk: shape (chunks,), float64. Chunks that may hide others go first.
    skip_hidden
        Whether hidden splats are left out; if not, there is one wave.
    """
    if not skip_hidden:
        return [deal(np.arange(len(nearest)))]
    return [deal(wave) for wave in np.array_split(np.argsort(nearest, kind="stable"), WAVES)]
