"""Planted faults of the frame writer: its bench must notice each of them."""

import pytest

from splatline.contract.presets import PAPER
from splatline.rtl.framebuffer.burst_writer import BurstWriter
from splatline.rtl.framebuffer.frame_writer import FrameWriter
from splatline.rtl.framebuffer.raster_scan import RasterScan
from splatline.sim.cosim.simulator import available
from tests.rtl.framebuffer import writer_bench
from tests.rtl.framebuffer.writer_bench import BURST, OUTSTANDING
from tests.support import planted

pytestmark = pytest.mark.planted

TURNS, CHANGES = "frames_by_turns", "other_settings"
LONG, ERRORS = "lines_of_many_bursts", "responses_that_are_errors"

FAULTS = {
    "lines of the frame before last stay": (
        *(TURNS, RasterScan, "elaborate"),
        *(r"\(here \| dirty \| self\.rewrite\)", "(here | self.rewrite)"),
    ),
    "after a reset lines are skipped": (
        *(ERRORS, RasterScan, "elaborate"),
        *(r"\(here \| dirty \| self\.rewrite\)", "(here | dirty)"),
    ),
    "every line is written": (
        *(TURNS, RasterScan, "elaborate"),
        *(r"\(here \| dirty \| self\.rewrite\)", "1"),
    ),
    "both buffers have the same dirty lines": (
        *(TURNS, RasterScan, "_dirty_lines"),
        *(r"Cat\(line, self\.buffer\)", "Cat(line, 0)"),
    ),
    "a beat that comes late is background": (
        *(LONG, RasterScan, "elaborate"),
        *(r"issue\.eq\(self\.beats\.valid & room\)", "issue.eq(room)"),
    ),
    "a word is not taken and yet replaced": (
        *(TURNS, RasterScan, "elaborate"),
        *(r"\(~self\.words\.valid \| self\.words\.ready\)", "(1)"),
    ),
    "bursts end with lines alone": (
        *(LONG, BurstWriter, "_addresses"),
        *(r"word\.last \| index\.all\(\)", "word.last"),
    ),
    "a burst begins before its data are there": (
        *(LONG, BurstWriter, "_data"),
        *(r"fifo\.r_rdy & \(bursts != 0\)", "fifo.r_rdy"),
    ),
    "pixels beyond the last column are written": (
        *(TURNS, BurstWriter, "_data"),
        *(r"~partial \| self\.last_pixels\[pixel\]", "1"),
    ),
    "a picture is whole before its responses are in": (
        *(TURNS, BurstWriter, "elaborate"),
        *(r"~begun & \(pending == 0\)", "~begun"),
    ),
    "an error is none": (
        *(ERRORS, BurstWriter, "elaborate"),
        *(r"answer & bus\.bresp\[1\]", "answer & bus.bresp[0] & 0"),
    ),
    "the next frame's beats do not wait": (
        *(TURNS, FrameWriter, "elaborate"),
        *(r"slice_\.i\.ready & ~ended", "slice_.i.ready"),
    ),
    "both frames go to one buffer": (
        *(TURNS, FrameWriter, "elaborate"),
        *(r"back\.eq\(~back\)", "back.eq(back)"),
    ),
    "settings count later": (
        *(TURNS, FrameWriter, "_settings"),
        *(r"m\.If\(opening\)", "m.If(self.beats.valid)"),
    ),
    "another background leaves lines as they are": (
        *(CHANGES, FrameWriter, "_settings"),
        *(r"now\.as_value\(\) != settings\.as_value\(\)", "now.stride != settings.stride"),
    ),
    "a change counts for one buffer": (
        *(CHANGES, FrameWriter, "_rewrites"),
        *(r"unknown\.eq\(0b11\)", "unknown.eq(0b01)"),
    ),
    "what failed is not written anew": (
        *(ERRORS, FrameWriter, "_rewrites"),
        *(r"\.eq\(failed\)", ".eq(0)"),
    ),
    "background is black": (
        *(TURNS, FrameWriter, "_words"),
        *(r"Mux\(drawn, rgb, settings\.background\)", "Mux(drawn, rgb, 0)"),
    ),
}
"""By name: the test that must notice it, and the line that is rewritten."""


def test_each_fault_is_noticed():
    built = planted.build(
        lambda: FrameWriter(PAPER, 64, burst=BURST, outstanding=OUTSTANDING),
        [fault for _, *fault in FAULTS.values()],
        simulator="icarus" if available("icarus") else "verilator",
    )
    numbers = {name: (test, n) for n, (name, (test, *_)) in enumerate(FAULTS.items(), 1)}
    assert planted.find_wrong(PAPER, built, writer_bench, numbers, whole=False) == []
