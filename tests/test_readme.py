"""What the README shows in Python works as it stands there."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest

README = Path(__file__).parents[1] / "README.md"
BLOCKS = re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)


@pytest.fixture
def scan(tmp_path, monkeypatch):
    """A ball in ``scan.ply`` of the current folder."""
    points = np.random.default_rng(1).normal(size=(500, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    head = "ply\nformat ascii 1.0\nelement vertex 500\n"
    head += "".join(f"property float {name}\n" for name in "xyz") + "end_header\n"
    rows = "\n".join(" ".join(map(str, row)) for row in points)
    (tmp_path / "scan.ply").write_text(f"{head}{rows}\n")
    monkeypatch.chdir(tmp_path)


def test_a_cloud_is_drawn_as_shown(scan):
    names = {}
    exec(BLOCKS[0], names)
    raster = names["raster"]
    assert raster.depth.shape == (512, 512)
    assert raster.colour.shape == (512, 512, 3)
    assert raster.drawn.any()
    named = re.search(r"`(sim\.[\w.]+)\(frame\)`", README.read_text())[1]
    assert callable(eval(named, names))


def test_what_the_driver_s_example_names_is_there():
    """It is run with other frames in ``test_axi``, as it takes a minute."""
    imports, (example,) = {}, [block for block in BLOCKS if "SimulatedDevice" in block]
    for node in ast.parse(example).body:
        if isinstance(node, ast.ImportFrom):
            exec(ast.unparse(node), imports)
    for name in ("write_tables", "draw"):
        assert f"engine.{name}(" in example
        assert callable(getattr(imports["Engine"], name))
