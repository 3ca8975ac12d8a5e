"""Lights with a name."""

from __future__ import annotations

from .lighting import Light, Lighting

__all__ = ["DEFAULT_LIGHTS", "LIGHTS"]

LIGHTS = {
    "studio": Lighting(),
    "front": Lighting(lights=(Light((0.0, -0.2, -1.0), 0.8),), ambient=0.2, gloss=0.1),
    "side": Lighting(lights=(Light((-1.0, -0.3, -0.25), 0.95),), ambient=0.08, gloss=0.2),
    "matte": Lighting(gloss=0.0),
    "none": Lighting(lights=(), ambient=1.0, gloss=0.0),
}
"""``studio``: from above left, with a fill light from the right. ``front``: from the eye.
``side``: grazing, which shows relief. ``matte``: as studio, without highlights. ``none``: the
points' own colours, as they are."""

DEFAULT_LIGHTS = "studio"
"""The lights of every command."""
