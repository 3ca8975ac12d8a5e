"""What the manual shows in Python works as it stands there."""

import ast
import re
from pathlib import Path

import numpy as np
from PIL import Image

PAGE = Path(__file__).parents[2] / "docs/python.md"


def python_blocks(page):
    """Return the blocks of Python of a page."""
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


def write_scan(path):
    """Write a ball as PLY."""
    points = np.random.default_rng(1).normal(size=(500, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    head = "ply\nformat ascii 1.0\nelement vertex 500\n"
    head += "".join(f"property float {name}\n" for name in "xyz") + "end_header\n"
    rows = "\n".join(" ".join(map(str, row)) for row in points)
    path.write_text(f"{head}{rows}\n")


def draw_as_shown(block, folder, monkeypatch):
    """Run a block that draws ``scan.ply``; return its names."""
    write_scan(folder / "scan.ply")
    monkeypatch.chdir(folder)
    names = {}
    exec(block, names)
    raster = names["raster"]
    assert raster.depth.shape == (512, 512)
    assert raster.colour.shape == (512, 512, 3)
    assert raster.drawn.any()
    return names


def save_as_shown(block, folder, monkeypatch):
    """Run a block that saves a picture of ``scan.ply``; return its names."""
    write_scan(folder / "scan.ply")
    monkeypatch.chdir(folder)
    names = {}
    exec(block, names)
    with Image.open(folder / "scan.png") as picture:
        assert picture.size == (640, 480)
    return names


def test_a_picture_is_saved_as_shown(tmp_path, monkeypatch):
    names = save_as_shown(python_blocks(PAGE)[0], tmp_path, monkeypatch)
    for name in re.findall(r"`(splatline\.\w+)", PAGE.read_text(encoding="utf-8")):
        assert callable(eval(name, names))


def test_a_cloud_is_drawn_as_shown(tmp_path, monkeypatch):
    names = draw_as_shown(python_blocks(PAGE)[1], tmp_path, monkeypatch)
    text = PAGE.read_text(encoding="utf-8")
    named = re.findall(r"`((?:sim|host)\.[\w.]+)", text)
    assert len(named) > 3
    for name in named:
        assert eval(name, names) is not None


def test_what_the_driver_s_example_names_is_there():
    """It is run with other frames in ``test_axi``, as it takes a minute."""
    imports, example = {}, python_blocks(PAGE)[2]
    for node in ast.parse(example).body:
        if isinstance(node, ast.ImportFrom):
            exec(ast.unparse(node), imports)
    for name in ("write_tables", "draw"):
        assert f"engine.{name}(" in example
        assert callable(getattr(imports["Engine"], name))
