"""Parts of a parallel loop are dealt out to threads."""

import numba
import numpy as np
import pytest

from splatline.host import deal as deal_module
from splatline.host.deal import deal


@pytest.mark.parametrize(
    ("threads", "order"),
    [(1, [5, 6, 7, 8, 9]), (2, [5, 7, 9, 6, 8]), (3, [5, 8, 6, 9, 7]), (8, [5, 6, 7, 8, 9])],
)
def test_each_thread_gets_every_so_manieth_part(monkeypatch, threads, order):
    monkeypatch.setattr(deal_module.nb, "get_num_threads", lambda: threads)
    assert deal(np.arange(5, 10)).tolist() == order


def test_no_part_stays_none():
    assert deal(np.empty(0, np.int64)).shape == (0,)


def test_a_loop_gives_each_thread_a_run_of_turns():
    """What the dealing relies on."""
    threads = numba.get_num_threads()
    owners = np.empty(16 * threads, np.int64)
    _own(owners)
    assert numba.threading_layer() == "omp"
    assert (np.diff(owners) >= 0).all()
    assert np.bincount(owners, minlength=threads).tolist() == [16] * threads


@numba.njit(parallel=True)
def _own(owners):
    for turn in numba.prange(len(owners)):
        owners[turn] = numba.get_thread_id()
