"""Points of the clouds that have goals."""

from __future__ import annotations

__all__ = ["LARGE", "MEDIUM"]

MEDIUM = 436_000
"""A figure from a scanner."""

LARGE = 4_000_000
"""A dense scan."""
