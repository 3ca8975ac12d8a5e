import math

import numba
import numpy as np
import pytest

from splatline.host.cloud.cloud import Cloud
from splatline.host.shading.lighting import Light, Lighting
from splatline.host.visibility.view import View
from splatline.sim import reference

FLAT = Lighting(lights=(), ambient=1.0, gloss=0.0)
"""Everything shows its own colour."""

TURN = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]


def make_cloud(positions, normals, colours=None, two_sided=None):
    positions = np.atleast_2d(np.asarray(positions, np.float64))
    count = len(positions)
    normals = np.broadcast_to(np.asarray(normals, np.float32), (count, 3))
    if colours is None:
        colours = np.full((count, 3), 255)
    colours = np.broadcast_to(np.asarray(colours, np.uint8), (count, 3))
    if two_sided is None:
        two_sided = np.zeros(count, bool)
    two_sided = np.broadcast_to(np.asarray(two_sided, bool), (count,))
    return Cloud(positions, normals, colours, two_sided, np.zeros(3), "test", {})


def make_view(width=24, height=20, focal=30.0, near=0.1, eye=(0.0, 0.0, 0.0), axes=None):
    axes = np.eye(3) if axes is None else axes
    return View(np.asarray(eye, np.float64), axes, focal, width, height, near)


def trace(cloud, view, radii, samples):
    """Every ray against every disc, as a linear system: depth and number of the nearest, or -1."""
    lines, columns = view.height * samples, view.width * samples
    depth = np.full((lines, columns), np.inf)
    seen = np.full((lines, columns), -1)
    y, x = np.mgrid[:lines, :columns] + 0.5
    rays = np.stack([x / samples - view.width / 2, y / samples - view.height / 2], axis=-1)
    rays = np.concatenate([rays / view.focal, np.ones((lines, columns, 1))], axis=-1)
    for i in range(len(cloud)):
        p = view.axes @ (cloud.positions[i] - view.eye)
        n = view.axes @ cloud.normals[i].astype(np.float64)
        if n @ p >= 0 and not cloud.two_sided[i]:
            continue
        # ray t - u a - v b = p, with u and v spanning the disc
        u = np.cross(n, [1.0, 0.0, 0.0] if abs(n[0]) < 0.7 else [0.0, 1.0, 0.0])
        u /= np.linalg.norm(u)
        v = np.cross(n, u) / np.linalg.norm(n)
        system = np.empty((lines, columns, 3, 3))
        system[..., 0], system[..., 1], system[..., 2] = rays, -u, -v
        t, a, b = np.moveaxis(np.linalg.solve(system, np.broadcast_to(p, rays.shape)[..., None])
                              [..., 0], -1, 0)  # fmt: skip
        hit = (a * a + b * b <= radii[i] ** 2) & (t >= view.near) & (t < depth)
        depth[hit], seen[hit] = t[hit], i
    return depth, seen


def expect(cloud, view, radii, samples, background):
    """The picture of discs that show their own colour, from ``trace``."""
    depth, seen = trace(cloud, view, radii, samples)
    rgb = np.vstack([cloud.colours / 255.0, background])[seen]
    met = seen >= 0

    def pool(values):
        shape = (view.height, samples, view.width, samples, *values.shape[2:])
        return values.reshape(shape).sum(axis=(1, 3))

    counts = pool(met.astype(float))
    total = pool(np.where(met, depth, 0.0))
    mean = np.full(counts.shape, np.nan)
    mean[counts > 0] = total[counts > 0] / counts[counts > 0]
    return pool(rgb) / samples**2, mean, counts / samples**2


def random_cloud(rng, count, two_sided=0.3):
    positions = np.stack(
        [rng.uniform(-2.5, 2.5, count), rng.uniform(-2.5, 2.5, count), rng.uniform(-1, 6, count)],
        axis=1,
    )
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    colours = rng.integers(0, 256, (count, 3))
    return make_cloud(positions, normals, colours, rng.random(count) < two_sided)


@pytest.mark.parametrize("samples", [1, 2, 3])
@pytest.mark.parametrize("case", range(6))
def test_the_picture_is_that_of_rays_traced_one_by_one(case, samples):
    rng = np.random.default_rng([case, samples])
    cloud = random_cloud(rng, 25)
    # From small discs to such that cross the near plane and fill the image; more than two bands.
    radii = rng.uniform(0.01, 1.5, 25)
    view = make_view(18, 37, focal=rng.uniform(8, 40), near=0.3, eye=(0.2, -0.1, 0.0))
    background = (0.1, 0.2, 0.3)
    picture = reference.render(cloud, view, radii, FLAT, background=background, samples=samples)
    rgb, depth, coverage = expect(cloud, view, radii, samples, background)
    assert coverage.any()
    np.testing.assert_array_equal(picture.coverage, coverage)
    np.testing.assert_allclose(picture.depth, depth, rtol=1e-9)
    np.testing.assert_allclose(picture.rgb, rgb, atol=1e-12)


@pytest.mark.parametrize("quarter", range(4))
def test_a_disc_that_crosses_the_near_plane_is_cut_there(quarter):
    # A floor that begins behind the eye, and the same as a ceiling and as walls.
    turn = np.linalg.matrix_power(np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0, 0, 1]]), quarter)
    normal = turn @ [0.0, -1.0, -0.2] / math.hypot(1.0, 0.2)
    cloud, radii = make_cloud(turn @ [0.0, 1.0, 0.5], normal), np.array([4.0])
    view = make_view(24, 24, focal=6.0, near=0.8)
    picture = reference.render(cloud, view, radii, FLAT, samples=2)
    _, depth, coverage = expect(cloud, view, radii, 2, (1.0, 1.0, 1.0))
    np.testing.assert_array_equal(picture.coverage, coverage)
    assert 0.1 < picture.coverage.mean() < 0.5
    assert 0.8 <= np.nanmin(picture.depth) < 1.0
    np.testing.assert_allclose(picture.depth, depth)


def test_a_disc_is_bounded_tightly():
    rng = np.random.default_rng(12)
    turns = np.linspace(0.0, 2.0 * np.pi, 2000)
    for _ in range(50):
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        centre = np.array([rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(2, 9)])
        radius = rng.uniform(0.01, 1.9)
        across = np.cross(normal, [0.3, -0.5, 0.8])
        across /= np.linalg.norm(across)
        rim = np.outer(np.cos(turns), across) + np.outer(np.sin(turns), np.cross(normal, across))
        rim = centre + radius * rim
        for axis in range(2):
            slopes = rim[:, axis] / rim[:, 2]
            bounds = reference.bound_disc(centre, normal, radius, axis)
            spread = np.ptp(slopes)
            np.testing.assert_allclose(bounds, [slopes.min(), slopes.max()], atol=1e-4 * spread)


def test_a_disc_that_faces_the_eye_has_the_area_of_a_circle():
    cloud, view = make_cloud([0.0, 0.0, 10.0], [0.0, 0.0, -1.0]), make_view(focal=100.0)
    picture = reference.render(cloud, view, [0.8], FLAT, samples=16)
    assert picture.coverage.sum() == pytest.approx(math.pi * 8.0**2, rel=2e-3)
    assert picture.depth[10, 12] == pytest.approx(10.0)


def test_a_tilted_disc_has_a_sloped_depth():
    normal = np.array([0.6, 0.0, -0.8])
    view = make_view(focal=50.0)
    picture = reference.render(make_cloud([0, 0, 5.0], normal), view, [3.0], FLAT, samples=1)
    x = (np.arange(24) + 0.5 - 12) / 50.0
    np.testing.assert_allclose(picture.depth[10], (-0.8 * 5.0) / (0.6 * x - 0.8))


def test_the_middle_of_the_image_is_where_the_view_says():
    # A tiny disc a little right of and below the axis: the pixel whose corner is the middle.
    view = make_view(focal=30.0, axes=TURN, eye=(4.0, 5.0, -6.0))
    position = view.eye + np.array([0.5 / 30.0, 0.5 / 30.0, 1.0]) * 8.0 @ TURN
    cloud = make_cloud(position, -TURN[2])
    picture = reference.render(cloud, view, [0.01], FLAT, samples=1)
    assert np.argwhere(picture.coverage).tolist() == [[10, 12]]
    assert picture.depth[10, 12] == pytest.approx(8.0)


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_the_nearer_of_two_discs_is_seen(order):
    colours = np.array([[255, 0, 0], [0, 255, 0]])
    positions = np.array([[0.0, 0.0, 5.0], [0.0, 0.0, 4.0]])
    cloud = make_cloud(positions[order], [0, 0, -1.0], colours[order])
    picture = reference.render(cloud, make_view(), [9.0, 9.0], FLAT)
    assert picture.rgb[5, 5].tolist() == [0.0, 1.0, 0.0]


def test_of_equally_near_discs_the_first_is_seen():
    cloud = make_cloud([[0, 0, 5.0], [0, 0, 5.0]], [0, 0, -1.0], [[255, 0, 0], [0, 255, 0]])
    picture = reference.render(cloud, make_view(), [9.0, 9.0], FLAT)
    assert picture.rgb[5, 5].tolist() == [1.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("normal", "two_sided", "seen"),
    [
        ([0.0, 0.0, -1.0], False, True),
        ([0.0, 0.0, 1.0], False, False),
        ([0.0, 0.0, -1.0], True, True),
        ([0.0, 0.0, 1.0], True, True),
        ([0.0, 1.0, 0.0], True, False),  # edge-on
        ([0.0, 0.0, 0.0], False, False),
        ([0.0, 0.0, 0.0], True, False),
    ],
)
def test_discs_are_seen_from_their_front(normal, two_sided, seen):
    cloud = make_cloud([0, 0, 5.0], normal, two_sided=two_sided)
    picture = reference.render(cloud, make_view(), [1.0], FLAT)
    assert picture.coverage.any() == seen


def test_whether_a_disc_faces_away_depends_on_where_it_is():
    # The same normal, across the view: seen to the right of the eye, not to the left.
    cloud = make_cloud([[2.0, 0, 6.0], [-2.0, 0, 6.0]], [-1.0, 0.0, 0.0])
    picture = reference.render(cloud, make_view(), [1.0, 1.0], FLAT)
    assert picture.coverage[:, 12:].any()
    assert not picture.coverage[:, :12].any()


@pytest.mark.parametrize("z", [-5.0, 0.0, 0.05])
def test_a_disc_behind_the_near_plane_is_not_seen(z):
    cloud = make_cloud([0, 0, z], [0, 0, -1.0])
    assert not reference.render(cloud, make_view(), [0.01], FLAT).coverage.any()


def test_phong_gives_the_colour_that_the_formula_says():
    light = Light((0.0, -3.0, -4.0), 0.5)  # towards (0, -0.6, -0.8)
    lighting = Lighting(lights=(light,), ambient=0.2, gloss=0.3, shininess=2.0)
    cloud = make_cloud([0, 0, 5.0], [0, 0, -1.0], [[255, 0, 51]])
    picture = reference.render(cloud, make_view(), [9.0], lighting, samples=1)
    # n.l = 0.8, and the mirrored light (0, 0.6, -0.8) has 0.8 along the way to the eye.
    diffuse, gloss = 0.2 + 0.5 * 0.8, 0.3 * 0.5 * 0.8**2
    np.testing.assert_allclose(picture.rgb[3, 3], [diffuse + gloss, gloss, 0.2 * diffuse + gloss])


def test_the_highlight_follows_the_direction_to_the_eye():
    # Parallel to the image, but 45 degrees off its axis: on one side the light mirrors to the eye.
    lighting = Lighting(lights=(Light((1.0, 0.0, -1.0), 1.0),), ambient=0.0, gloss=1.0)
    view = make_view(200, 20, focal=80.0)
    for side, bright in ((5.0, True), (-5.0, False)):
        cloud = make_cloud([side, 0, 5.0], [0, 0, -1.0], [[0, 0, 0]])
        picture = reference.render(cloud, view, [0.5], lighting, background=(0, 0, 0), samples=1)
        assert picture.coverage.any()
        assert picture.rgb.max() == (pytest.approx(1.0) if bright else pytest.approx(0, abs=1e-6))


def test_a_light_behind_a_disc_gives_it_nothing():
    lighting = Lighting(lights=(Light((0.0, 0.0, 1.0), 1.0),), ambient=0.25, gloss=1.0, shininess=1)
    normal = np.array([0.8, 0.0, -0.6])
    picture = reference.render(make_cloud([0, 0, 5.0], normal), make_view(), [2.0], lighting)
    assert picture.rgb[10, 12].tolist() == [0.25] * 3


def test_intensities_are_clipped_before_the_colour():
    lights = (Light((0.0, 0.0, -1.0), 0.9), Light((0.0, 0.0, -1.0), 0.9))
    lighting = Lighting(lights=lights, ambient=0.5, gloss=0.25)
    cloud = make_cloud([0, 0, 5.0], [0, 0, -1.0], [[102, 0, 255]])
    picture = reference.render(cloud, make_view(), [9.0], lighting)
    np.testing.assert_allclose(picture.rgb[4, 4], [0.65, 0.25, 1.0])


def test_background_shows_through_by_coverage():
    cloud = make_cloud([0, 0, 5.0], [0, 0, -1.0], [[255, 0, 0]])
    picture = reference.render(cloud, make_view(), [1.0], FLAT, background=(0.0, 0.5, 1.0))
    part = picture.coverage[..., np.newaxis]
    np.testing.assert_allclose(picture.rgb, part * [1.0, 0, 0] + (1 - part) * [0.0, 0.5, 1.0])
    assert ((picture.coverage > 0) & (picture.coverage < 1)).any()
    np.testing.assert_array_equal(np.isnan(picture.depth), picture.coverage == 0)


@pytest.mark.parametrize("count", [0, 1])
def test_where_nothing_is_drawn_there_is_background(count):
    cloud = make_cloud(np.zeros((count, 3)) - [0, 0, 9.0], [0, 0, -1.0])
    picture = reference.render(cloud, make_view(), np.ones(count), FLAT, background=(0.1, 0.2, 0.3))
    assert picture.rgb.shape == (20, 24, 3)
    np.testing.assert_allclose(picture.rgb, np.broadcast_to([0.1, 0.2, 0.3], (20, 24, 3)))
    assert np.isnan(picture.depth).all()
    assert not picture.coverage.any()


def test_a_disc_of_radius_0_is_nowhere():
    cloud = make_cloud([0.0, 0.0, 5.0], [0, 0, -1.0])
    assert not reference.render(cloud, make_view(23, 19), [0.0], FLAT, samples=1).coverage.any()


def test_the_picture_does_not_depend_on_the_number_of_threads():
    cloud = random_cloud(np.random.default_rng(9), 400)
    radii = np.full(400, 0.2)
    view = make_view(64, 100, focal=60.0)
    pictures = []
    threads = numba.get_num_threads()
    try:
        for count in {1, threads}:
            numba.set_num_threads(count)
            pictures.append(reference.render(cloud, view, radii, Lighting()))
    finally:
        numba.set_num_threads(threads)
    for name in ("rgb", "depth", "coverage"):
        np.testing.assert_array_equal(
            getattr(pictures[0], name), getattr(pictures[-1], name), err_msg=name
        )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"radii": np.ones(3)}, "one radius a point"),
        ({"radii": np.array([1.0, -1.0])}, "finite and at least 0"),
        ({"radii": np.array([1.0, np.nan])}, "finite and at least 0"),
        ({"samples": 0}, "1..16, not 0"),
        ({"samples": 17}, "1..16, not 17"),
    ],
)
def test_bad_parameters_are_refused(changes, message):
    cloud = make_cloud(np.ones((2, 3)), [0, 0, -1.0])
    parameters = {"radii": np.ones(2), "samples": 4, "lighting": FLAT, **changes}
    radii, lighting = parameters.pop("radii"), parameters.pop("lighting")
    with pytest.raises(ValueError, match=message):
        reference.render(cloud, make_view(), radii, lighting, **parameters)


def test_progress_is_told_by_bands_and_changes_nothing():
    rng = np.random.default_rng(5)
    cloud, radii = random_cloud(rng, 40), np.full(40, 0.4)
    view = make_view(width=20, height=333)
    told = []
    before = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        one = reference.render(cloud, view, radii, Lighting(), progress=told.append)
    finally:
        numba.set_num_threads(before)
    other = reference.render(cloud, view, radii, Lighting())
    assert told == pytest.approx([4 / 21, 8 / 21, 12 / 21, 16 / 21, 20 / 21, 1.0])
    assert np.array_equal(one.rgb, other.rgb)
    assert np.array_equal(one.depth, other.depth, equal_nan=True)
