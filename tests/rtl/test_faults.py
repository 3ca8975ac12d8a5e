"""Planted faults: the benches must notice a broken circuit, or they prove nothing."""

import inspect
import re
import textwrap

import numpy as np
import pytest
import test_bank
import test_decoder
import test_engine
import test_lane
import test_lane_window
import test_marks
import test_planar_bank
import test_scatter
import test_sequencer
import test_tiler
import test_walker
import test_window
from presets import run_bench as run_preset
from random_frames import shapes

from splatline.rtl.bank import Bank
from splatline.rtl.decoder import Decoder
from splatline.rtl.engine import Engine
from splatline.rtl.format import BAYER, PAPER, PRESETS
from splatline.rtl.lane import Lane
from splatline.rtl.lane_window import LaneWindow
from splatline.rtl.marks import Marks
from splatline.rtl.planar_bank import PlanarBank
from splatline.rtl.scatter import Scatter
from splatline.rtl.sequencer import Sequencer
from splatline.rtl.tiler import Tiler
from splatline.rtl.walker import Walker
from splatline.rtl.window import Window
from splatline.sim import golden
from splatline.sim.cosim import frames, simulator
from splatline.sim.cosim.blocks import run_bench
from splatline.sim.cosim.simulator import SimulationError


def fault(module, signal, value):
    """An edit that fixes a signal of a module's Verilog at a value."""

    def edit(text):
        begin = re.search(rf"^module \\?{re.escape(module)} ?\(", text, re.MULTILINE).start()
        end = text.index("endmodule", begin)
        body, count = re.subn(
            rf"^(  assign \\?{re.escape(signal)} ?=)[^;]*;",
            rf"\g<1> {value};",
            text[begin:end],
            flags=re.MULTILINE,
        )
        assert count == 1, f"{module} has no {signal} to break"
        return text[:begin] + body + text[end:]

    return edit


BLOCK_FAULTS = [
    pytest.param(
        Bank, test_bank, "random_requests", fault("dut", "passes_2", "1'h1"), id="no depth test"
    ),
    pytest.param(
        Bank, test_bank, "random_requests", fault("dut", "conflict", "1'h0"), id="no conflict"
    ),
    pytest.param(
        Sequencer,
        test_sequencer,
        "random_words",
        fault("dut", "control", "1'h0"),
        id="no control words",
    ),
    pytest.param(
        Decoder, test_decoder, "all_columns", fault("dut", "words_left", "8'h7f"), id="right border"
    ),
    pytest.param(Scatter, test_scatter, "free_banks", fault("dut", "end_3", "2'h3"), id="mask"),
    pytest.param(
        Window,
        test_window,
        "with_stalls",
        fault("dut.loader", "loaded", "1'h1"),
        id="load late",
    ),
    pytest.param(
        Window, test_window, "with_stalls", fault("dut.ring", "clean", "1'h1"), id="line dropped"
    ),
]


@pytest.mark.parametrize(("component", "bench", "test", "edit"), BLOCK_FAULTS)
def test_a_fault_in_a_block_is_noticed(component, bench, test, edit):
    with pytest.raises(SimulationError):
        run_bench(component(PAPER), bench.__file__, test=test, edit=edit)


LANE_WINDOW_FAULTS = [
    (Lane, test_lane, "random_requests", "passes", "taken[0]", "no depth test"),
    (Tiler, test_tiler, "right_border", "words_left", "8'h3f", "right border"),
    (Tiler, test_tiler, "one_tile_a_cycle", "past_2", "1'h0", "a line misplaced"),
    (
        Marks,
        test_marks,
        "random_touches",
        "write__en",  # of even pairs on lines that are a multiple of 4: cleared with any other
        "take | (words[1] ? touch[1] & words[0] : touch[0] | (touch[1] & ~words[0]))",
        "marks clear too much",
    ),
    (Marks, test_marks, "random_touches", "write__data", "take ? 8'h00 : bit_0", "marks forget"),
    (
        Walker,
        test_walker,
        "drawn_words_are_asked_for_once_and_in_order",
        "left",
        "~flush__valid & (next_stretch == 3)",
        "last stretch skipped",
    ),
    (
        Walker,
        test_walker,
        "drawn_words_are_asked_for_once_and_in_order",
        "clean",
        "1'h1",
        "lines skipped",
    ),
    (Walker, test_walker, "nothing_leaves_unasked", "leaving", "1'h1", "lines leave early"),
]


@pytest.mark.parametrize(
    ("component", "bench", "test", "signal", "value"),
    [pytest.param(*fault[:5], id=fault[5]) for fault in LANE_WINDOW_FAULTS],
)
def test_a_fault_in_the_window_of_lanes_is_noticed(component, bench, test, signal, value):
    edit = fault("dut", signal, value)
    with pytest.raises(SimulationError):
        run_preset(PAPER, component, bench.__file__, test=test, edit=edit)


WAIT = r"(?<![\w.])loaded\.eq"  # the register, not what the loader says
REWRITTEN = [
    (LaneWindow, "elaborate", r"conflict\.eq\(\(drawn", "conflict.eq((0 & drawn", "with_stalls"),
    (Tiler, "_lines", r"(groups\.eq\(.*) \+ 1\)", r"\1 + 2)", "upper_and_lower_border"),
    (Walker, "elaborate", r" & self\.enable\b", "", "nothing_leaves_unasked"),
    (LaneWindow, "elaborate", WAIT + r"\(.*?\)", "loaded.eq(0)", "nonsense_in_the_initial_raster"),
    (LaneWindow, "elaborate", WAIT + r"(\(.*?) \| sweeping", r"loaded.eq\1", "reset_in_the_middle"),
]


@pytest.mark.parametrize(
    ("component", "method", "pattern", "replacement", "test"),
    REWRITTEN,
    ids=[
        "no conflict",
        "lower border",
        "marks taken unasked",
        "no wait after a load",
        "nor after the sweep",
    ],
)
def test_a_rewritten_window_of_lanes_is_noticed(
    monkeypatch, component, method, pattern, replacement, test
):
    """Faults in what has no name in the Verilog."""
    source = textwrap.dedent(inspect.getsource(getattr(component, method)))
    broken, count = re.subn(pattern, replacement, source)
    assert count == 1
    scope = dict(vars(inspect.getmodule(component)))
    exec(broken, scope)
    monkeypatch.setattr(component, method, scope[method])
    benches = {Tiler: test_tiler, Walker: test_walker, LaneWindow: test_lane_window}
    with pytest.raises(SimulationError):
        run_preset(PAPER, component, benches[component].__file__, test=test)


PLANE_FAULTS = [
    ("rgb18", PlanarBank, "late_colour_write", "1'h0", "plane 1 not written"),
    ("rgb24", PlanarBank, "late_depth_write", "1'h0", "plane 2 not written"),
    ("rgb18", PlanarBank, "conflict", "same", "requests meet the planes"),
    ("rgb18", Window, "paint.may_draw", "1'h1", "drawn after a load"),
    ("rgb24", Window, "paint.may_load", "1'h1", "loaded after a draw"),
    ("rgb18", Window, "emitter.ready", "1'h1", "flushed words meet"),
]


@pytest.mark.parametrize(
    ("preset", "component", "signal", "value"),
    [pytest.param(*fault[:4], id=fault[4]) for fault in PLANE_FAULTS],
)
def test_a_fault_in_the_planes_is_noticed(preset, component, signal, value):
    """Either a plane is lost, or two words meet in what planes share."""
    *inner, name = signal.split(".")
    bench = test_window if component is Window else test_planar_bank
    test = "in_short" if component is Window else "random_requests"
    with pytest.raises(SimulationError):
        run_preset(
            PRESETS[preset],
            component,
            bench.__file__,
            test=test,
            edit=fault(".".join(["dut", *inner]), name, value),
        )


def test_a_wrong_threshold_is_noticed(monkeypatch):
    from splatline.rtl import paint

    wrong = [list(row) for row in BAYER]
    wrong[2][1] += 1
    monkeypatch.setattr(paint, "BAYER", wrong)
    with pytest.raises(SimulationError):
        run_preset(PRESETS["dither"], Window, test_window.__file__, test="in_short")


@pytest.mark.parametrize(
    ("preset", "edit"),
    [
        pytest.param(
            "wide", fault("splatline.window.bank_5", "conflict", "1'h0"), id="a bank's conflict"
        ),
        pytest.param(
            "paper", fault("splatline.window.lane_2_1", "passes", "1'h1"), id="no depth test"
        ),
        pytest.param(
            "paper", fault("splatline.window.walker.marks", "bit_1", "8'h01"), id="a wrong mark"
        ),
        pytest.param(
            "paper", fault("splatline.window.walker", "leaving", "1'h1"), id="lines leave early"
        ),
        pytest.param("paper", fault("splatline.decoder", "past_1", "1'h0"), id="a line misplaced"),
    ],
)
def test_a_fault_in_the_engine_is_noticed(monkeypatch, preset, edit):
    """One bank of eight, or the window of lanes, forgets its conflicts: elements that touch mix."""
    from splatline.rtl import verilog

    whole = verilog.generate

    def broken(config, name="splatline"):
        text, sidecar = whole(config, name)
        return edit(text), sidecar

    monkeypatch.setattr(verilog, "generate", broken)
    frame = shapes(np.random.default_rng(1), 2000, 64, 48, config=PRESETS[preset])
    try:
        outcome = frames.play([frames.Job(frame=frame)])[0]
    except SimulationError:  # words outside the image
        return
    assert outcome.raster.mismatches(golden.render(frame)) > 0


@pytest.mark.parametrize("signal", ["idle", "admit"])
def test_an_engine_that_mixes_frames_is_noticed(monkeypatch, signal):
    """Table writes taken in the middle of a frame, or a frame let in before its tables."""
    from splatline.rtl import engine

    source = inspect.getsource(engine.Engine.elaborate)
    expression = {"idle": "tables.idle.eq(", "admit": "sequencer.admit.eq("}[signal]
    assert source.count(expression) == 1
    broken = textwrap.dedent(source).replace(expression, f"{expression}1 | ")
    scope = dict(vars(engine))
    exec(broken, scope)
    monkeypatch.setattr(engine.Engine, "elaborate", scope["elaborate"])
    jobs = test_engine.back_to_back(np.random.default_rng(10))[:2]
    try:
        outcomes = frames.play(jobs)
    except SimulationError:
        return
    wrong = 0
    for job, outcome in zip(jobs, outcomes, strict=True):
        wrong += outcome.raster.mismatches(golden.render(job.frame, job.initial))
        wrong += outcome.following.mismatches(golden.render(job.followed_by))
    assert wrong > 0


def test_a_port_that_breaks_the_stream_rules_is_noticed():
    """A raster port whose payload changes while it waits."""
    from importlib import resources

    text = verilog_with_a_restless_raster()
    sources = {"splatline.v": text}
    for name in ("stream_source.v", "stream_sink.v", "stream_check.v", "frame_player.v"):
        sources[name] = resources.files("splatline.sim.cosim").joinpath(name).read_text()
    parameters = {"TABLE_BITS": PAPER.table_address.end, "RASTER_BITS": PAPER.raster_end.end}
    built = simulator.build(sources, "frame_player", parameters=parameters)
    frame = shapes(np.random.default_rng(1), 200, 64, 48)
    with pytest.raises(SimulationError, match="stream rules"):
        frames.play([frames.Job(frame=frame, rates={"raster": 0.3})], built=built)


def verilog_with_a_restless_raster():
    """The engine behind a wrapper that flips a colour bit every cycle."""
    from splatline.rtl.verilog import convert

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
