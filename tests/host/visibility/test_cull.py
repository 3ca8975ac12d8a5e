"""Whole blocks are left out only where each of their points would be."""

import dataclasses
import itertools
from typing import NamedTuple

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from splatline.contract.errors import InputError
from splatline.host.encode.quality import QUALITIES
from splatline.host.pipeline import make_frame
from splatline.host.visibility import look_over as look_over_module
from splatline.host.visibility import project as project_module
from splatline.host.visibility.block_index import BLOCK_POINTS, build_index
from splatline.host.visibility.cull import Camera, lies_inside
from splatline.host.visibility.skips import DEFAULT_SKIPS, SKIPS
from splatline.host.visibility.view import fit_view
from splatline.sim import golden
from tests.support.clouds import cloud_of, sphere


def every_block(bounds, camera, rules, status):
    status[:] = 0


def patchy(seed, count=6000):
    """Points in clumps of many sizes, with normals all about."""
    rng = np.random.default_rng(seed)
    places = rng.normal(size=(12, 3))[rng.integers(0, 12, count)]
    places += rng.normal(size=(count, 3)) * 10.0 ** rng.uniform(-4, -0.5, (count, 1))
    normals = places / np.linalg.norm(places, axis=1, keepdims=True)
    return cloud_of(places, normals, rng.integers(0, 256, (count, 3)))


@given(
    st.integers(0, 2**32 - 1),
    st.tuples(st.floats(-180, 180), st.floats(-89, 89)),
    st.floats(5, 160),
    st.sampled_from([0.01, 0.2, 1.0, 30.0]),
    st.floats(-3, 3),
    st.sampled_from([1e-4, 3e-3, 0.1]),
    st.sampled_from([(0.0, 0.0), (0.25, -0.375), (40.0, -7.0), (-500.0, 300.0)]),
)
@settings(max_examples=60, deadline=None)
def test_no_block_hides_a_point_that_would_be_drawn(seed, orbit, fov, zoom, nearer, radius, shift):
    cloud = patchy(seed)
    view = fit_view(cloud, orbit=orbit, fov=fov, zoom=zoom, size=(64, 48))
    # From outside the cloud to inside it.
    eye = view.eye * (1 + nearer / 3) + 0.3 * nearer * view.axes[0]
    view = dataclasses.replace(view, eye=eye, near=1e-3, shift=shift)
    index = build_index(cloud, np.full(len(cloud), radius))
    limits = (0.0, 10.0)
    try:
        found = make_frame(index, view, depth_range=limits)
    except InputError:
        found = None
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(project_module, "cull_blocks", every_block)
        if found is None:
            with pytest.raises(InputError):
                make_frame(index, view, depth_range=limits)
            return
        every = make_frame(index, view, depth_range=limits)
    assert np.array_equal(found.codewords, every.codewords)
    assert sum(found.counts["culled"].values()) == sum(every.counts["culled"].values())


@given(
    st.integers(0, 2**32 - 1),
    st.tuples(st.floats(-180, 180), st.floats(-89, 89)),
    st.floats(5, 160),
    st.sampled_from([0.01, 0.2, 1.0, 30.0]),
    st.sampled_from([1e-4, 3e-3, 1e-2]),
    st.integers(-30, 30),
    st.booleans(),
)
@settings(max_examples=60, deadline=None)
def test_the_quick_test_leaves_out_no_point_that_would_be_drawn(
    seed, orbit, fov, zoom, radius, magnitude, two_sided
):
    cloud = patchy(seed)
    unit = 10.0**magnitude
    cloud = dataclasses.replace(
        cloud,
        positions=cloud.positions * unit,
        two_sided=np.full(len(cloud), two_sided),
    )
    view = fit_view(cloud, orbit=orbit, fov=fov, zoom=zoom, size=(64, 48))
    radii = np.random.default_rng(seed).uniform(0.1, 1.0, len(cloud)) * radius * unit
    index = build_index(cloud, radii)
    skips = DEFAULT_SKIPS - {"overdrawn"}
    options = {"skips": skips, "depth_range": (0.0, 10.0 * unit)}
    try:
        found = make_frame(index, view, **options)
    except InputError:
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(project_module, "look_over", no_point)
        every = make_frame(index, view, **options)
    assert np.array_equal(found.codewords, every.codewords)
    assert sum(found.counts["culled"].values()) == sum(every.counts["culled"].values())


def no_point(points, blocks, camera, rules, reasons):
    """Leave every point to the exact tests."""
    count = points.total
    for chunk, (begin, end) in enumerate(itertools.pairwise(blocks.cuts)):
        every = np.arange(BLOCK_POINTS) + BLOCK_POINTS * blocks.visible[begin:end, np.newaxis]
        every = every[every < count]
        blocks.kept[BLOCK_POINTS * begin : BLOCK_POINTS * begin + len(every)] = every
        reasons[chunk, 0] = len(every)


def test_the_quick_test_leaves_out_most_points_of_a_dense_cloud(monkeypatch):
    cloud = sphere(200_000)
    view = fit_view(cloud, size=(64, 64))
    kept = []

    def look_over(points, blocks, camera, rules, reasons):
        look_over_module.look_over(points, blocks, camera, rules, reasons)
        kept.append(reasons[:, 0].sum())

    monkeypatch.setattr(project_module, "look_over", look_over)
    frame = frames(cloud, view, 0.01, DEFAULT_SKIPS)[0]
    culled = frame.counts["culled"]
    exact = frame.counts["elements"] + culled["overdrawn"]
    assert exact <= kept[-1] <= 1.1 * exact
    assert culled["no_pixel"] > 50_000


@pytest.mark.parametrize("threads", [1, 2])
def test_of_points_that_cover_one_pixel_alone_the_nearest_is_drawn(threads):
    cloud = sphere(200_000)
    view = fit_view(cloud, size=(64, 64))
    before = numba.get_num_threads()
    numba.set_num_threads(min(threads, before))
    try:
        every, fewer = frames(cloud, view, 0.01, DEFAULT_SKIPS - {"overdrawn"}, DEFAULT_SKIPS)
    finally:
        numba.set_num_threads(before)
    assert every.counts["culled"]["overdrawn"] == 0
    assert fewer.counts["culled"]["overdrawn"] > 0.5 * every.counts["elements"]
    assert sum(fewer.counts["culled"].values()) + fewer.counts["elements"] == 200_000
    one, other = golden.render(every), golden.render(fewer)
    assert np.array_equal(one.depth, other.depth)
    # At least one word for each pixel, and at most one for each pixel and chunk of the work.
    assert one.drawn.sum() <= len(fewer.codewords) < 3 * one.drawn.sum()


@given(
    st.integers(0, 2**32 - 1),
    st.tuples(st.floats(-180, 180), st.floats(-89, 89)),
    st.sampled_from([1e-4, 3e-3, 2e-2, 0.1]),
    st.sampled_from(["fast", "exact"]),
    st.sampled_from([set(), {"no_pixel"}, {"facing_away"}, {"hidden"}]),
)
@settings(max_examples=40, deadline=None)
def test_points_that_are_overdrawn_change_no_depth(seed, orbit, radius, quality, switched):
    cloud = patchy(seed)
    view = fit_view(cloud, orbit=orbit, size=(64, 48))
    index = build_index(cloud, np.full(len(cloud), radius))
    options = {"quality": quality, "depth_range": make_frame(index, view).counts["depth_range"]}
    skips = DEFAULT_SKIPS ^ switched
    every = make_frame(index, view, skips=skips - {"overdrawn"}, **options)
    fewer = make_frame(index, view, skips=skips, **options)
    assert fewer.counts["elements"] <= every.counts["elements"]
    assert np.array_equal(golden.render(every).depth, golden.render(fewer).depth)


def frames(cloud, view, radius, *skips):
    """Frames of one depth range, for some choices of what to leave out."""
    index = build_index(cloud, np.full(len(cloud), radius))
    limits = make_frame(index, view, skips=skips[0]).counts["depth_range"]
    return [make_frame(index, view, skips=chosen, depth_range=limits) for chosen in skips]


def test_skipping_what_lies_outside_changes_no_word():
    cloud = sphere(4000)
    view = fit_view(cloud, zoom=3.0, size=(96, 80))
    without, with_it = frames(cloud, view, 0.05, {"facing_away"}, {"facing_away", "outside"})
    assert with_it.counts["culled"]["outside"] > 1000
    assert np.array_equal(np.sort(without.codewords), np.sort(with_it.codewords))
    assert without.counts["elements"] == with_it.counts["elements"]


def test_skipping_backs_changes_no_pixel_of_a_closed_surface_but_at_its_silhouette():
    cloud = sphere(20_000)
    view = fit_view(cloud, size=(96, 80))
    without, with_it = frames(cloud, view, 0.06, {"outside"}, {"outside", "facing_away"})
    assert with_it.counts["culled"]["facing_away"] > 9000
    # Of equal depths another word may come first, so that only depths are alike.
    changed = golden.render(without).depth != golden.render(with_it).depth
    y, x = np.mgrid[:80, :96] + 0.5
    from_middle = np.hypot(x - 48, y - 40)
    reach = from_middle[golden.render(with_it).drawn].max()
    assert not changed[from_middle < reach - 3].any()


def test_skipping_what_covers_no_pixel_leaves_no_hole_in_a_closed_surface():
    cloud = sphere(200_000)
    view = fit_view(cloud, size=(64, 64))
    without, with_it = frames(cloud, view, 0.02, DEFAULT_SKIPS - {"no_pixel"}, DEFAULT_SKIPS)
    assert with_it.counts["culled"]["no_pixel"] > 20_000
    y, x = np.mgrid[:64, :64] + 0.5
    from_middle = np.hypot(x - 32, y - 32)
    reach = from_middle[golden.render(without).drawn].max()
    assert golden.render(with_it).drawn[from_middle < reach - 1.5].all()


@pytest.mark.parametrize("quality", list(QUALITIES))
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([0.02, 0.1, 0.4, 2.0]),
    st.tuples(st.floats(-180, 180), st.floats(-89, 89)),
    st.sampled_from([(64, 48), (61, 47), (20, 90)]),
)
@settings(max_examples=25, deadline=None)
def test_what_hides_behind_others_is_left_out_without_changing_a_pixel(
    quality, seed, radius, orbit, size
):
    cloud = patchy(seed, 9000)
    view = fit_view(cloud, orbit=orbit, size=size)
    index = build_index(cloud, np.full(len(cloud), radius))
    with_it = make_frame(index, view, quality=quality, skips=DEFAULT_SKIPS | {"hidden"})
    without = make_frame(index, view, quality=quality)
    assert golden.render(with_it).mismatches(golden.render(without)) == 0
    assert without.counts["culled"]["hidden"] == 0


def test_most_of_what_stands_behind_a_wall_is_hidden():
    y, x = np.mgrid[-1:1:90j, -1:1:90j]
    places = np.concatenate(
        [np.stack([x, y, np.full_like(x, z)], -1).reshape(-1, 3) for z in range(6)]
    )
    cloud = cloud_of(places, np.broadcast_to([0, 0, 1.0], places.shape))
    view = fit_view(cloud, orbit=(0, 0), size=(96, 96))
    index = build_index(cloud, np.full(len(cloud), 0.04))
    frame = make_frame(index, view, skips=DEFAULT_SKIPS | {"hidden"})
    # Five of six walls; the nearest one's first wave may hide less.
    assert frame.counts["culled"]["hidden"] > 0.6 * len(cloud)


def test_every_reason_is_counted():
    frame = frames(sphere(), fit_view(sphere(), size=(64, 64)), 0.05, DEFAULT_SKIPS)[0]
    assert set(frame.counts["culled"]) == set(SKIPS)
    assert frame.counts["skips"] == sorted(DEFAULT_SKIPS)


@pytest.mark.parametrize(("distance", "most"), [(10, 0.2), (40, 0.03)])
def test_from_afar_few_groups_of_points_are_read(distance, most):
    cloud = sphere(200_000)
    view = fit_view(cloud, size=(96, 96))
    far = Camera.of(dataclasses.replace(view, focal=view.focal / distance))
    index = build_index(cloud, np.full(200_000, 0.004))
    seen = np.zeros((len(index.bounds), look_over_module.GROUPS), np.uint8)
    for bound, groups, found in zip(index.bounds, index.groups, seen, strict=True):
        count = look_over_module.GROUPS
        look_over_module._test_groups(bound, groups, count, far, True, found)
    assert 0.0 < seen.mean() < most


class _Pinhole(NamedTuple):
    focal: float
    near: float
    width: int
    height: int
    middle_x: float
    middle_y: float


class _Ball(NamedTuple):
    reach: float
    largest: float


def test_a_block_that_lies_inside_has_no_point_near_a_border():
    """Points of its sphere, seen by a pinhole; each side decides alone for some blocks."""
    camera = _Pinhole(60.0, 0.1, 90, 70, 45.0, 35.0)
    rng = np.random.default_rng(4)
    outwards = rng.normal(size=(400, 3))
    outwards /= np.linalg.norm(outwards, axis=1)[:, np.newaxis]
    inside, sides = 0, np.zeros(4, int)
    for _ in range(600):
        depth = rng.uniform(2.0, 9.0)
        middle = (*rng.uniform(-0.9, 0.9, 2) * depth, depth)
        bound = _Ball(rng.uniform(0.0, 0.4), rng.uniform(0.0, 0.1))
        x, y, z = (middle + (bound.reach + bound.largest) * outwards).T
        column, line = 45.0 + 60.0 * x / z, 35.0 + 60.0 * y / z
        beyond = np.array([column.min() < 0, column.max() > 90, line.min() < 0, line.max() > 70])
        if lies_inside(bound, middle, camera):
            inside += 1
            assert not beyond.any()
        elif beyond.sum() == 1:
            sides += beyond
    assert inside > 100
    assert sides.min() > 10
