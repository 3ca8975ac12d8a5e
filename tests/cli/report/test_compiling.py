"""The line that says that functions are being compiled, in fresh processes with their own cache."""

import os
import subprocess
import sys

import pytest

from splatline.cli.bench.stability import measure as bench_stability
from splatline.cli.commands import encode_play, film, info, render, view
from splatline.cli.report.compiling import LINE
from splatline.contract.errors import InputError

SCRIPT = """
import sys
import numpy as np
from splatline.cli.report import compiling
compiling.SOON = float(sys.argv[1])
compiling.FUNCTIONS = 4
compiling.tell_compiling()
compiling.tell_compiling()
from splatline.host.cloud.curve_order import sort_along_curve
sort_along_curve(np.eye(3))
"""


def test_it_is_said_once_and_not_when_the_cache_has_the_functions(tmp_path):
    def said(soon):
        ran = subprocess.run(
            [sys.executable, "-c", SCRIPT, str(soon)],
            cwd=tmp_path,
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")},
            capture_output=True,
            text=True,
            check=False,
        )
        assert ran.returncode == 0, ran.stderr
        return ran.stderr.splitlines()

    first, *shares = said(0.0)
    assert first == LINE
    assert shares == [f" {share} %  Compiling ..." for share in (25, 50, 75)]
    assert said(0.0) == []


@pytest.mark.parametrize(
    ("command", "module"),
    [
        (["render"], render),
        (["encode", "-o", "a.frame"], encode_play),
        (["film", "-o", "a.webp"], film),
        (["view", "--no-browser"], view),
        (["info", "a.ply"], info),
        (["bench", "stability"], bench_stability),
    ],
)
def test_each_command_that_may_compile_says_it(run, monkeypatch, command, module):
    def tell():
        raise InputError("it would be told")

    monkeypatch.setattr(module, "tell_compiling", tell)
    assert run(*command).stderr == "splatline: it would be told\n"
