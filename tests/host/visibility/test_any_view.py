"""Views of any numbers: each gives frames that golden draws, or one line of error."""

import warnings
from collections import Counter

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.presets import PAPER
from splatline.host.cloud.cloud import Cloud
from splatline.host.pipeline import make_frames
from splatline.host.visibility.block_index import build_index
from splatline.host.visibility.view import UP_AXES, View, fit_view
from splatline.sim import golden

COUNT = 2_000
"""Views; with 10,000 the same holds."""

ODD = (np.nan, np.inf, -np.inf, 0.0, -0.0, 1e-300, 1e300, -1e300, 5e-324, 1e-9, 1e9, -1.0)
SIZES = (-1, 0, 1, 2, 3, 17, 64, 512, 513)


def small_cloud():
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(40, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Cloud(
        rng.normal(size=(40, 3)),
        normals.astype(np.float32),
        rng.integers(0, 256, (40, 3)).astype(np.uint8),
        np.zeros(40, np.bool_),
        np.zeros(3),
        "small",
        {},
    )


def odd_or(rng, usual, share=0.25):
    return float(rng.choice(ODD)) if rng.random() < share else float(rng.uniform(*usual))


def fitted(rng, cloud):
    """Return a view as of a user's options."""
    return fit_view(
        cloud,
        orbit=(odd_or(rng, (-400, 400)), odd_or(rng, (-100, 100))),
        fov=odd_or(rng, (0, 190)),
        size=tuple(int(n) for n in rng.choice(SIZES, 2)),
        up=str(rng.choice([*UP_AXES, "w"], p=[0.16] * 6 + [0.04])),
        zoom=odd_or(rng, (0.01, 30)),
    )


def plain(rng, _):
    """Return a view of any numbers, whose axes may be no rotation."""
    axes = np.array([[odd_or(rng, (-1, 1), 0.05) for _ in range(3)] for _ in range(3)])
    if rng.random() < 0.5:
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return View(
        np.array([odd_or(rng, (-5, 5), 0.1) for _ in range(3)]),
        axes,
        odd_or(rng, (1, 1000), 0.1),
        *(int(n) for n in rng.choice(SIZES[2:], 2)),
        odd_or(rng, (0.01, 1), 0.1),
        (odd_or(rng, (-9, 9), 0.1), 0.0),
    )


@pytest.mark.parametrize("make", [fitted, plain], ids=lambda make: make.__name__)
def test_any_view_is_drawn_or_refused(make):
    rng = np.random.default_rng(7)
    cloud = small_cloud()
    index = build_index(cloud, radii=np.full(40, 0.2))
    outcomes = Counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for _ in range(COUNT // 2):
            try:
                (frame,) = make_frames(index, make(rng, cloud), config=PAPER)
            except InputError as error:
                assert "\n" not in str(error)
                outcomes[str(error).split(",")[0][:40]] += 1
                continue
            golden.render(frame)
            outcomes["drawn"] += 1
    assert outcomes["drawn"] > COUNT / 100
    assert outcomes.total() - outcomes["drawn"] > COUNT / 100
