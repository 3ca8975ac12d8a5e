"""Planted faults: the benches must notice a broken circuit, or they prove nothing."""

import re
from functools import cache

import numpy as np
import pytest
import test_bank
import test_bank_marks
import test_bank_walker
import test_decoder
import test_planar_bank
import test_scatter
import test_window

from splatline.contract.config import BAYER
from splatline.contract.presets import PAPER, PRESETS
from splatline.contract.variants import BANKS16
from splatline.flow.verilog import convert
from splatline.rtl.bank import Bank
from splatline.rtl.bank_arbiter import BankArbiter
from splatline.rtl.bank_marks import BankMarks
from splatline.rtl.bank_walker import BankWalker
from splatline.rtl.decoder import Decoder
from splatline.rtl.engine import Engine
from splatline.rtl.front.sequencer import Sequencer
from splatline.rtl.planar_bank import PlanarBank
from splatline.rtl.scatter import Scatter
from splatline.rtl.window import Window
from splatline.sim import golden
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player import frames
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl import test_engine
from tests.rtl.front import test_sequencer
from tests.support.bench_config import run_bench as run_preset
from tests.support.bench_config import run_built
from tests.support.engines import mismatches
from tests.support.faults import LANE_WRITES, fault, rewrite, switched
from tests.support.random_frames import shapes

ENGINES = PRESETS | {BANKS16.name: BANKS16}
WAITS = "an_element_waits_for_the_window"
MARKS = "a_mark_a_word"
COMPLETE = "$signed({1'h0, line}) < $signed(top)"
UNLOADED = f"(({COMPLETE}) | closing) & ~halted"
"""A flush scan's lines leave whether they were loaded or not."""
ARRIVING = "jump | ($signed({1'h0, line}) <= $signed(limit))"
LOADING = f"((({COMPLETE}) & ({ARRIVING})) | closing) & ~halted"
"""Or while they are loaded."""
UNASKED = "nothing_leaves_unasked"
FRONT = "the_front_is_known_with_the_last_word"
WRITTEN = "what_is_being_written_stays_behind_the_front"
ASKS = "drawn_words_are_asked_for_once_and_in_order"
PART_FAULTS = [
    ("paper", Bank, test_bank, "random_requests", "passes_2", "1'h1", "no depth test"),
    ("paper", Bank, test_bank, "random_requests", "drawn", "taken[0]", "a load marks nothing"),
    ("paper", Sequencer, test_sequencer, "random_words", "control", "1'h0", "no control words"),
    ("paper", Decoder, test_decoder, "all_columns", "words_left", "8'h7f", "right border"),
    ("paper", Decoder, test_decoder, WAITS, "settled", "1'h1", "beyond the window"),
    ("paper", Decoder, test_decoder, WAITS, "settled", "within", "not cleared as yet"),
    ("paper", Scatter, test_scatter, "free_banks", "end_3", "2'h3", "mask"),
    ("paper", Scatter, test_scatter, "elements_in_a_row", "again", "8'h0", "no rest"),
    ("paper", Scatter, test_scatter, "elements_in_a_row", "again", "same", "rests for nothing"),
    ("banks16", Scatter, test_scatter, "free_banks", "end_3", "3'h7", "mask of eight"),
    ("wide", BankMarks, test_bank_marks, MARKS, "busy", "1'h0", "marks read while in use"),
    ("wide", BankMarks, test_bank_marks, MARKS, "clear_5", "1'h0", "marks stay"),
    ("wide", BankMarks, test_bank_marks, MARKS, "clear_5", "take | wipe", "marks clear too much"),
    ("wide", BankWalker, test_bank_walker, ASKS, "alone", "1'h1", "a stretch's rest is lost"),
    ("wide", BankWalker, test_bank_walker, ASKS, "passed", "reading", "a stretch is lost"),
    ("wide", BankWalker, test_bank_walker, ASKS, "waits", "1'h0", "what waits is lost"),
    ("wide", BankWalker, test_bank_walker, FRONT, "sole", "1'h1", "the front passes what follows"),
    ("wide", BankWalker, test_bank_walker, WRITTEN, "empty", "1'h1", "nor what is being written"),
    ("wide", BankWalker, test_bank_walker, ASKS, "two", "2'h1", "words of one half alone"),
    ("wide", BankWalker, test_bank_walker, ASKS, "last_next", "1'h1", "two stretches at most"),
    ("wide", BankWalker, test_bank_walker, UNASKED, "leaving", "1'h1", "lines leave early"),
    ("wide", BankWalker, test_bank_walker, UNASKED, "leaving", UNLOADED, "not loaded as yet"),
    ("wide", BankWalker, test_bank_walker, ASKS, "leaving", UNLOADED, "nor between loads"),
    ("wide", BankWalker, test_bank_walker, ASKS, "dirty_bits.clear_2", "1'h0", "asked for twice"),
]


@pytest.mark.parametrize(
    ("preset", "component", "bench", "test", "signal", "value"),
    [pytest.param(*planted[:6], id=planted[6]) for planted in PART_FAULTS],
)
def test_a_fault_in_a_part_is_noticed(preset, component, bench, test, signal, value):
    *inner, name = signal.split(".")
    edit = fault(".".join(["dut", *inner]), name, value)
    with pytest.raises(SimulationError):
        run_preset(ENGINES[preset], component, bench.__file__, test=test, edit=edit)


SHORT = "in_short"
WINDOW_FAULTS = {
    "lines leave the window early": ("wide", SHORT, "dut.flush_scan", "leaving", "1'h1"),
    "the end comes early": ("wide", SHORT, "dut.flush_scan", "clean", "1'h1"),
    "a bank marks nothing": ("wide", SHORT, "dut.bank_3", "drawn", "1'h0"),
    "background is sent": ("wide", SHORT, "dut.readout", "raster__valid", "emit_valid"),
    # By one line: noticed where no element keeps it.
    "load late": ("wide", "without_stalls", "dut.flush_scan", "leaving", LOADING),
    "drawn before the load": ("wide", SHORT, "dut.loader", "front", "oldest"),
    "loaded beside an element": ("wide", SHORT, "dut.arbiter", "full", "2'h0"),
    # Behind an element, whose further planes keep its banks busy.
    "loaded beside planes": ("rgb18", SHORT, "dut.arbiter", "full", "{2{drawing}}"),
    "no further planes are loaded": ("rgb18", SHORT, "dut", "loaded", "loaded_parts[71:0]"),
    "flushed words meet": ("rgb18", SHORT, "dut.readout", "ready", "1'h1"),
}


def planted(preset):
    """The faults of a preset's window, which are in one build: the longest part of a test."""
    return [planted[2:] for planted in WINDOW_FAULTS.values() if planted[0] == preset]


@cache
def window(preset):
    text = convert(Window(PRESETS[preset]), "dut")
    return simulator.build({"dut.v": switched("dut", planted(preset))(text)}, "dut")


def run_window(preset, test, number):
    run_built(PRESETS[preset], window(preset), test_window.__file__, test, number)


@pytest.mark.parametrize("broken", WINDOW_FAULTS.values(), ids=WINDOW_FAULTS)
def test_a_fault_in_the_window_of_banks_is_noticed(broken):
    """Of planes: two words meet in what planes share."""
    preset, test, *edit = broken
    with pytest.raises(SimulationError, match="FAIL=1"):
        run_window(preset, test, planted(preset).index(tuple(edit)) + 1)


@pytest.mark.parametrize(
    ("preset", "test"),
    dict.fromkeys(
        [
            *(planted[:2] for planted in WINDOW_FAULTS.values()),
            ("wide", "nonsense_in_the_initial_raster"),
        ]
    ),
)
def test_without_a_fault_nothing_is_noticed_in_the_window(preset, test):
    run_window(preset, test, 0)


FEW, DENSE = "few_far_apart", "dense_over_a_picture"
SOURCE_FAULTS = {
    "the third word's stretch": (
        Scatter,
        r" \| \(across & \(stretch == number - 1\)\)",
        "",
        FEW,
    ),
    "reached at the moment": (BankWalker, r"passed, empty\)$", "passed, clean)", FEW),
    "lost to a load": (BankArbiter, r"want, first_line\)", "want, leaving.line)", DENSE),
}


@pytest.mark.parametrize("broken", SOURCE_FAULTS.values(), ids=SOURCE_FAULTS)
def test_a_fault_without_a_name_in_the_window_is_noticed(monkeypatch, broken):
    """Stretches that are passed over, and words that wait for what goes first."""
    part, pattern, replacement, test = broken
    rewrite(monkeypatch, part, "elaborate", f"(?m){pattern}", replacement)
    with pytest.raises(SimulationError):
        run_preset(PRESETS["wide"], Window, test_window.__file__, test=test)


PLANE_FAULTS = [
    ("rgb18", "late_colour_write", "1'h0", "plane 1 not written"),
    ("rgb24", "late_depth_write", "1'h0", "plane 2 not written"),
    ("rgb18", "busy", "1'h0", "requests meet the planes"),
]


@pytest.mark.parametrize(
    ("preset", "signal", "value"),
    [pytest.param(*fault[:3], id=fault[3]) for fault in PLANE_FAULTS],
)
def test_a_fault_in_the_planes_is_noticed(preset, signal, value):
    """Either a plane is lost, or requests meet in what planes share."""
    with pytest.raises(SimulationError):
        run_preset(
            PRESETS[preset],
            PlanarBank,
            test_planar_bank.__file__,
            test="random_requests",
            edit=fault("dut", signal, value),
        )


LOAD_FAULTS = {
    "loaded while all stands still": (
        Bank,
        test_bank,
        r"load\.en\.eq\(self\.enable & ",
        "load.en.eq(",
    ),
    "further planes in the wrong place": (
        PlanarBank,
        test_planar_bank,
        r"late_read \| \(further & late\[name\]\)",
        "late_read",
    ),
    "further planes over the depths": (
        PlanarBank,
        test_planar_bank,
        r" & \(~further \| late\[name\]\)",
        "",
    ),
}


@pytest.mark.parametrize("broken", LOAD_FAULTS.values(), ids=LOAD_FAULTS)
def test_a_fault_in_the_load_of_a_bank_is_noticed(monkeypatch, broken):
    part, bench, pattern, replacement = broken
    rewrite(monkeypatch, part, "elaborate", pattern, replacement)
    preset = "paper" if part is Bank else "rgb18"
    with pytest.raises(SimulationError):
        run_preset(PRESETS[preset], part, bench.__file__, test="random_requests")


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
            "wide", fault("splatline.window.scatter", "again", "8'h0"), id="no word rests"
        ),
        pytest.param(
            "paper",
            fault("splatline.window.lane_2_1", "difference", LANE_WRITES),
            id="no depth test",
        ),
        pytest.param(
            "paper",
            fault("splatline.window.flush_scan.dirty_bits", "bit_1", "8'h01"),
            id="a wrong mark",
        ),
        pytest.param(
            "paper", fault("splatline.window.flush_scan", "leaving", "1'h1"), id="lines leave early"
        ),
        pytest.param("paper", fault("splatline.decoder", "past_1", "1'h0"), id="a line misplaced"),
    ],
)
def test_a_fault_in_the_engine_is_noticed(monkeypatch, preset, edit):
    """One bank of eight, or the window of lanes, forgets its conflicts: elements that touch mix."""
    from splatline.flow import verilog

    whole = verilog.generate

    def broken(config, name="splatline"):
        text, sidecar = whole(config, name)
        return edit(text), sidecar

    monkeypatch.setattr(verilog, "generate", broken)
    # Small frames are quicker in Icarus, but for banks: see ``presets.run_bench``.
    quickest = "icarus" if preset == "paper" and simulator.available("icarus") else "verilator"
    frame = shapes(np.random.default_rng(1), 400, 32, 24, config=PRESETS[preset])
    try:
        outcome = frames.play([frames.Job(frame=frame)], simulator_name=quickest)[0]
    except SimulationError:  # words outside the image
        return
    assert outcome.raster.mismatches(golden.render(frame)) > 0


@pytest.mark.parametrize("signal", ["tables.idle", "sequencer.admit", "window.active"])
def test_an_engine_that_mixes_frames_is_noticed(monkeypatch, signal):
    """Table writes taken within a frame, a frame before its tables, a raster before its frame."""
    expression = re.escape(signal) + r"\.eq\("
    rewrite(monkeypatch, Engine, "elaborate", expression, r"\g<0>1 | ")
    rng = np.random.default_rng(10)
    jobs = [*test_engine.back_to_back(rng)[:2], *test_engine.rasters_ahead(rng)[:2]]
    try:
        outcomes = frames.play(jobs)
    except SimulationError:
        return
    wrong = 0
    for job, outcome in zip(jobs, outcomes, strict=True):
        wrong += mismatches(job, outcome)
    assert wrong > 0


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
