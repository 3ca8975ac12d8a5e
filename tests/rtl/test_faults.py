"""Planted faults: the benches must notice a broken circuit, or they prove nothing."""

import functools
import re

import numpy as np
import pytest

from splatline.contract.presets import PAPER
from splatline.flow.verilog import convert, generate
from splatline.rtl.engine import Engine
from splatline.rtl.front.sequencer import Sequencer
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player import frames
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl import test_engine
from tests.rtl.front import test_sequencer
from tests.support.bench_config import run_bench
from tests.support.engines import mismatches, verilog
from tests.support.faults import LANE_WRITES, fault, switched
from tests.support.planted import plant, play_with
from tests.support.random_frames import shapes

pytestmark = pytest.mark.planted


def test_control_words_that_draw_are_noticed():
    edit = fault("dut", "control", "1'h0")
    with pytest.raises(SimulationError):
        run_bench(PAPER, Sequencer, test_sequencer.__file__, test="random_words", edit=edit)


BROKEN = {
    "no depth test": ("splatline.window.lane_2_1", "difference", LANE_WRITES),
    "a wrong mark": ("splatline.window.flush_scan.dirty_bits", "bit_1", "8'h01"),
    "lines leave early": ("splatline.window.flush_scan", "leaving", "1'h1"),
    "a line misplaced": ("splatline.tiler", "past_1", "1'h0"),
}


@functools.cache
def broken_engine():
    """Build the engine with these faults, for Icarus: small frames are quicker in it."""
    text = switched("splatline", list(BROKEN.values()))(verilog(PAPER))
    quickest = "icarus" if simulator.available("icarus") else "verilator"
    return wrap(text, PAPER, simulator_name=quickest)


@pytest.mark.parametrize("name", BROKEN)
def test_a_fault_in_the_engine_is_noticed(name):
    job = frames.Job(frame=shapes(np.random.default_rng(1), 400, 32, 24))
    try:
        (outcome,) = play_with(1 + list(BROKEN).index(name), [job], broken_engine())
    except SimulationError:  # words outside the image
        return
    assert mismatches(job, outcome)


MIXED = ("tables.idle", "sequencer.admit", "window.active")
"""Table writes taken within a frame, a frame before its tables, a raster before its frame."""


@functools.cache
def mixing_engine():
    faults = [(Engine, "elaborate", re.escape(n) + r"\.eq\(", r"\g<0>1 | ") for n in MIXED]
    with pytest.MonkeyPatch.context() as patch:
        edit = plant(patch, faults)
        return wrap(edit(generate(PAPER)[0]), PAPER)


def mixes_frames(number):
    rng = np.random.default_rng(10)
    jobs = [*test_engine.back_to_back(rng)[:2], *test_engine.rasters_ahead(rng)[:2]]
    try:
        outcomes = play_with(number, jobs, mixing_engine())
    except SimulationError:
        return True
    return any(map(mismatches, jobs, outcomes))


@pytest.mark.parametrize("signal", MIXED)
def test_an_engine_that_mixes_frames_is_noticed(signal):
    assert mixes_frames(1 + MIXED.index(signal))


def test_an_engine_without_a_fault_mixes_no_frames():
    assert not mixes_frames(0)


def test_a_port_that_breaks_the_stream_rules_is_noticed():
    """A raster port whose payload changes while it waits."""
    built = wrap(verilog_with_a_restless_raster(), PAPER)
    frame = shapes(np.random.default_rng(1), 200, 64, 48)
    with pytest.raises(SimulationError, match="stream rules"):
        frames.play([frames.Job(frame=frame, rates={"raster": 0.3})], built=built)


def verilog_with_a_restless_raster():
    """The engine behind a wrapper that flips a colour bit every cycle."""
    text = convert(Engine(PAPER), "inner")
    ports = "codewords", "tables", "initial", "raster"
    widths = {"codewords": 64, "tables": 44, "initial": 90, "raster": 90}
    lines = ["module splatline(input clk, input rst"]
    for name in ports:
        out = name == "raster"
        forward, backward = ("output", "input") if out else ("input", "output")
        lines.append(f", {forward} [{widths[name] - 1}:0] {name}__payload")
        lines.append(f", {forward} {name}__valid, {backward} {name}__ready")
    lines.append("); reg tick = 0; always @(posedge clk) tick <= !tick; wire [89:0] steady;")
    lines.append("assign raster__payload = steady ^ (90'd1 << 40) * tick;")
    links = [".clk(clk), .rst(rst), .raster__payload(steady)"]
    for name in ports:
        parts = ("valid", "ready") if name == "raster" else ("payload", "valid", "ready")
        links += [f".{name}__{part}({name}__{part})" for part in parts]
    lines.append(f"inner inner_engine({', '.join(links)}); endmodule")
    return text + "\n".join(lines)
