"""Planted faults between the engine and the frame writer: the top's bench must notice each."""

import pytest

from splatline.contract.presets import PAPER
from splatline.rtl.framebuffer.top import FrameBufferTop
from splatline.sim.cosim.simulator import available
from tests.rtl.framebuffer import top_bench
from tests.support import planted

pytestmark = pytest.mark.planted

FRAMES, ABORTED = "frames_behind_each_other", "an_aborted_frame"

FAULTS = {
    "beats of an aborted frame are drawn": (ABORTED, r"aborting & ~raster\.payload\.end", "0"),
    "an aborted frame does not end": (ABORTED, r"aborting & ~raster\.payload\.end", "aborting"),
    "a beat that waits is lost": (FRAMES, r"writer\.beats\.ready \| dropped", "1"),
    "a column is missing": (
        *(FRAMES, r"values\.last_column_value", "values.last_column_value - 1"),
    ),
    "a line is missing": (FRAMES, r"values\.last_line_value", "values.last_line_value - 1"),
}
"""By name: the test that must notice it, and the line of ``_raster`` that is rewritten."""


def test_each_fault_is_noticed():
    built = planted.build(
        lambda: FrameBufferTop(PAPER, 64),
        [(FrameBufferTop, "_raster", *fault) for _, *fault in FAULTS.values()],
        simulator="icarus" if available("icarus") else "verilator",
    )
    numbers = {name: (test, n) for n, (name, (test, *_)) in enumerate(FAULTS.items(), 1)}
    assert planted.find_wrong(PAPER, built, top_bench, numbers, whole=False) == []
