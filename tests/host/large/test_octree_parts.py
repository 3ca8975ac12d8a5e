"""An octree in parts: each point is in one of them, and one machine draws what a cluster draws."""

import dataclasses
import functools

import numpy as np
import pytest

from splatline.host.files.copc import ENTRY, Octree
from splatline.host.large import octree_parts, plan
from splatline.host.large.draw_parts import Drawing, draw_parts, frames_of
from splatline.host.large.octree_parts import LEVEL, code_ranges, codes_in_node, cut_octree
from splatline.host.large.plan import Part, make_plan
from splatline.host.large.read_part import read_part
from splatline.host.visibility.view import fit_view
from splatline.sim import golden
from tests.support.copc_files import make_hills

COUNT = 120_000
CORNER = np.array([5e5, 5e6, -3.0])
SIDE = 7.3


@pytest.fixture(scope="module")
def hills(tmp_path_factory):
    return make_hills(tmp_path_factory.mktemp("parts"), COUNT, leaf=1000)[1]


def plan_of(path, most, monkeypatch, **options):
    monkeypatch.setattr(plan, "NODE_POINTS", most)
    fit = functools.partial(fit_view, size=(300, 240), up="z", **options)
    return make_plan([path], None, fit, 1 << 7)


def node_at(level, x, y, z, count=10):
    return np.array([(level, x, y, z, 0, 0, count)], ENTRY)


def code_by_hand(x, y, z):
    digits = [f"{axis:0{LEVEL}b}" for axis in (z, y, x)]
    return int("".join("".join(bits) for bits in zip(*digits, strict=True)), 2)


def test_codes_are_those_by_hand():
    first, stop = code_ranges(np.concatenate([
        node_at(0, 0, 0, 0), node_at(LEVEL, 5, 9, 33), node_at(LEVEL + 2, 21, 39, 132),
        node_at(2, 3, 0, 1),
    ]))  # fmt: skip
    cell = code_by_hand(5, 9, 33)
    quarter = code_by_hand(3 << LEVEL - 2, 0, 1 << LEVEL - 2)
    assert first.tolist() == [0, cell, cell, quarter]
    assert (stop - first).tolist() == [8**LEVEL, 1, 1, 8 ** (LEVEL - 2)]


def test_points_at_the_sides_of_a_node_s_cube_stay_in_the_node():
    node = node_at(2, 1, 2, 3)
    tree = Octree(CORNER, SIDE, 0.1, node)
    (first,), (stop,) = code_ranges(node)
    rng = np.random.default_rng(4)
    inside = rng.random((500, 3))
    inside[:200] = rng.integers(0, 2, (200, 3))
    points = CORNER + (np.array([1, 2, 3]) + inside) * SIDE / 4
    points += rng.normal(0, 1e-9, points.shape)
    codes = codes_in_node(points, tree, node[0])
    assert (codes >= first).all()
    assert (codes < stop).all()
    places = np.floor((points[200:] - CORNER) / SIDE * 64).astype(int)
    assert codes[200:].tolist() == [code_by_hand(*place) for place in places.tolist()]


@pytest.mark.parametrize("most", [1, 7_000, 10**9])
def test_ranges_follow_one_another_and_have_even_shares(most):
    rng = np.random.default_rng(6)
    nodes = np.concatenate([
        node_at(level, *rng.integers(0, 1 << level, 3), count=int(rng.integers(1, 900)))
        for level in rng.integers(0, 9, 200).tolist()
    ])  # fmt: skip
    cuts = cut_octree(nodes, most)
    assert cuts[0][0] == 0
    assert cuts[-1][1] == 8**LEVEL
    assert [end for _, end in cuts[:-1]] == [first for first, _ in cuts[1:]]
    if most == 7_000:
        total = int(nodes["count"].sum())
        assert len(cuts) == -(-total // most)
        first, _ = code_ranges(nodes)
        fine = nodes["level"] >= LEVEL
        shares = [nodes["count"][fine & (a <= first) & (first < b)].sum() for a, b in cuts]
        assert max(shares) < most + 900


@pytest.mark.parametrize("options", [{}, {"zoom": 6.0}, {"orbit": (40, 5)}])
def test_each_point_is_in_one_part(hills, monkeypatch, options):
    whole = plan_of(hills, 10**9, monkeypatch, **options)
    parted = plan_of(hills, 9_000, monkeypatch, **options)
    assert len(whole.parts) == 1
    assert len(parted.parts) > 4
    one = draw_parts(whole, Drawing())
    parts = [read_part(parted, part, 2 << 30) for part in parted.parts]
    assert one.points == COUNT
    read = [len(part.cloud or ()) + sum(part.dropped.values()) for part in parts]
    assert sum(read) == COUNT
    assert sum(part.dropped["outside"] for part in parts) == one.dropped["outside"]


def test_a_point_on_a_border_is_in_one_part_though_a_part_would_lose_it(hills, monkeypatch):
    """The fault: points of large nodes are told apart by a cube that is a little smaller."""
    parted = plan_of(hills, 9_000, monkeypatch)

    def count():
        parts = [read_part(parted, part, 2 << 30) for part in parted.parts]
        return sum(len(part.cloud or ()) + sum(part.dropped.values()) for part in parts)

    assert count() == COUNT
    right = octree_parts._codes
    monkeypatch.setattr(octree_parts, "_codes", lambda places: right(places % 63))
    assert count() != COUNT


def test_parts_look_as_one(hills, monkeypatch):
    rasters = []
    for most in (10**9, 9_000):
        settled = plan_of(hills, most, monkeypatch)
        (frame,) = frames_of(settled, Drawing(), draw_parts(settled, Drawing()))
        rasters.append(golden.render(frame))
    one, many = rasters
    error = np.mean((one.to_rgb() - many.to_rgb()) ** 2)
    assert np.mean(one.drawn != many.drawn) < 0.001
    assert -10 * np.log10(error) > 30
    assert one.differs(many).mean() < 0.2


def test_the_order_of_parts_plays_no_part(hills, monkeypatch):
    settled = plan_of(hills, 9_000, monkeypatch, zoom=1.5)
    turned = dataclasses.replace(settled, parts=settled.parts[::-1])
    (one,), (other,) = (frames_of(each, Drawing(), draw_parts(each, Drawing()))
                        for each in (settled, turned))  # fmt: skip
    assert np.array_equal(one.codewords, other.codewords)
    assert one.counts == other.counts


def test_a_part_without_a_point_in_view_keeps_its_counts(hills, monkeypatch):
    settled = plan_of(hills, 9_000, monkeypatch, zoom=8.0)
    found = [read_part(settled, part, 2 << 30) for part in settled.parts]
    empty = read_part(settled, Part(0, 0, 1), 2 << 30)
    assert empty.cloud is None
    assert sum(part.dropped["outside"] for part in found) > COUNT / 2
