"""Deals the parts of a parallel loop out to threads.

A parallel loop of numba gives each thread a run of turns that follow each other. Parts that lie
together in space often take more work than others. Dealt out in turn, each thread gets some of
every region.
"""

from __future__ import annotations

import numba as nb
import numpy as np
import numpy.typing as npt

__all__ = ["deal"]


def deal(parts: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return parts in an order in which the first thread gets every T-th of them, and so on.

    Parameters
    ----------
    parts
        Their numbers: shape (n,), int64.

    Returns
    -------
    numpy.ndarray
        The same numbers. T is the number of threads.
    """
    threads = nb.get_num_threads()
    return np.concatenate([parts[thread::threads] for thread in range(threads)])
