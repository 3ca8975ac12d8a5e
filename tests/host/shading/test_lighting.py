import math

import pytest

from splatline.contract.errors import InputError
from splatline.host.shading.lighting import Light, Lighting


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Light((0, 0, 0), 1.0), "direction"),
        (lambda: Light((math.nan, 0, 1), 1.0), "direction"),
        (lambda: Light((0, 0, -1), -0.1), "intensity"),
        (lambda: Lighting(gloss=-1), "gloss"),
        (lambda: Lighting(gloss=1.5), "gloss"),
        (lambda: Lighting(ambient=math.inf), "ambient"),
        (lambda: Lighting(shininess=0.0), "shininess"),
    ],
)
def test_what_cannot_be_lit_is_named(make, message):
    with pytest.raises(InputError, match=message):
        make()
