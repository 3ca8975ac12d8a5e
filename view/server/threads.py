"""Which library runs compiled loops in parallel."""

from __future__ import annotations

import os

import numba

__all__ = ["prefer_openmp"]


def prefer_openmp() -> None:
    """Let OpenMP run parallel loops, unless the environment says otherwise.

    To be called before the first such loop. On a machine with other work OpenMP draws a picture in
    two thirds of TBB's time, and a process ends in a tenth of it (decision 0084). The pictures are
    the same.
    """
    if not any(name.startswith("NUMBA_THREADING_LAYER") for name in os.environ):
        numba.config.THREADING_LAYER_PRIORITY = ["omp", "tbb", "workqueue"]
