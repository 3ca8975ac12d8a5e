"""Planted faults: the benches must notice a broken circuit, or they prove nothing."""

import inspect
import re
import textwrap

import numpy as np
import pytest
import test_bank
import test_bank_marks
import test_bank_walker
import test_colour
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
from splatline.rtl.bank_marks import BankMarks
from splatline.rtl.bank_walker import BankWalker
from splatline.rtl.colour import ColourUnit
from splatline.rtl.decoder import Decoder
from splatline.rtl.engine import Engine
from splatline.rtl.format import BAYER, PAPER, PRESETS
from splatline.rtl.lane import Lane
from splatline.rtl.lane_emitter import LaneEmitter
from splatline.rtl.lane_window import LaneWindow
from splatline.rtl.loader import Loader
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
]


@pytest.mark.parametrize(("component", "bench", "test", "edit"), BLOCK_FAULTS)
def test_a_fault_in_a_block_is_noticed(component, bench, test, edit):
    with pytest.raises(SimulationError):
        run_bench(component(PAPER), bench.__file__, test=test, edit=edit)


ASKS = "drawn_words_are_asked_for_once_and_in_order"
BANK_WINDOW_FAULTS = [
    (BankMarks, test_bank_marks, "a_mark_a_word", "busy", "1'h0", "marks read while in use"),
    (BankMarks, test_bank_marks, "a_mark_a_word", "clear_5", "1'h0", "marks stay"),
    (BankMarks, test_bank_marks, "a_mark_a_word", "clear_5", "take | wipe", "marks clear too much"),
    (BankWalker, test_bank_walker, ASKS, "single", "1'h1", "the rest of a stretch is lost"),
    (BankWalker, test_bank_walker, ASKS, "passed", "reading", "a stretch is lost"),
    (BankWalker, test_bank_walker, ASKS, "half", "1'h0", "words of one half alone"),
    (
        BankWalker,
        test_bank_walker,
        "nothing_leaves_unasked",
        "leaving",
        "1'h1",
        "lines leave early",
    ),
    (Window, test_window, "in_short", "walker.leaving", "1'h1", "lines leave the window early"),
    (BankWalker, test_bank_walker, ASKS, "marks.clear_2", "1'h0", "words are asked for twice"),
    (Window, test_window, "in_short", "walker.clean", "1'h1", "the end comes early"),
    (Window, test_window, "in_short", "bank_3.drawn", "1'h0", "a bank marks nothing"),
    (Window, test_window, "in_short", "emitter.raster__valid", "emit_valid", "background is sent"),
]


@pytest.mark.parametrize(
    ("component", "bench", "test", "signal", "value"),
    [pytest.param(*fault[:5], id=fault[5]) for fault in BANK_WINDOW_FAULTS],
)
def test_a_fault_in_the_window_of_banks_is_noticed(component, bench, test, signal, value):
    *inner, name = signal.split(".")
    with pytest.raises(SimulationError):
        run_preset(
            PRESETS["wide"],
            component,
            bench.__file__,
            test=test,
            edit=fault(".".join(["dut", *inner]), name, value),
        )


LANE_WRITES = "{ taken[0] | taken[1], 11'h0 }"
"""In place of a lane's comparison: it writes whatever it is asked to draw or to clear."""

LANE_WINDOW_FAULTS = [
    (Lane, test_lane, "random_requests", "difference", LANE_WRITES, "no depth test"),
    (
        Lane,
        test_lane,
        "nearer_wins_and_equal_stays",
        "difference",
        "{ taken[1:0], old[8:0] } + { 1'h0, ~{ 2'h1, new[8:0] } } + 1",
        "ties drawn",
    ),
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


WALK = "drawn_words_are_asked_for_once_and_in_order"
LOADING = r" & ~drawn & ~cleared & ~loaded"  # nothing tells whether a load waits for what is drawn
REWRITTEN = {
    "no conflict": (LaneWindow, r"conflict\.eq\(\(drawn", "conflict.eq((0 & drawn", "with_stalls"),
    "drawn while marks are taken": (
        LaneWindow,
        r"loader\.loaded & ~walker\.taking",
        "loader.loaded",
        "with_stalls",
    ),
    "loaded while marks are taken": (
        LaneWindow,
        r"~sweeping & ~walker\.taking",
        "~sweeping",
        "with_stalls",
    ),
    "no wait after a load": (
        LaneWindow,
        LOADING,
        " & ~drawn & ~cleared",
        "nonsense_in_the_initial_raster",
    ),
    "no wait after the sweep": (LaneWindow, "running & ~swept", "running", "reset_in_the_middle"),
    "nor for a load": (
        LaneWindow,
        r"cleared\.eq\(flushing \| sweeping",
        "cleared.eq(flushing",
        "words_right_behind_the_sweep",
    ),
    "a load taken too early": (
        LaneWindow,
        r"loader\.o\.ready\.eq\(loaded",
        "loader.o.ready.eq(loading",
        "with_stalls",
    ),
    "a load offered again": (
        Loader,
        r" & ~\(self\.o\.valid & self\.o\.ready\)\)",
        ")",
        "with_stalls",
    ),
    "loaded beyond the window": (
        Loader,
        r"waiting & ~drop & in_window",
        "waiting & ~drop",
        "words_right_behind_what_leaves",
    ),
    "background holds all up": (
        LaneEmitter,
        r" \| dropped\)",
        ")",
        "a_raster_that_waits_for_its_words",
    ),
    "dropped behind background": (LaneEmitter, r"(~emit\.end) & ~take\)", r"\1)", "with_stalls"),
    "marks taken unasked": (Walker, r" & self\.enable\b", "", "nothing_leaves_unasked"),
    "marks taken twice": (Walker, r" & ~self\.taking\)", ")", WALK),
    "marks taken too early": (Walker, r"walking & ~pairs\.any\(\)", "walking", WALK),
    "a line left too early": (Walker, r"left\.eq\(~asking & ", "left.eq(", WALK),
    "a pair of the next stretch": (Walker, r"next_stretch - 1", "next_stretch", WALK),
    "lower border": (
        Tiler,
        r"(groups\.eq\(.*) \+ 1\)",
        r"\1 + 2)",
        "upper_and_lower_border",
        "_lines",
    ),
    "no wait for lines": (Tiler, r"\bmay\.eq\(", "may.eq(1 | ", "a_window_that_lags_behind"),
    "upper lines too early": (
        Tiler,
        r"low > SIDE",
        "low > SIDE - 1",
        "a_window_that_lags_behind",
    ),
    "lower lines too early": (
        Tiler,
        r"low > 2 \* SIDE",
        "low > 2 * SIDE - 1",
        "a_window_that_lags_behind",
    ),
    "lines too late": (
        Tiler,
        r"low > SIDE",
        "low > SIDE + 1",
        "a_tile_comes_as_soon_as_its_lines",
    ),
    "another's lines": (Tiler, r"near\.eq\(0\)", "near.eq(near)", "a_window_that_lags_behind"),
    "top once it goes": (Tiler, r"Elif\(there\)", "Elif(there & may)", "a_window_that_lags_behind"),
    "top of the last frame": (Tiler, r"top\.eq\(-SIDE\)", "top.eq(top)", "end_tokens"),
    "top outlasts a reset": (
        Tiler,
        r"init=-SIDE\)",
        "init=-SIDE, reset_less=True)",
        "reset_in_the_middle",
    ),
    "colour moves too late": (Tiler, r"moves\.eq\(step\)", "moves.eq(self.i.ready)", "end_tokens"),
    "colour moves too early": (Tiler, r"moves\.eq\(step\)", "moves.eq(1)", "end_tokens"),
    "never meets": (Tiler, r"meets\.eq\(", "meets.eq(0 & ", "one_tile_a_cycle"),
    "meets what was long ago": (
        Tiler,
        r" & valid & self\.o\.ready\)",
        ")",
        "a_window_that_lags_behind",
    ),
    "meets on any line": (
        Tiler,
        r"lines\.any\(\) & ",
        "",
        "a_window_that_lags_behind",
        "_meets",
    ),
    "meets in any column": (Tiler, r" & columns\.any\(\)", "", "one_tile_a_cycle", "_meets"),
    "meets on the wrong side": (
        Tiler,
        r"Mux\(new, after, ahead\)",
        "Mux(new, ahead, after)",
        "one_tile_a_cycle",
        "_meets",
    ),
    "colour of the next": (ColourUnit, r"If\(self\.moves\)", "If(1)", "random_materials"),
    "coefficients of the next": (ColourUnit, r"If\(self\.o\.ready\)", "If(1)", "random_materials"),
    "coefficients move with colours": (
        ColourUnit,
        r"If\(self\.o\.ready\)",
        "If(self.moves)",
        "random_materials",
    ),
}
REWRITTEN_COLLISIONS = {
    "a load meets what is cleared": (
        LOADING,
        " & ~drawn & ~loaded",
        "words_right_behind_what_leaves",
    ),
    "a tile meets one that stood still": (
        r" \| stopped\)",
        ")",
        "tiles_while_the_raster_waits",
    ),
}
BENCHES = {
    Tiler: (Tiler, test_tiler),
    Walker: (Walker, test_walker),
    ColourUnit: (test_colour.Painter, test_colour),
}


def check_rewritten(monkeypatch, part, pattern, replacement, test, method="elaborate", **options):
    """Break a component and run a test on it, or on the window of lanes that it is part of."""
    source = textwrap.dedent(inspect.getsource(getattr(part, method)))
    broken, count = re.subn(pattern, replacement, source)
    assert count == 1
    scope = dict(vars(inspect.getmodule(part)))
    exec(broken, scope)
    monkeypatch.setattr(part, method, scope[method])
    component, bench = BENCHES.get(part, (LaneWindow, test_lane_window))
    assert hasattr(bench, test)
    with pytest.raises(SimulationError):
        run_preset(PAPER, component, bench.__file__, test=test, **options)


@pytest.mark.parametrize("broken", REWRITTEN.values(), ids=REWRITTEN)
def test_a_rewritten_window_of_lanes_is_noticed(monkeypatch, broken):
    """Faults in what has no name in the Verilog."""
    check_rewritten(monkeypatch, *broken)


@pytest.mark.parametrize("broken", REWRITTEN_COLLISIONS.values(), ids=REWRITTEN_COLLISIONS)
def test_a_pixel_that_is_read_while_it_is_written_is_noticed(monkeypatch, broken):
    """Where the memory is as unkind as it may be."""
    check_rewritten(monkeypatch, LaneWindow, *broken, edit=test_lane_window.collide)


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
            "paper",
            fault("splatline.window.lane_2_1", "difference", LANE_WRITES),
            id="no depth test",
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
