"""Numba's import without the linear algebra that it takes from scipy."""

from __future__ import annotations

import sys

__all__ = ["import_numba"]

BLAS = "scipy.linalg"
"""Numba loads it for functions that multiply matrices. No compiled function here does."""


def import_numba() -> None:
    """Import numba as if ``scipy.linalg`` were missing: a sixth of the time of a command's imports.

    Other modules import it afterwards as ever. It does nothing if either is loaded already.
    """
    if "numba" in sys.modules or BLAS in sys.modules:
        return
    sys.modules[BLAS] = None  # type: ignore[assignment]  # an import of it fails
    try:
        import numba.np.arraymath  # noqa: F401  # which asks for it
    finally:
        del sys.modules[BLAS]
