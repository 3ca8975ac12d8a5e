"""Parameters of the lights and of the surface."""

from __future__ import annotations

import math
from dataclasses import dataclass

from splatline.contract.errors import InputError

__all__ = ["Light", "Lighting"]


@dataclass(frozen=True)
class Light:
    """A directional light.

    Parameters
    ----------
    direction
        Towards the light, in camera axes (right, down, forward); any length above 0. Lights
        move with the camera, so every view is lit.
    intensity
        Share of the material's colour that a surface facing the light reflects.
    """

    direction: tuple[float, float, float]
    intensity: float

    def __post_init__(self) -> None:
        """Raise ``InputError`` if the light has no direction or a bad intensity."""
        length = math.hypot(*self.direction)
        if not (math.isfinite(length) and length > 0.0):
            raise InputError(f"a light needs a direction, not {self.direction}")
        if not 0.0 <= self.intensity < math.inf:
            raise InputError(f"a light's intensity must be 0 or more, not {self.intensity:g}")


@dataclass(frozen=True)
class Lighting:
    """Phong's model, with white lights (the paper's equation 2).

    A surface of base colour c shows, per channel and clipped to 0..1,
    ``c (ambient + sum intensity max(0, n.l)) + gloss sum intensity max(0, r.v)^shininess``
    with n the normal, l the light, r its mirror image in n and v the direction to the eye.
    A light behind the surface (n.l <= 0) gives no highlight. Diffuse and specular intensity are
    each clipped to 0..1 first.
    """

    lights: tuple[Light, ...] = (
        Light((-0.5, -0.7, -0.6), 0.75),
        Light((0.8, 0.2, -0.5), 0.15),
    )
    ambient: float = 0.15
    gloss: float = 0.25
    shininess: float = 12.0

    def __post_init__(self) -> None:
        """Raise ``InputError`` if the engine's tables cannot hold the values."""
        if not 0.0 <= self.gloss <= 1.0:
            raise InputError(f"the gloss must lie in 0..1, not {self.gloss:g}")
        if not 0.0 <= self.ambient < math.inf:
            raise InputError(f"the ambient light must be 0 or more, not {self.ambient:g}")
        if not 0.0 < self.shininess < math.inf:
            raise InputError(f"the shininess must be above 0, not {self.shininess:g}")
