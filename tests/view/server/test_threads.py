"""OpenMP runs the loops of the server, unless the environment says otherwise."""

import numba
import pytest

from splatline.view.server.threads import prefer_openmp

USUAL = ["tbb", "omp", "workqueue"]


@pytest.mark.parametrize("asked", [None, "NUMBA_THREADING_LAYER", "NUMBA_THREADING_LAYER_PRIORITY"])
def test_openmp_is_first_unless_the_environment_says_otherwise(asked, monkeypatch):
    monkeypatch.setattr(numba.config, "THREADING_LAYER_PRIORITY", USUAL)
    for name in ("NUMBA_THREADING_LAYER", "NUMBA_THREADING_LAYER_PRIORITY"):
        monkeypatch.delenv(name, raising=False)
    if asked is not None:
        monkeypatch.setenv(asked, "workqueue")
    prefer_openmp()
    first = numba.config.THREADING_LAYER_PRIORITY[0]
    assert first == ("omp" if asked is None else "tbb")
    assert set(numba.config.THREADING_LAYER_PRIORITY) == set(USUAL)
