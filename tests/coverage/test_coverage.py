"""Counters that count what is there, and say what is not reached."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from splatline.sim.cosim import simulator
from tests.coverage import verilog
from tests.coverage.constants import find_constants
from tests.coverage.counts import fold, reached, read_keys
from tests.coverage.excuses import Excuse
from tests.coverage.modules import find_modules

ROOT = Path(__file__).parents[2]

DESIGN = """\
module top(a, y);
  input a;
  output y;
  wire [1:0] tied;
  assign tied = { 1'b0, a };
  top__part part(.a(tied), .y(y));
endmodule
module top__part(a, y);
  input [1:0] a;
  output y;
  assign y = a[0] & ~a[1];
endmodule
"""


def test_a_module_is_known_whatever_the_design_is_called():
    top, part = find_modules(DESIGN)
    renamed = find_modules("// a comment\n\n" + DESIGN.replace("top", "engine"))
    assert [each.digest for each in renamed] == [top.digest, part.digest]
    assert (part.name, part.place, part.first) == ("top__part", "part", 8)
    assert renamed[1].first == 10
    assert find_modules(DESIGN.replace("~a[1]", "a[1]"))[1].digest != part.digest


def test_bits_that_nothing_moves_are_found_through_ports():
    found = find_constants(DESIGN, "top")
    assert found == {"": {"tied[1]"}, "part": {"a[1]"}}


def test_counts_of_runs_add_up(tmp_path):
    (tmp_path / "dut.v").write_text(DESIGN)
    top, part = find_modules(DESIGN)
    point = "C '\x01f\x02/x/dut.v\x01l\x02{}\x01n\x029\x01t\x02{}\x01page\x02v_{}/{}"
    point += "\x01o\x02{}\x01h\x02t' {}\n"
    for number, counts in enumerate(([1, 0, 0], [0, 0, 7])):
        file = tmp_path / f"{number}.dat"
        file.write_text(
            "# SystemC::Coverage-3\n"
            + point.format(9, "toggle", "toggle", "top__part", "a[0]:0->1", counts[0])
            + point.format(9, "toggle", "toggle", "top__part", "a[1]:0->1", counts[1])
            + point.format(2, "toggle", "toggle", "top", "a:1->0", counts[2])
        )
        fold(file, tmp_path)
        assert not file.exists()
    assert read_keys(tmp_path, part.digest) == ["1 9 toggle a[0]:0->1", "1 9 toggle a[1]:0->1"]
    assert reached(tmp_path, part.digest).tolist() == [True, False]
    assert reached(tmp_path, top.digest).tolist() == [True]
    assert read_keys(tmp_path, "0" * 16) == []


def test_a_point_is_reached_or_constant_or_explained_or_missed(monkeypatch):
    because = Excuse(r"a top part toggle b:.*", "b stands still")
    monkeypatch.setattr(verilog, "EXCUSES", [because])
    reach = verilog.Reach()
    points = [
        ("1 9 toggle a[0]:0->1", True),
        ("1 9 toggle a[1]:0->1", False),
        ("2 9 toggle b:0->1", False),
        ("2 9 toggle c___05Fd:0->1", False),
        ("5 1 branch else", False),
    ]
    verilog._add(reach, "a top part", points, {"a[1]"})
    assert (reach.hit["toggle"], reach.total["toggle"], reach.constant) == (1, 3, 1)
    assert reach.explained == {because: 1}
    assert reach.missed == ["a top part toggle c___05Fd:0->1", "a top part branch line 5: else"]


def test_verilator_counts_into_the_folder(tmp_path):
    """A real run: the counters of a block that a bench of its own drives."""
    if not simulator.available("verilator"):
        pytest.skip("Verilator is not installed")
    call = [sys.executable, "-m", "pytest", "-q", "-p", "tests.coverage.collect"]
    call += ["-p", "no:cacheprovider", "tests/rtl/window/test_loader.py"]
    environment = {**os.environ, "SPLATLINE_COUNTS": str(tmp_path)}
    subprocess.run(call, cwd=ROOT, env=environment, check=True, capture_output=True)
    listed = [file.stem for file in tmp_path.glob("*.keys")]
    assert listed
    assert all(reached(tmp_path, digest).any() for digest in listed)
    assert not list(tmp_path.glob("*.dat"))


def test_compiled_statements_are_seen(tmp_path):
    """No word ends the frame here, and none is a control word."""
    program = """
import tests.coverage.compiled
import numpy as np
from splatline.contract.presets import PAPER
from splatline.sim.golden.kernel import index_lines, layout_of
index_lines(np.zeros(1, np.uint64), 4, layout_of(PAPER))
"""
    subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT,
        env={**os.environ, "SPLATLINE_COUNTS": str(tmp_path), "PYTHONPATH": str(ROOT)},
        check=True,
    )
    (listed,) = tmp_path.glob("*.lines")
    kernel = ROOT / "sim" / "golden" / "kernel.py"
    source = kernel.read_text().splitlines()
    hits = {}
    for line in listed.read_text().splitlines():
        name, number, hit = line.rsplit(" ", 2)
        if name == str(kernel):
            text = source[int(number) - 1].strip()
            hits[text] = hits.get(text, False) or hit == "1"
    assert hits["starts = np.zeros(lines + 1, np.int64)"]
    assert hits["continue"]
    assert not hits["starts[y + 1 :] = index"]
    assert not hits["return starts, True"]
