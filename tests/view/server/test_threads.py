"""OpenMP runs the loops of the server, unless the environment says otherwise."""

import os
import subprocess
import sys

import pytest

PROGRAM = """
import numba, numpy as np
from splatline.view.server.threads import prefer_openmp
prefer_openmp()
numba.njit(parallel=True)(lambda a: np.sin(a).sum())(np.ones(9))
print(numba.threading_layer())
"""


@pytest.mark.parametrize(("environment", "layer"), [("", "omp"), ("workqueue", "workqueue")])
def test_the_layer_is_openmp_or_the_one_that_is_asked_for(environment, layer):
    asked = {"NUMBA_THREADING_LAYER": environment} if environment else {}
    found = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env={**os.environ, **asked},
        capture_output=True,
        text=True,
        check=True,
    )
    assert found.stdout.strip() == layer
