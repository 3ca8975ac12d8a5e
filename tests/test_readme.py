"""What the README shows in Python works as it stands there, and its figures are today's."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest

from splatline.contract.presets import PRESETS
from splatline.flow.area.budgets import read_budgets
from splatline.flow.area.devices import smallest_device

README = Path(__file__).parents[1] / "README.md"
TEXT = README.read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)


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
    named = re.search(r"`(sim\.[\w.]+)\(frame\)`", TEXT)[1]
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


def test_what_the_presets_take_is_what_is_recorded():
    cell = r"[^|]*\|"
    rows = re.findall(
        rf"^\| `([\w-]+)` \|{cell}{cell} ([\d,]+) \| ([\d,]+) \| ([\d,]+) \|", TEXT, re.MULTILINE
    )
    assert {name for name, *_ in rows} == {*PRESETS, "paper-rom"}
    budgets = read_budgets()
    for name, *told in rows:
        taken = [int(count.replace(",", "")) for count in told]
        assert taken == [budgets[name][kind] for kind in ("lut4", "ff", "bram")], name


def test_the_devices_of_the_presets_are_the_smallest():
    rows = re.findall(r"^\| `([\w-]+)` \| (XC2V\d+) \| (XC7A\w+) \|", TEXT, re.MULTILINE)
    assert {name for name, *_ in rows} == set(PRESETS)
    for name, *told in rows:
        counts = read_budgets()[name]
        assert told == [smallest_device(family, counts) for family in ("Virtex-II", "Artix-7")]


def test_what_the_paper_s_engine_takes_is_what_is_recorded():
    budgets = read_budgets()
    for kind, name in {
        "lut4": "4-input LUTs", "ff": "flip-flops", "bram": "block RAMs", "mult": "multipliers",
    }.items():  # fmt: skip
        row = re.search(rf"^\| {name} \| ([\d,]+) \| ([\d,]+) ", TEXT, re.MULTILINE)
        told = [int(count.replace(",", "")) for count in row.groups()]
        assert told == [budgets["paper"][kind], budgets["paper, pins"][kind]]
    on_axi = re.search(r"`--top axi`\) it takes ([\d,]+) LUTs and ([\d,]+) flip-flops", TEXT)
    told = [int(count.replace(",", "")) for count in on_axi.groups()]
    assert told == [budgets["paper, axi"][kind] for kind in ("lut4", "ff")]
