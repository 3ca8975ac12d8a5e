"""Memory that a cloud takes, by its points: known before anything of it is read."""

from __future__ import annotations

__all__ = ["FIXED_BYTES", "POINT_BYTES"]

POINT_BYTES = 250
"""Most memory that a point takes of a cloud that is read at once."""

FIXED_BYTES = 500 << 20
"""Memory that is taken whatever the cloud: programs, a piece of a file, and pictures."""
