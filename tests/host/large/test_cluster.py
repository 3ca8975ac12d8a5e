"""Parts of a cloud on the processes of a real Dask cluster."""

import functools
import os
import shutil
import signal
import threading
import time
import warnings

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.presets import RGB24
from splatline.host.large import cluster, plan
from splatline.host.large.cluster import draw_on_cluster, open_cluster
from splatline.host.large.draw_parts import Drawing, draw_parts, frames_of
from splatline.host.large.plan import make_plan
from splatline.host.visibility.view import fit_view
from tests.host.large.test_draw_parts import hills, write_las

distributed = pytest.importorskip("distributed", reason="needs the extra dask")
pytestmark = pytest.mark.filterwarnings("ignore")  # of sockets that Dask leaves to the system


@pytest.fixture(scope="module")
def scans(tmp_path_factory):
    """Two files of eight parts."""
    folder = tmp_path_factory.mktemp("scans")
    return [write_las(folder / f"{seed}.laz", *hills(40_000, seed)) for seed in (1, 2)]


@pytest.fixture(scope="module")
def settled(scans):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plan, "PART_POINTS", 10_000)
        return make_plan(scans, None, functools.partial(fit_view, size=(96, 80), up="z"), 128)


@pytest.fixture(scope="module")
def client():
    with open_cluster("local") as client:
        yield client


@pytest.fixture(scope="module")
def alone(settled):
    drawing = Drawing(samples=4)
    joined = draw_parts(settled, drawing)
    return frames_of(settled, drawing, joined), joined


def same(one, other):
    return all(
        np.array_equal(a.codewords, b.codewords) and a.counts == b.counts
        for a, b in zip(one, other, strict=True)
    )


def test_a_cluster_draws_what_one_machine_draws(settled, client, alone):
    told = []
    drawing = Drawing(samples=4)
    parts, traffic = draw_on_cluster(
        settled, drawing, client, progress=lambda stage, share: told.append(share)
    )
    assert same(frames_of(settled, drawing, parts), alone[0])
    assert parts.dropped == alone[1].dropped
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert traffic.tasks == 8 + 7
    # At most a word for each pixel of each sample, from each task.
    assert 0 < traffic.bytes <= traffic.tasks * 4 * 96 * 80 * 8
    again, _ = draw_on_cluster(settled, drawing, client)
    assert same(frames_of(settled, drawing, again), alone[0])


def test_a_lost_worker_s_work_is_done_again(settled, alone):
    with open_cluster("local") as client:
        workers = client.run(os.getpid)
        assert len(workers) > 1
        killed = threading.Event()

        def kill_one(stage, share):
            if share > 0.2 and not killed.is_set():
                killed.set()
                os.kill(next(iter(workers.values())), signal.SIGKILL)

        drawing = Drawing(samples=4)
        parts, _ = draw_on_cluster(settled, drawing, client, progress=kill_one)
        assert killed.is_set()
        assert same(frames_of(settled, drawing, parts), alone[0])
        until = time.monotonic() + 30
        while len(client.run(os.getpid)) < len(workers) and time.monotonic() < until:
            time.sleep(0.1)
        assert set(client.run(os.getpid).values()) != set(workers.values())


def test_a_file_that_a_worker_lacks_is_one_line(scans, settled, client, tmp_path):
    gone = shutil.copy(scans[0], tmp_path / "gone.laz")
    away = make_plan([gone], None, functools.partial(fit_view, size=(64, 64)), 128)
    gone.unlink()
    with pytest.raises(InputError, match=r"gone\.laz: cannot be read: .* \(on the worker tcp://"):
        draw_on_cluster(away, Drawing(), client)
    usable, _ = draw_on_cluster(settled, Drawing(), client)
    assert usable.points == 80_000


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "no such://place", "127.0.0.1:1"])
def test_an_address_at_which_no_scheduler_answers_is_one_line(monkeypatch, address):
    monkeypatch.setattr(cluster, "PATIENCE", 2)
    with (
        pytest.raises(
            InputError, match=r"no Dask scheduler answers at '.*'.* or take --dask local"
        ),
        open_cluster(address),
    ):
        pass


def test_two_clusters_of_one_machine_do_not_disturb_each_other():
    with warnings.catch_warnings(), open_cluster("local") as one:
        warnings.filterwarnings("error", message="Port .* is already in use")
        with open_cluster("local") as other:
            assert one.submit(int, 1).result() + other.submit(int, 2).result() == 3


def test_a_scheduler_without_workers_is_one_line(monkeypatch):
    monkeypatch.setattr(cluster, "PATIENCE", 2)
    empty = distributed.LocalCluster(n_workers=0, dashboard_address=None)
    lines = pytest.raises(InputError, match="has no workers; start some: dask")
    with empty, lines, open_cluster(empty.scheduler_address):
        pass


def test_unlike_versions_are_one_line(client, monkeypatch):
    address = client.scheduler.address
    with open_cluster(address) as other:
        assert other.scheduler.address == address
    here = cluster._versions()
    monkeypatch.setattr(cluster, "_versions", lambda: {**here, "numba": "0.1"})
    answers = {"tcp://far:1": here}
    monkeypatch.setattr(distributed.Client, "run", lambda *_, **__: answers)
    with (
        pytest.raises(InputError, match=r"tcp://far:1 has numba .*, this machine 0\.1; install"),
        open_cluster(address),
    ):
        pass
    answers["tcp://far:1"] = ModuleNotFoundError("No module named 'splatline'")
    with (
        pytest.raises(InputError, match="cannot import splatline: No module named 'splatline'"),
        open_cluster(address),
    ):
        pass


def test_without_dask_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with (
        pytest.raises(InputError, match=r"--dask needs distributed: pip install '\.\[dask\]'"),
        open_cluster("local"),
    ):
        pass


def test_the_configuration_travels(scans, client):
    small = make_plan(scans[:1], None, functools.partial(fit_view, size=(40, 40)), 128)
    config = RGB24.replace(name="rgb24")
    parts, _ = draw_on_cluster(small, Drawing(config=config), client)
    assert parts.frames[0].config == config
