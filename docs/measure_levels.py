"""Measure the errors of normals quantised to 64 levels of n'x and n'y, by spacing of the levels.

Run as ``.venv/bin/python docs/measure_levels.py``. Normals are uniform over the hemisphere that the
eye sees. Ellipses have random sub-pixel positions, and lights are the default ones. It prints a
table of the pixels that the quantised ellipse covers wrongly, as a share of the true ellipse's
pixels, and of the RMS errors of D and S, as shares of full scale.
"""

import numpy as np

from splatline.host.shading.lighting import Lighting

LEVELS = 64
COUNT = 40_000


def spread(power):
    """Return n' -> n' / (1 + |n'|^p)^(1/p), in which levels are even, and the inverse map."""
    return (
        lambda s: s / (1 + np.abs(s) ** power) ** (1 / power),
        lambda u: u / (1 - np.abs(u) ** power) ** (1 / power),
    )


SPREADS = {
    "even in n' over +-4": (lambda s: np.clip(s / 4, -1, 1), lambda u: 4 * u),
    "even in angle": (lambda s: 2 / np.pi * np.arctan(s), lambda u: np.tan(u * np.pi / 2)),
    **{f"even in n' / (1 + |n'|^{p:g})^(1/{p:g})": spread(p) for p in (0.75, 1.0, 1.5, 2.0)},
}


def quantised(slopes, there, back):
    """Return slopes rounded to the centre of their level."""
    level = np.clip(np.floor((there(slopes) + 1) * LEVELS / 2), 0, LEVELS - 1)
    return back((level + 0.5) * 2 / LEVELS - 1)


def covered(slopes, radius, positions):
    """Return which of 17 x 17 pixels each ellipse covers."""
    offset = np.arange(-8, 9)
    dx = offset[None, None, :] + positions[0][:, None, None]
    dy = offset[None, :, None] + positions[1][:, None, None]
    across = slopes[:, :1, None] * dx + slopes[:, 1:, None] * dy
    return dx * dx + dy * dy + across * across <= radius[:, None, None] ** 2


def shaded(slopes, lighting):
    """Return D and S of surfaces without quantisation."""
    normal = -np.concatenate([slopes, np.ones((len(slopes), 1))], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    diffuse, specular = np.full(len(slopes), lighting.ambient), np.zeros(len(slopes))
    for light in lighting.lights:
        towards = np.array(light.direction) / np.linalg.norm(light.direction)
        cosine = np.maximum(normal @ towards, 0)
        diffuse += light.intensity * cosine
        glance = np.maximum(towards[2] - 2 * cosine * normal[:, 2], 0) * (cosine > 0)
        specular += light.intensity * glance**lighting.shininess
    return np.clip(diffuse, 0, 1), np.clip(specular, 0, 1)


def main():
    """Measure and print."""
    rng = np.random.default_rng(1)
    normal = rng.normal(size=(COUNT, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    slopes = normal[:, :2] / np.maximum(np.abs(normal[:, 2:]), 1e-6)
    radius, positions = rng.uniform(1, 4, COUNT), rng.uniform(-0.5, 0.5, (2, COUNT))
    true, light = covered(slopes, radius, positions), shaded(slopes, Lighting())
    print("| levels | wrong pixels | D | S |")
    print("|---|---:|---:|---:|")
    for name, (there, back) in SPREADS.items():
        ours = quantised(slopes, there, back)
        wrong = (covered(ours, radius, positions) != true).sum() / true.sum()
        errors = [
            np.sqrt(np.mean((a - b) ** 2))
            for a, b in zip(shaded(ours, Lighting()), light, strict=True)
        ]
        print(f"| {name} | {wrong:.2%} | {errors[0]:.4f} | {errors[1]:.4f} |")


if __name__ == "__main__":
    main()
