"""Rows of tiles as tasks of a real Dask cluster."""

import functools
import os
import signal

import numpy as np
import pytest

from splatline.contract.presets import RGB24
from splatline.host.large import cluster_tiles, plan
from splatline.host.large.cluster import open_cluster
from splatline.host.large.cluster_tiles import draw_tiles_on_cluster
from splatline.host.large.draw_parts import Drawing, draw_parts
from splatline.host.large.joined_tiles import tiles_of
from splatline.host.large.plan import make_plan
from splatline.host.visibility.view import fit_view
from tests.host.large.test_draw_parts import hills, write_las

pytest.importorskip("distributed", reason="needs the extra dask")
pytestmark = pytest.mark.filterwarnings("ignore")  # of sockets that Dask leaves to the system

DRAWING = Drawing(config=RGB24, samples=4)
SIZE = 700, 3000
"""Two tiles of ``rgb24`` across and six down."""


@pytest.fixture(scope="module")
def settled(tmp_path_factory):
    path = write_las(tmp_path_factory.mktemp("tiles") / "a.laz", *hills(40_000, 8))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plan, "PART_POINTS", 4_000)
        fit = functools.partial(fit_view, size=SIZE, up="z", orbit=(20, 80), zoom=1.3)
        return make_plan([path], None, fit, 16)


@pytest.fixture(scope="module")
def alone(settled):
    picture = tiles_of(settled, DRAWING, draw_parts(settled, DRAWING))
    return list(picture.map_rows(words)), picture.counts


def words(row):
    """The bytes of the code words of a row's tiles and samples, and where the tiles lie."""
    return [
        (tile.tile, [frame and frame.codewords.tobytes() for frame in tile.frames]) for tile in row
    ]


def test_rows_are_those_of_one_machine_and_are_made_as_they_are_taken(settled, alone, monkeypatch):
    assert len(settled.parts) == 10  # more than one task joins
    assert alone[1]["tiles"] >= 4
    with open_cluster("local") as client:
        most = cluster_tiles.AHEAD * sum(client.nthreads().values())
        submitted = []
        submit = client.submit

        def counted(function, *rest, **options):
            submitted.append(function)
            return submit(function, *rest, **options)

        monkeypatch.setattr(client, "submit", counted)
        told = []
        picture = draw_tiles_on_cluster(
            settled, DRAWING, client, progress=lambda stage, share: told.append(share)
        )
        assert told == sorted(told)
        assert told[-1] == 1.0
        found = []
        for number, row in enumerate(picture.map_rows(words), 1):
            found.append(row)
            shown = submitted.count(cluster_tiles._show)
            assert shown <= number - 1 + most
            assert number > 1 or shown < picture.grid.rows
    assert found == alone[0]
    assert picture.counts == alone[1]
    assert picture.parts.points == 40_000
    # A task reads each part; for each row one cuts each part, three join and one draws.
    assert picture.traffic.tasks == 10 + 7 * (10 + 3 + 1)
    assert 0 < picture.traffic.bytes < 3 * 4 * np.prod(SIZE) * 8


@pytest.mark.thorough
def test_a_worker_lost_among_the_rows_changes_nothing(settled, alone):
    with open_cluster("local") as client:
        workers = client.run(os.getpid)
        assert len(workers) > 1
        picture = draw_tiles_on_cluster(settled, DRAWING, client)
        held = client.run(lambda dask_worker: len(dask_worker.data))
        assert min(held.values()) > 0  # whichever is lost, its work is lost with it
        found = []
        for number, row in enumerate(picture.map_rows(words)):
            found.append(row)
            if number == 0:
                os.kill(next(iter(workers.values())), signal.SIGKILL)
    assert found == alone[0]
    assert picture.counts == alone[1]
