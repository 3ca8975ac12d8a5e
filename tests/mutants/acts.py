"""The acts of a design's fast bench."""

from functools import cache

from .axi_acts import axi_acts
from .engine_acts import engine_acts
from .program import Act
from .tops import Design

__all__ = ["acts_of"]


@cache
def acts_of(design: Design) -> list[Act]:
    """Return the acts of a design."""
    return {"engine": engine_acts, "axi": axi_acts}[design.top](design.config)
