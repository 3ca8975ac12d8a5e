"""A command line in an empty folder, and a tiny cloud to give it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from splatline.cli.main import main
from splatline.cli.options import drawing as engines
from splatline.sim import golden
from splatline.sim.cosim.player.jobs import Outcome


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """The current folder: empty, and the test's own."""
    place = tmp_path / "here"
    place.mkdir()
    monkeypatch.chdir(place)
    return place


@pytest.fixture
def run(folder) -> Callable[..., Result]:
    """Runs ``splatline`` with some arguments."""

    def invoke(*arguments: object) -> Result:
        return CliRunner().invoke(
            main, [str(argument) for argument in arguments], prog_name="splatline"
        )

    return invoke


@pytest.fixture
def cloud(tmp_path) -> Path:
    """A sphere of 2,000 points with normals, coloured by place."""
    random = np.random.default_rng(7)
    normals = random.normal(size=(2000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    colours = np.round(127.5 * (normals + 1.0))
    path = tmp_path / "ball.csv"
    np.savetxt(
        path,
        np.hstack([normals, normals, colours]),
        fmt="%.6f",
        delimiter=",",
        header="x,y,z,nx,ny,nz,red,green,blue",
        comments="",
    )
    return path


@pytest.fixture
def verilog(monkeypatch):
    """Puts a simulation in place that draws with the golden renderer, then spoils some pixels."""
    spoilt: list[tuple[int, int]] = []
    calls = []

    def simulate(frame, stall, seed, tell=None):
        calls.append((stall, seed))
        if tell is not None:
            tell("run", 0.0)
        raster = golden.render(frame)
        for place in spoilt:
            raster.colour[place] ^= 1
        return Outcome([raster], np.zeros((0, 2), np.uint64), 4321, {"build": 1.0, "run": 2.0})

    monkeypatch.setattr(engines, "_simulate", simulate)
    return spoilt, calls
