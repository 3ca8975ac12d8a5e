"""Normals and closing radii from one search of neighbours."""

import dataclasses

import numpy as np
import pytest

from splatline.host.cloud import measure_cells
from splatline.host.cloud.normals import estimate_normals
from splatline.host.cloud.spacing import measure_discs
from splatline.host.files.assemble import Columns, assemble_cloud

RNG = np.random.default_rng(5)
CLOUDS = {
    "surface": RNG.uniform(0, 1, (20_000, 3)) * (1, 1, 0.02),
    "volume": RNG.normal(size=(5000, 3)),
    "duplicates": np.repeat(RNG.normal(size=(2000, 3)), 3, axis=0),
    "line": np.linspace(0, 1, 3000)[:, np.newaxis] * (1.0, 2.0, 3.0),
    "uneven": RNG.normal(size=(8000, 3)) ** 3,
    "few": RNG.normal(size=(7, 3)),
    "one": np.ones((5, 3)),
}


@pytest.mark.parametrize("name", CLOUDS)
def test_both_are_those_of_two_searches_bit_for_bit(name):
    cloud = assemble_cloud(Columns(CLOUDS[name]), "test")
    assert cloud.closing is not None
    assert np.array_equal(cloud.normals, estimate_normals(cloud.positions))
    bare = dataclasses.replace(cloud)
    assert bare.closing is None
    for once, again in zip(measure_discs(cloud), measure_discs(bare), strict=True):
        assert np.array_equal(once, again)


def test_the_kept_radii_are_used(monkeypatch):
    cloud = assemble_cloud(Columns(CLOUDS["volume"]), "test")
    monkeypatch.setattr("splatline.host.cloud.spacing.measure_cells", None)
    assert len(measure_discs(cloud).radii) == 5000
    with pytest.raises(TypeError):
        measure_discs(dataclasses.replace(cloud))


def test_progress_is_told_once_for_both(monkeypatch):
    monkeypatch.setattr("splatline.host.cloud.cells.AT_ONCE", 1000)
    shares, later = [], []
    cloud = assemble_cloud(Columns(CLOUDS["volume"]), "test", progress=shares.append)
    measure_discs(cloud, progress=later.append)
    assert len(shares) > 10
    assert shares == sorted(shares)
    assert (shares[0], shares[-1], later) == (0.0, 1.0, [])


@pytest.mark.parametrize("case", ["normals", "some normals", "a stray"])
def test_nothing_is_kept_where_it_would_be_of_no_use(case):
    points = CLOUDS["volume"]
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    if case == "some normals":
        normals[::2] = 0.0
    if case == "a stray":
        points = np.append(points, [[1e6, 0, 0]], axis=0)
    columns = Columns(points, normals if "normals" in case else None)
    assert assemble_cloud(columns, "test").closing is None


def test_without_needed_normals_they_are_left_as_they_are():
    cloud = assemble_cloud(Columns(CLOUDS["volume"]), "test")
    normals = np.full((len(cloud.cells.first), 3), 7, np.float32)
    measure_cells.measure_cells(cloud.cells, normals, np.zeros(len(normals), np.bool_))
    assert (normals == 7).all()
