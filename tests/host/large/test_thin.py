import dataclasses

import numpy as np
import pytest
from scipy.spatial import cKDTree

from splatline.contract.errors import InputError
from splatline.host.large.cells import CellTable
from splatline.host.large.thin import Thinner, grid_of
from splatline.host.visibility.view import fit_view
from tests.support.clouds import cloud_of

FAR = 100.0


def some_points(seed=1, count=20_000):
    rng = np.random.default_rng(seed)
    positions = rng.uniform(-1, 1, (count, 3)) * (1, 0.6, 0.2) + (3e5, 5e6, 40)
    return positions, rng.integers(0, 256, (count, 3))


def view_of(positions, **options):
    origin = positions.mean(axis=0)
    return fit_view(cloud_of(positions - origin, positions), size=(64, 48), **options), origin


def thinner_of(view, origin, most=1 << 20, cells=2.0):
    return Thinner(view, origin, FAR, np.ones(3), cells, most)


def cells_by_hand(view, origin, positions, cells):
    """The cell of each point, as ``grid_of`` says: column, line and place in depth."""
    camera = (positions - origin - view.eye) @ view.axes.T
    grid = grid_of(view, cells, FAR)
    across = view.middle[0] + view.focal * camera[:, 0] / camera[:, 2] + grid.beside
    down = view.middle[1] + view.focal * camera[:, 1] / camera[:, 2] + grid.beside
    mantissa, exponent = np.frexp(camera[:, 2])
    fine = 52 - grid.shift
    depth = np.floor((2 * mantissa - 1) * 2**fine) + exponent * 2**fine
    return np.stack([np.floor(across * cells), np.floor(down * cells), depth], axis=1)


def test_points_of_a_cell_become_their_mean():
    positions, values = some_points()
    view, origin = view_of(positions)
    thinner = thinner_of(view, origin)
    thinner.add(positions, values)
    found = thinner.result()
    cells, which = np.unique(
        cells_by_hand(view, origin, positions, 2.0), axis=0, return_inverse=True
    )
    assert len(found.points) == len(cells) < len(positions)
    count = np.bincount(which)
    means = np.stack([np.bincount(which, column) / count for column in positions.T], axis=1)
    colours = np.stack([np.bincount(which, column) / count for column in values.T], axis=1)
    away, order = cKDTree(found.positions).query(means)
    assert away.max() < 2e-7
    assert np.array_equal(np.sort(order), np.arange(len(found.points)))
    assert np.array_equal(found.points[order], count)
    assert np.allclose(found.values[order], colours)


def test_order_and_pieces_play_no_part():
    positions, values = some_points(2)
    view, origin = view_of(positions)
    whole = thinner_of(view, origin)
    whole.add(positions, values)
    pieces = thinner_of(view, origin)
    shuffled = np.random.default_rng(0).permutation(len(positions))
    for piece in np.array_split(shuffled, [1, 1, 700, 5000, 15_000]):
        pieces.add(positions[piece], values[piece])
    for one, other in zip(whole.result(), pieces.result(), strict=True):
        assert np.array_equal(one, other)
    assert pieces.points == len(positions)


@pytest.mark.parametrize("pieces", [1, 7])
def test_cells_that_are_too_many_are_merged_to_those_of_a_coarser_grid(pieces):
    positions, values = some_points(3)
    view, origin = view_of(positions)
    coarse = thinner_of(view, origin, cells=0.5)
    coarse.add(positions, values)
    merged = thinner_of(view, origin, most=len(coarse))
    for piece in np.array_split(np.arange(len(positions))[::-1], pieces):
        merged.add(positions[piece], values[piece])
    assert merged.grid == coarse.grid
    for one, other in zip(merged.result(), coarse.result(), strict=True):
        assert np.array_equal(one, other)


def test_points_that_no_cell_holds_are_counted():
    positions, _ = some_points(4, 100)
    view, origin = view_of(positions)
    ahead = view.axes[2]
    lost = np.array([
        view.eye - ahead,  # behind the eye
        view.eye + 2 * FAR * ahead,
        view.eye + ahead + 10 * view.axes[0],  # far to the right
        view.eye + ahead - 10 * view.axes[1],
        [np.nan, 0, 0],
        [np.inf, 0, 0],
    ])  # fmt: skip
    thinner = thinner_of(view, origin)
    thinner.add(np.concatenate([positions, lost + origin]), np.zeros((106, 3)))
    assert (thinner.points, thinner.outside) == (106, 6)
    assert thinner.result().points.sum() == 100


def test_values_that_are_not_finite_count_as_0():
    positions, _ = some_points(5, 4)
    view, origin = view_of(positions)
    thinner = thinner_of(view, origin)
    thinner.add(positions, np.array([[np.nan, 1, 2], [np.inf, 1, 2], [1e30, 1, 2], [7, 1, 2]]))
    assert sorted(thinner.result().values[:, 0]) == [0, 0, 0, 7]


def test_an_image_with_too_many_cells_is_refused():
    positions, _ = some_points(6, 10)
    view, _ = view_of(positions)
    with pytest.raises(InputError, match="too many cells"):
        grid_of(dataclasses.replace(view, width=200_000), 2.0, FAR)


def test_a_table_holds_what_a_dictionary_does():
    rng = np.random.default_rng(7)
    table, wanted = CellTable(2), {}
    for _ in range(6):
        keys = rng.choice([0, *(1 + rng.integers(0, 1 << 62, 50_000)), 5, 6], 60_000)
        values = rng.integers(-9, 9, (len(keys), 2))
        table.add(keys, None, values)
        for key, value in zip(keys.tolist(), values.tolist(), strict=True):
            if key:
                old = wanted.get(key, (0, 0, 0))
                wanted[key] = (old[0] + 1, old[1] + value[0], old[2] + value[1])
    means, points = table.means()
    assert len(table) == len(points) == len(wanted) > 200_000
    assert points.tolist() == [wanted[key][0] for key in sorted(wanted)]
    for k, column in enumerate(means):
        sums = [wanted[key][1 + k] for key in sorted(wanted)]
        assert np.array_equal(column, np.array(sums) / points)
