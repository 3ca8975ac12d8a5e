import math

import numpy as np

from splatline.host.lighting import Light, Lighting
from splatline.host.shade import shade_tables
from splatline.host.shapes import level_slopes


def test_tables_are_phong_s_model_at_each_level():
    lighting = Lighting(
        (Light((0.3, -0.4, -2.0), 0.6), Light((-1.0, 0.0, -0.2), 0.3)), 0.1, 0.5, 9.0
    )
    diffuse, specular = shade_tables(lighting, 7)
    slopes = level_slopes()
    for x in range(0, 64, 5):
        for y in range(0, 64, 7):
            length = math.sqrt(slopes[x] ** 2 + slopes[y] ** 2 + 1)
            n = [-slopes[x] / length, -slopes[y] / length, -1 / length]
            d, s = lighting.ambient, 0.0
            for light in lighting.lights:
                size = math.sqrt(sum(c * c for c in light.direction))
                towards = [c / size for c in light.direction]
                cosine = sum(a * b for a, b in zip(n, towards, strict=True))
                if cosine > 0:
                    d += light.intensity * cosine
                    reflected_z = 2 * cosine * n[2] - towards[2]
                    s += light.intensity * max(-reflected_z, 0) ** lighting.shininess
            assert abs(diffuse[64 * x + y] - 127 * min(d, 1)) <= 0.5
            assert abs(specular[64 * x + y] - 127 * min(s, 1)) <= 0.5


def test_bright_lights_saturate_and_no_light_leaves_the_ambient():
    blinding = Lighting(tuple(Light((0, 0, -1), 5.0) for _ in range(3)), 0.2)
    diffuse, specular = shade_tables(blinding, 7)
    assert diffuse.max() == specular.max() == 127
    dark_diffuse, dark_specular = shade_tables(Lighting((), 0.2), 7)
    assert np.unique(dark_diffuse).tolist() == [round(0.2 * 127)]
    assert not dark_specular.any()
