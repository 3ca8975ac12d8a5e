"""The lights and how a surface answers them: parameters alone, no computation."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Light", "Lighting"]


@dataclass(frozen=True)
class Light:
    """A directional light.

    Parameters
    ----------
    direction
        Towards the light, in camera axes (right, down, forward); any length above 0. Lights go
        with the camera, so that every view is lit.
    intensity
        Share of the material's colour that a surface facing the light gives back.
    """

    direction: tuple[float, float, float]
    intensity: float


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
