"""The true surface, rendered without points."""

import numpy as np
import pytest

from splatline.host.scenes.knot import BALL, _ball, knot_patches
from splatline.host.scenes.patches import Patch, sample
from splatline.host.scenes.scenes import load_scene
from splatline.host.scenes.terrain import terrain_patches
from splatline.host.shading.lighting import Lighting
from splatline.host.visibility.view import View, fit_view
from splatline.sim.reference.true_surface import render_surface

AXES = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])


def facing(distance, focal=100.0, size=64):
    return View(np.array([0.0, 0.0, distance]), AXES, focal, size, size, 1e-3)


def test_a_ball_has_its_outline_and_depth():
    view = facing(3.0)
    truth = render_surface([Patch(1.0, _ball)], np.zeros(3), view, Lighting(), samples=4)
    # The outline of a sphere of radius r at the distance d is a circle of radius
    # f r / sqrt(d^2 - r^2).
    area = np.pi * (100.0 * BALL) ** 2 / (9.0 - BALL**2)
    assert truth.coverage.sum() == pytest.approx(area, rel=2e-3)
    assert truth.depth[31:33, 31:33] == pytest.approx(3.0 - BALL, abs=1e-3)
    across = (np.arange(64) + 0.5 - 32.0) / 100.0
    # A ray (x, 0, 1) t meets the sphere where t^2 (1 + x^2) - 2 t d + d^2 = r^2.
    square = 1.0 + across**2
    inside = np.abs(across) < 0.12
    depth = (3.0 - np.sqrt(9.0 - square * (9.0 - BALL**2), where=inside, out=0 * square)) / square
    assert truth.depth[32][inside] == pytest.approx(depth[inside], abs=1e-3)


def test_a_nearer_patch_hides_another():
    def plane(depth, colour):
        def at(a, b):
            positions = np.stack([2.0 * a - 1.0, 2.0 * b - 1.0, np.full_like(a, depth)], axis=-1)
            normals = np.tile([0.0, 0.0, 1.0], (len(a), 1))
            return positions, normals, np.tile(np.array(colour, np.uint8), (len(a), 1))

        return Patch(4.0, at)

    flat = Lighting(ambient=1.0, lights=(), gloss=0.0)
    patches = [plane(0.0, (255, 0, 0)), plane(0.5, (0, 255, 0))]
    truth = render_surface(patches, np.zeros(3), facing(4.0), flat, background=(0.0, 0.0, 1.0))
    assert truth.rgb[32, 32] == pytest.approx([0.0, 1.0, 0.0])
    assert truth.depth[32, 32] == pytest.approx(3.5)
    assert truth.rgb[0, 0] == pytest.approx([0.0, 0.0, 1.0])
    assert truth.coverage[0, 0] == 0.0 and np.isnan(truth.depth[0, 0])
    # From column 32 - 100 / 3.5 to 32 + 100 / 3.5.
    assert truth.coverage.sum() == pytest.approx((2 * 100 / 3.5) ** 2, rel=5e-3)


def test_the_normals_of_a_shape_are_its_own():
    """A ball's patch has the shape's normals; with others the picture is the same."""
    lights, view = Lighting(), facing(3.0)

    def smoothed(a, b):
        positions, normals, colours = _ball(a, b)
        return positions, normals + 0.3 * np.array([0.0, 0.0, 1.0]), colours

    true = render_surface([Patch(1.0, _ball)], np.zeros(3), view, lights)
    shape = [
        render_surface([Patch(1.0, at)], np.zeros(3), view, lights, shape_normals=True)
        for at in (_ball, smoothed)
    ]
    for each in shape:
        np.testing.assert_allclose(each.rgb, true.rgb, atol=2e-3)
    assert (
        np.abs(
            shape[1].rgb - render_surface([Patch(1.0, smoothed)], np.zeros(3), view, lights).rgb
        ).max()
        > 0.02
    )


def test_what_reaches_the_eye_is_refused():
    with pytest.raises(ValueError, match="near plane"):
        render_surface([Patch(1.0, _ball)], np.zeros(3), facing(0.2), Lighting())


@pytest.mark.parametrize(
    ("name", "patches"), [("knot", knot_patches), ("terrain", terrain_patches)]
)
def test_a_scenes_points_lie_on_its_patches(name, patches):
    scene = load_scene(name)
    camera = {key: getattr(scene, key) for key in ("orbit", "fov", "up", "zoom")}
    view = fit_view(scene.cloud, size=(128, 128), **camera)
    truth = render_surface(patches(), scene.cloud.origin, view, Lighting(), samples=2)
    x, y, z = ((scene.cloud.positions - view.eye) @ view.axes.T).T
    column = np.floor(64 + view.focal * x / z).astype(int)
    line = np.floor(64 + view.focal * y / z).astype(int)
    nearest = np.full((128, 128), np.inf)
    np.minimum.at(nearest, (line, column), z)
    whole = truth.coverage == 1.0
    apart = np.abs(nearest - truth.depth)[whole] / np.ptp(z)
    assert np.median(apart) < 0.01
    assert whole.mean() > 0.3


def test_points_at_random_are_as_many_and_as_even_by_area():
    even, random = (sample(knot_patches(), 20_000, "test", seed) for seed in (None, 1))
    assert len(even) == len(random) == 20_000
    assert np.array_equal(random.positions, sample(knot_patches(), 20_000, "test", 1).positions)
    assert even.positions.std(axis=0) == pytest.approx(random.positions.std(axis=0), rel=0.03)
