import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from splatline.contract.presets import PLANE, PRESETS
from splatline.host.cloud.cloud import Cloud
from splatline.host.cloud.spacing import splat_radii
from splatline.host.pipeline import make_frame
from splatline.host.scenes.scenes import load_scene
from splatline.host.shading.lighting import Lighting
from splatline.host.visibility.view import View, fit_view
from splatline.plots.pareto import front
from splatline.sim import golden, reference
from splatline.sim.reference import error_budget as budget
from splatline.sim.reference import metrics
from splatline.sim.reference.point_sampled import Steps, render
from splatline.sim.reference.point_sampled_kernel import round_slopes
from tests.support.variants import variant

FLAT = Lighting(lights=(), ambient=1.0, gloss=0.0)
"""Everything shows its own colour."""

BLACK = (0.0, 0.0, 0.0)

PRESET_NAMES = ("paper", "rgb24")


def make_cloud(positions, normals, colours=(255, 255, 255), two_sided=False):
    positions = np.atleast_2d(np.asarray(positions, np.float64))
    count = len(positions)
    return Cloud(
        positions,
        np.ascontiguousarray(np.broadcast_to(np.asarray(normals, np.float32), (count, 3))),
        np.ascontiguousarray(np.broadcast_to(np.asarray(colours, np.uint8), (count, 3))),
        np.broadcast_to(np.asarray(two_sided, bool), (count,)).copy(),
        np.zeros(3),
        "test",
        {},
    )


def make_view(width=24, height=20, focal=30.0, near=0.1):
    return View(np.zeros(3), np.eye(3), focal, width, height, near)


def splat_at(column, line, diameter, view, z=3.0, normal=(0.0, 0.0, -1.0), **more):
    """A single disc at a place of the image, with a diameter in pixels."""
    x = (column - view.width / 2) / view.focal * z
    y = (line - view.height / 2) / view.focal * z
    return make_cloud([x, y, z], normal, **more), [0.5 * diameter * z / view.focal]


def pixels(picture):
    return {(int(column), int(line)) for line, column in np.argwhere(picture.drawn)}


def drawn(cloud, radii, view, **steps):
    return pixels(render(cloud, view, radii, FLAT, Steps(**steps)))


@pytest.mark.parametrize("case", range(8))
def test_without_approximations_it_is_the_reference_at_one_sample(case):
    rng = np.random.default_rng(case)
    count = 60
    positions = rng.uniform((-2.5, -2.5, -1.0), (2.5, 2.5, 6.0), (count, 3))
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    cloud = make_cloud(
        positions, normals, rng.integers(0, 256, (count, 3)), rng.random(count) < 0.3
    )
    radii = rng.uniform(0.01, 1.5, count)  # some cross the near plane
    view = make_view(18, 37, focal=rng.uniform(8, 40), near=0.3)
    options = {"background": (0.1, 0.2, 0.3)}
    picture = render(cloud, view, radii, Lighting(), **options)
    exact = reference.render(cloud, view, radii, Lighting(), samples=1, **options)
    np.testing.assert_array_equal(picture.rgb, exact.rgb)
    np.testing.assert_array_equal(picture.depth, exact.depth)
    np.testing.assert_array_equal(picture.drawn, exact.coverage > 0.0)


@pytest.mark.parametrize(
    ("depth_range", "wide", "parts"), [((0.0, 100.0), 8, (10, 15)), ((2.9, 3.1), 4, (20, 30))]
)
def test_a_sloped_disc_has_one_depth_a_pixel_a_fraction_or_a_splat(depth_range, wide, parts):
    view = make_view(64, 64, focal=300.0)
    normal = np.array([0.4, 0.13, -math.sqrt(1.0 - 0.4**2 - 0.13**2)])
    cloud, radii = splat_at(30.3, 30.1, 19.0, view, normal=normal)
    depths = {
        where: render(cloud, view, radii, FLAT, Steps(depth=where), depth_range=depth_range).depth
        for where in ("pixel", "fraction", "splat")
    }
    exact, fraction, splat = depths.values()
    assert np.unique(splat[~np.isnan(splat)]).tolist() == [3.0]
    # About 18 columns and lines: five rows of fractions, of up to three each, or up to five where
    # they are halved.
    different = np.unique(fraction[~np.isnan(fraction)])
    assert parts[0] <= len(different) <= parts[1]
    for depth in different:
        lines, columns = np.nonzero(fraction == depth)
        assert np.ptp(lines) < 4
        assert np.ptp(columns) < wide
        # The plane's at the middle of its pixels, which is about their mean.
        assert depth == pytest.approx(exact[lines, columns].mean(), abs=2e-4)
    assert np.nanmean((fraction - exact) ** 2) < 0.2 * np.nanmean((splat - exact) ** 2)


def test_depth_codes_are_even_steps_of_the_range_or_of_its_reciprocal():
    view = make_view()
    depths = np.array([1.0, 1.5, 2.0, 3.0, 4.0])
    columns = np.array([2, 6, 10, 14, 18]) + 0.5
    positions = np.stack([(columns - 12.0) / 30.0 * depths, 0.5 / 30.0 * depths, depths], axis=1)
    cloud = make_cloud(positions, [0.0, 0.0, -1.0])
    radii = 0.6 / 30.0 * depths

    def found(**steps):
        picture = render(cloud, view, radii, FLAT, Steps(depth="splat", **steps))
        return picture.depth[10, [2, 6, 10, 14, 18]]

    np.testing.assert_allclose(found(), depths)
    # Three bits have the codes 0..6, half a unit apart.
    np.testing.assert_allclose(found(depth_bits=3), depths)
    # Two bits: 0..2, at 1, 2.5 and 4. Halves are rounded up.
    np.testing.assert_allclose(found(depth_bits=2), [1.0, 1.0, 2.5, 2.5, 4.0])
    # 1 / z of 1, 0.625 and 0.25.
    np.testing.assert_allclose(found(depth_bits=2, reciprocal=True), [1, 1.6, 1.6, 4, 4])


def test_of_equal_codes_the_first_stays():
    view = make_view()
    front_last = make_cloud(
        [[0, 0, 2.0], [0, 0, 1.99], [0, 0, 4.0]], [0, 0, -1], [[255, 0, 0], [0, 255, 0], [0] * 3]
    )
    radii = [0.2, 0.2, 0.1]
    assert render(front_last, view, radii, FLAT).seen[10, 12] == 1
    assert render(front_last, view, radii, FLAT, Steps(depth_bits=3)).seen[10, 12] == 0


def test_places_are_rounded_to_quarters_and_to_corners():
    view = make_view()
    # About (10.5, 8.5) a disc of 1.2 pixels holds one pixel's centre; about a corner none.
    cloud, radii = splat_at(10.4, 8.55, 1.6, view)
    assert drawn(cloud, radii, view) == {(10, 8)}
    assert drawn(cloud, radii, view, place="whole") == {
        (9, 8), (10, 8), (9, 9), (10, 9)}  # fmt: skip
    # A pixel's centre 0.61 to the right is out of reach, until the place moves by 0.05.
    cloud, radii = splat_at(10.89, 8.5, 1.2, view)
    assert drawn(cloud, radii, view) == {(10, 8)}
    cloud, radii = splat_at(10.88, 8.5, 1.3, view)
    assert drawn(cloud, radii, view) == {(10, 8), (11, 8)}
    assert drawn(cloud, radii, view, place="quarter") == {(10, 8), (11, 8)}
    cloud, radii = splat_at(10.87, 8.5, 1.3, view)
    assert drawn(cloud, radii, view, place="quarter") == {(10, 8)}


def test_sizes_are_rounded_up_or_to_nearest():
    view = make_view()
    # Pixels' centres lie at 0.9 on the right, 1.1 on the left, 1.005 above and below; the diagonal
    # ones at 1.35 and 1.49.
    cloud, radii = splat_at(10.6, 8.5, 2.3, view)
    cross = {(10, 8), (9, 8), (11, 8), (10, 7), (10, 9)}
    assert drawn(cloud, radii, view) == cross
    assert len(drawn(cloud, radii, view, size="whole")) == 9
    assert drawn(cloud, radii, view, size="whole", size_up=False) == {(10, 8), (11, 8)}
    assert drawn(cloud, radii, view, size="half") == cross
    cloud, radii = splat_at(10.6, 8.5, 2.6, view)
    assert len(drawn(cloud, radii, view, size="half")) == 9
    assert drawn(cloud, radii, view, size="half", size_up=False) == cross


def test_what_covers_no_pixel_draws_the_least_if_asked_to():
    view = make_view()
    cloud, radii = splat_at(10.1, 8.2, 0.5, view)
    assert drawn(cloud, radii, view) == set()
    assert drawn(cloud, radii, view, never_empty=True) == {(10, 8)}
    assert drawn(cloud, radii, view, never_empty=True, place="whole") == {(10, 8)}
    # Seen nearly edge on, about a corner: two pixels along the edge, each the other's half turn.
    for sign, expected in ((1, {(10, 7), (9, 8)}), (-1, {(9, 7), (10, 8)})):
        normal = np.array([0.7, 0.7 * sign, -0.02])
        cloud, radii = splat_at(10.1, 8.1, 1.3, view, normal=normal / np.linalg.norm(normal))
        assert drawn(cloud, radii, view, place="whole") == set()
        least = drawn(cloud, radii, view, never_empty=True, place="whole")
        assert least == expected


def test_a_footprint_with_quantised_normal_is_the_papers_ellipse():
    view = make_view(64, 64, focal=4000.0)
    normal = np.array([0.6, 0.3, -0.7])
    normal /= np.linalg.norm(normal)
    cloud, radii = splat_at(31.3, 33.8, 14.0, view, normal=normal)
    # 64 even steps of n' / (1 + |n'|), whose middles stand for them.
    slopes = []
    for part in normal[:2] / normal[2]:
        step = (math.floor((part / (1 + abs(part)) + 1) * 32) + 0.5) / 32 - 1
        slopes.append(step / (1 - abs(step)))
    line, column = np.mgrid[:64, :64] + 0.5
    u, v = column - 31.3, line - 33.8
    inside = u * u + v * v + (slopes[0] * u + slopes[1] * v) ** 2 <= 49.0
    expected = {(int(x), int(y)) for y, x in np.argwhere(inside)}
    assert drawn(cloud, radii, view, normal_levels=True) == expected
    # A disc of 14 pixels so far away is all but an ellipse: quantising changes its rim alone.
    assert 0 < len(drawn(cloud, radii, view) ^ expected) < 12


def test_shade_materials_and_colour_are_rounded():
    view = make_view()
    normal = np.array([0.3, 0.2, -0.8])
    cloud, radii = splat_at(10.5, 8.5, 3.0, view, normal=normal / np.linalg.norm(normal),
                            colours=(200, 100, 50))  # fmt: skip

    def colour(lighting, **steps):
        return render(cloud, view, radii, lighting, Steps(**steps)).rgb[8, 10]

    phong, table = colour(Lighting()), colour(Lighting(), intensity_bits=7)
    assert 0.0 < np.abs(phong - table).max() < 0.03
    np.testing.assert_allclose(colour(FLAT), np.array([200, 100, 50]) / 255)
    # 200 / 255 * 7 = 5.49, 2.75 and 1.37.
    np.testing.assert_allclose(colour(FLAT, channel_bits=3), np.array([5, 3, 1]) / 7)

    many = make_cloud(cloud.positions.repeat(300, axis=0), [0, 0, -1],
                      np.random.default_rng(1).integers(0, 256, (300, 3)))  # fmt: skip
    few = render(many, view, np.full(300, radii[0]), FLAT, Steps(materials=2))
    seen = few.seen[8, 10]
    assert (few.rgb[8, 10] != many.colours[seen] / 255.0).any()


@pytest.mark.parametrize(
    ("quality", "preset", "size"),
    [
        *((quality, preset, 1.0) for quality in budget.LADDERS for preset in PRESET_NAMES),
        ("exact", "rgb24", 3.0),
    ],
)
def test_a_ladder_ends_near_the_golden_renderer(quality, preset, size):
    scene = load_scene("knot")
    view = fit_view(scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up, size=(160, 160))
    radii, lighting = size * splat_radii(scene.cloud), Lighting()
    exact = reference.render(scene.cloud, view, radii, lighting, background=BLACK)
    config = PRESETS[preset]
    rungs = budget.ladder(quality, config)
    rows = list(budget.walk(rungs, scene.cloud, view, radii, lighting, exact, BLACK))
    assert [row["step"] for row in rows] == [rung.name for rung in rungs]

    frame = make_frame(scene.cloud, view, radii=radii, quality=quality, config=config)
    drawn = metrics.compare(
        golden.render(frame), exact, background=BLACK, depth_range=frame.counts["depth_range"]
    )
    last = rows[-1]
    assert last["psnr_db"] == pytest.approx(drawn["psnr_db"], abs=0.25)
    assert last["ssim"] == pytest.approx(drawn["ssim"], abs=0.01)
    assert last["silhouette_iou"] == pytest.approx(drawn["silhouette_iou"], abs=0.005)
    assert last["depth_rmse"] == pytest.approx(drawn["depth_rmse"], abs=0.003)
    if quality == "paper":  # the way down costs, whatever single steps do
        assert rows[0]["psnr_db"] > last["psnr_db"] + 1.0


@pytest.mark.parametrize("quality", budget.LADDERS)
def test_the_rungs_of_a_ladder_add_up(quality):
    rungs = budget.ladder(quality, variant("depth12"))
    assert rungs[0].steps == Steps()
    for before, after in itertools.pairwise(rungs):
        default = Steps()
        kept = [name for name in vars(default)
                if getattr(before.steps, name) != getattr(default, name)]  # fmt: skip
        assert after.steps != before.steps
        assert all(getattr(after.steps, name) == getattr(before.steps, name) for name in kept)
    last = rungs[-1].steps
    assert (last.depth_bits, last.intensity_bits, last.materials) == (12, 6, 64)


def test_there_is_no_ladder_to_other_qualities():
    with pytest.raises(ValueError, match="no ladder leads to 'best'"):
        budget.ladder("best")


@given(
    st.lists(st.tuples(st.integers(0, 12), st.integers(0, 12)), max_size=40).map(
        lambda pairs: [(float(cost), float(value)) for cost, value in pairs]
    )
)
def test_a_front_is_what_nothing_dominates(points):
    def dominated(i):
        cost, value = points[i]
        return any(c <= cost and v >= value and (c, v) != (cost, value) for c, v in points)

    members = front([cost for cost, _ in points], [value for _, value in points])
    assert sorted(members) == [i for i in range(len(points)) if not dominated(i)]
    costs = [points[i][0] for i in members]
    assert costs == sorted(costs)


def test_the_ladder_of_an_engine_with_planes_ends_near_the_golden_renderer():
    scene = load_scene("knot")
    view = fit_view(scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up, size=(160, 160))
    lighting = Lighting()
    for size in (1.0, 3.0):
        radii = size * splat_radii(scene.cloud)
        exact = reference.render(scene.cloud, view, radii, lighting, background=BLACK)
        rungs = budget.ladder("exact", PLANE)
        rows = list(budget.walk(rungs, scene.cloud, view, radii, lighting, exact, BLACK))
        assert [row["step"] for row in rows] == [
            "one sample a pixel", "12-bit depth", "7-bit slopes", "shading table", "materials",
            "8-bit colour",
        ]  # fmt: skip
        frame = make_frame(scene.cloud, view, radii=radii, config=PLANE)
        drawn = metrics.compare(
            golden.render(frame), exact, background=BLACK, depth_range=frame.counts["depth_range"]
        )
        assert rows[-1]["psnr_db"] == pytest.approx(drawn["psnr_db"], abs=0.3)
        assert rows[-1]["depth_rmse"] == pytest.approx(drawn["depth_rmse"], abs=0.001)
        loss = rows[1]["psnr_db"] - rows[2]["psnr_db"]
        assert loss < 0.15 if size == 1.0 else loss < 0.3


@pytest.mark.parametrize(
    ("slopes", "most", "expected"),
    [
        ((0.0, 0.0), 63, (0.0, 0.0)),
        ((0.3, -0.3), 63, (0.25, -0.25)),
        ((15.75, 0.1), 63, (15.75, 0.0)),
        ((16.0, 0.1), 63, (16.0, 0.0)),
        ((252.0, -1.0), 63, (252.0, 0.0)),
        ((1000.0, -1000.0), 63, (252.0, -252.0)),
        ((3.0, -100.0), 3, (4.0, -12.0)),
    ],
)
def test_slopes_are_rounded_as_a_plane_word_holds_them(slopes, most, expected):
    assert round_slopes(*slopes, most) == expected


def test_planes_need_bits_of_depth():
    scene = load_scene("knot")
    view = fit_view(scene.cloud, size=(16, 16))
    with pytest.raises(ValueError, match="planes need bits of depth"):
        render(scene.cloud, view, np.full(len(scene.cloud), 0.1), Lighting(), Steps(depth="plane"))
