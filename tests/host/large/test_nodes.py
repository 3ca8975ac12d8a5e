import dataclasses
import functools

import numpy as np
import pytest

from splatline.host.files.copc import ENTRY, Octree
from splatline.host.large import nodes, pieces
from splatline.host.large.draw_parts import Drawing, draw_parts, frames_of
from splatline.host.large.nodes import choose_nodes
from splatline.host.large.plan import Part, make_plan
from splatline.host.large.thin import CELLS, grid_of
from splatline.host.visibility.view import fit_view
from splatline.sim import golden
from tests.support.clouds import cloud_of
from tests.support.copc_files import make_hills

COUNT = 300_000
ORIGIN = np.array([5e5, 5e6, 0.0])


def whole_octree(depth, side=8.0):
    """All nodes of some levels, each of 1000 points."""
    nodes = [
        (level, *place, 0, 0, 1000)
        for level in range(depth)
        for place in np.ndindex(*[1 << level] * 3)
    ]
    return Octree(ORIGIN - 0.5 * side, side, side / 16, np.array(nodes, ENTRY))


def views():
    corners = np.array(list(np.ndindex(2, 2, 2))) * 8.0 - 4.0
    rng = np.random.default_rng(3)
    for number in range(8):
        view = fit_view(
            cloud_of(corners, corners),
            orbit=(360 * rng.random(), 160 * rng.random() - 80),
            size=(64, 40),
            zoom=1.0 + 3 * (number % 3),
        )
        if number >= 4:  # among the nodes
            view = dataclasses.replace(view, eye=rng.uniform(-4, 4, 3), near=0.05)
        yield view, (100.0, 6.0)[number % 2]


def cells_hold(view, grid, points):
    """Whether a point is in a cell of the grid, as ``Thinner`` has it."""
    seen = (points - ORIGIN - view.eye) @ view.axes.T
    ahead = seen[..., 2]
    column, line = (
        (view.middle[i] + view.focal * seen[..., i] / ahead + grid.beside) * grid.cells
        for i in range(2)
    )
    within = (column >= 0) & (column < grid.wide) & (line >= 0) & (line < grid.high)
    return within & (ahead >= view.near) & (ahead <= grid.farthest), ahead


def test_nodes_are_chosen_as_their_points_by_hand():
    octree = whole_octree(5)
    rng = np.random.default_rng(1)
    corners, sides = octree.cubes()
    inside = np.concatenate([list(np.ndindex(2, 2, 2)), rng.random((200, 3))])
    points = corners[:, np.newaxis] + inside * sides[:, np.newaxis, np.newaxis]
    keys = [node[:4] for node in octree.nodes.tolist()]
    far, near = 0, 0
    for view, farthest in views():
        grid = grid_of(view, CELLS, farthest)
        chosen = choose_nodes(octree, view, ORIGIN, grid)
        kept = chosen.needed
        chosen_keys = {key for key, needed in zip(keys, kept, strict=True) if needed}
        assert (1 * chosen.outside + chosen.finer + kept == 1).all()
        held, ahead = cells_hold(view, grid, points)
        seen = held.any(axis=1)
        pixels = view.focal / np.maximum(ahead.min(axis=1), view.near)
        levels = octree.nodes["level"]
        needed = (levels == 0) | (2 * octree.spacing / 2.0**levels * pixels * CELLS > 1)
        assert np.array_equal(kept[seen], needed[seen])
        assert not kept[~needed].any()
        for level, *place in chosen_keys:
            assert not level or (level - 1, *(axis >> 1 for axis in place)) in chosen_keys
        far += (~seen).sum()
        near += (kept & ~seen).sum()
        assert not chosen.outside[seen].any()
    assert near < 0.1 * far
    assert far > 0.2 * 8 * len(keys)


@pytest.mark.parametrize(
    ("name", "fault"),
    [("CORNERS", 0.5 * nodes.CORNERS + 0.25), ("CORNERS", nodes.CORNERS[1:]), ("FINEST", 2.0)],
    ids=["smaller cubes", "a corner less", "a level less"],
)
def test_faults_in_the_choice_are_found(monkeypatch, name, fault):
    monkeypatch.setattr(nodes, name, fault)
    with pytest.raises((AssertionError, ValueError)):
        test_nodes_are_chosen_as_their_points_by_hand()


@pytest.fixture(scope="module")
def hills(tmp_path_factory):
    return make_hills(tmp_path_factory.mktemp("nodes"), COUNT, leaf=1000)


def plan_of(path, **options):
    fit = functools.partial(fit_view, size=(96, 80), up="z", **options)
    return make_plan([path], None, fit, 1 << 7)


def picture(plan):
    parts = draw_parts(plan, Drawing())
    (frame,) = frames_of(plan, Drawing(), parts)
    return golden.render(frame), parts


def both_pictures(path, zoom):
    """The picture of the nodes that a view needs, and that of all points."""
    settled = plan_of(path, zoom=zoom)
    assert settled.count == COUNT
    assert len(settled.parts) == 1
    drawn, parts = picture(settled)
    settled.files[0].octree = None
    whole, all_parts = picture(dataclasses.replace(settled, parts=(Part(0),)))
    assert parts.points == all_parts.points == COUNT
    return drawn, whole, parts


def test_a_view_of_chosen_nodes_looks_as_that_of_all_points(hills):
    drawn, whole, parts = both_pictures(hills[1], 1.0)
    assert parts.dropped["finer"] > 0.5 * COUNT
    error = np.mean((drawn.to_rgb() - whole.to_rgb()) ** 2)
    assert -10 * np.log10(error) > 28
    assert np.mean(drawn.drawn == whole.drawn) > 0.98


def test_nodes_outside_of_the_view_play_no_part(hills):
    drawn, whole, parts = both_pictures(hills[1], 8.0)
    assert parts.dropped["outside"] > 0.5 * COUNT
    assert drawn.mismatches(whole) == 0


def test_the_order_of_nodes_plays_no_part(hills, monkeypatch):
    settled = plan_of(hills[1], zoom=4.0)
    wanted, parts = picture(settled)
    read, order = pieces.copc_tables, np.random.default_rng(2)
    calls = []

    def shuffled(source, header, nodes, names, points):
        calls.append(len(nodes))
        for i in order.permutation(len(nodes)):
            yield from read(source, header, nodes[i : i + 1], names, points)

    monkeypatch.setattr(pieces, "copc_tables", shuffled)
    found, others = picture(settled)
    assert calls[0] > 10
    assert found.mismatches(wanted) == 0
    assert others.dropped == parts.dropped


def test_a_plain_file_of_the_same_points_has_the_same_counts(hills):
    plain, octree = (picture(plan_of(path))[1] for path in hills)
    assert plain.points == octree.points == COUNT
    assert octree.used == plain.used
