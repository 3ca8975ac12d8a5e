"""Planted faults in the parts of the tiles engine: the bench of each must notice them."""

import pytest

from splatline.contract.presets import PAPER
from splatline.rtl.front.colour import ColourUnit
from splatline.rtl.tiles import tiler
from splatline.rtl.tiles.dirty_bits import TileDirtyBits
from splatline.rtl.tiles.flush_scan import TileFlushScan
from splatline.rtl.tiles.lane import Lane
from splatline.rtl.tiles.tiler import Tiler
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl.front import test_colour
from tests.rtl.tiles import test_dirty_bits, test_flush_scan, test_lane, test_tiler
from tests.support.bench_config import PAIRED, run_bench
from tests.support.faults import LANE_WRITES, chosen, rewrite
from tests.support.planted import build, find_wrong

pytestmark = pytest.mark.planted

BENCHES = {
    Lane: (Lane, test_lane),
    Tiler: (Tiler, test_tiler),
    tiler: (Tiler, test_tiler),  # what it calls
    TileFlushScan: (TileFlushScan, test_flush_scan),
    TileDirtyBits: (TileDirtyBits, test_dirty_bits),
    ColourUnit: (test_colour.Painter, test_colour),
}
PAIR = "a_pair_is_cleared_through_both_ports"
WALK = "drawn_words_are_asked_for_once_and_in_order"

FAULTS = {
    "no depth test": (Lane, "random_requests", "difference", LANE_WRITES),
    "ties drawn": (
        Lane,
        "nearer_wins_and_equal_stays",
        "difference",
        "{ taken[1:0], old[8:0] } + { 1'h0, ~{ 2'h1, new_[8:0] } } + 1",
    ),
    "right border": (Tiler, "right_border", "words_left", "8'h3f"),
    "a line misplaced": (Tiler, "one_tile_a_cycle", "past_2", "1'h0"),
    "marks clear too much": (
        TileDirtyBits,
        "random_touches",
        "write__en",  # of even pairs on lines that are a multiple of 4: cleared with any other
        "take | (words[1] ? touch[1] & words[0] : touch[0] | (touch[1] & ~words[0]))",
    ),
    "marks forget": (TileDirtyBits, "random_touches", "write__data", "take ? 8'h00 : bit_0"),
    "last stretch skipped": (
        TileFlushScan,
        WALK,
        "left",
        "leaving & here & moves & (pairs == 0) & (wanted[2:0] == 0)",
    ),
    "lines skipped": (TileFlushScan, WALK, "clean", "1'h1"),
    "lines leave early": (TileFlushScan, "nothing_leaves_unasked", "leaving", "1'h1"),
}
"""By name: the part, the test that must notice it, the signal of its Verilog and the value."""


REWRITTEN = {
    "not marked where it is loaded": (
        TileDirtyBits,
        r"touched \|= self\.load\[residue\] & \(other\[0\] == parity\)",
        "touched |= self.load[residue] & (parity == 0)",
        "random_touches",
    ),
    "marked in the tile's place": (
        TileDirtyBits,
        r"Mux\(lone, other\[1 \+ low_bits :\], stretch\)",
        "stretch",
        "random_touches",
    ),
    "left before it has come": (
        TileFlushScan,
        r"\(self\.oldest < self\.limit\)",
        "1",
        "nothing_leaves_unasked",
    ),
    "marks taken unasked": (
        TileFlushScan,
        r" & self\.enable\b",
        "",
        "nothing_leaves_unasked",
        "_pairs",
    ),
    "marks taken twice": (TileFlushScan, r" & ~self\.taking\b", "", WALK, "_pairs"),
    "marks taken too early": (TileFlushScan, r"~pairs\.any\(\) & wanted", "wanted", WALK, "_pairs"),
    "a line left too early": (TileFlushScan, r"scans & moves & ", "scans & ", WALK, "_pairs"),
    "a pair of the next stretch": (
        TileFlushScan,
        r"\(first\), stretch\)",
        "(first), next_stretch)",
        WALK,
        "_pairs",
    ),
    "the stretch of before": (
        TileFlushScan,
        r"next_stretch\.eq\(number_of\(lowest\)\)",
        "next_stretch.eq(number_of(stretch_bit))",
        WALK,
        "_stretches",
    ),
    "reached at the moment": (
        TileFlushScan,
        r", now\) \| reach",
        ", now | reach)",
        WALK,
        "_reached",
    ),
    "reached by a first word": (
        TileFlushScan,
        r"own\[0\] \| own\[1\]",
        "own[0]",
        "a_tile_on_two_stretches_reaches_both",
        "_reached",
    ),
    "forgotten at a turn": (
        TileFlushScan,
        r"turned, now, before\)",
        "turned, 0, before)",
        WALK,
        "_reached",
    ),
    "forgotten a turn later": (
        TileFlushScan,
        r"return now \| before",
        "return now",
        WALK,
        "_reached",
    ),
    "never forgotten": (
        TileFlushScan,
        r"clean \| turned, 0",
        "clean, 0",
        "a_stretch_that_nothing_reached_is_passed_over",
        "_reached",
    ),
    "reached by tiles alone": (
        TileFlushScan,
        r"\(loaded & self\.load\.any\(\)\.replicate\(len\(reach\)\)\)",
        "0",
        "loaded_words_too",
        "_reached",
    ),
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
        "_compare",
    ),
    "lower lines too early": (
        Tiler,
        r"low > 2 \* SIDE",
        "low > 2 * SIDE - 1",
        "a_window_that_lags_behind",
        "_compare",
    ),
    "lines too late": (
        Tiler,
        r"low > SIDE",
        "low > SIDE + 1",
        "a_tile_comes_as_soon_as_its_lines",
        "_compare",
    ),
    "another's lines": (
        Tiler,
        r"near\.eq\(0\)",
        "near.eq(near)",
        "a_window_that_lags_behind",
        "_compare",
    ),
    "top once it goes": (
        Tiler,
        r"m\.If\(there\)",
        "m.If(there & may)",
        "a_window_that_lags_behind",
        "_give",
    ),
    "top of the last frame": (Tiler, r"top\.eq\(-SIDE\)", "top.eq(top)", "end_tokens", "_give"),
    "top outlasts a reset": (
        Tiler,
        r"init=-SIDE\)",
        "init=-SIDE, reset_less=True)",
        "reset_in_the_middle",
        "_give",
    ),
    "colour moves too late": (Tiler, r"moves\.eq\(step\)", "moves.eq(self.i.ready)", "end_tokens"),
    "colour moves too early": (Tiler, r"moves\.eq\(step\)", "moves.eq(1)", "end_tokens"),
    "never meets": (Tiler, r"meets\.eq\(", "meets.eq(0 & ", "one_tile_a_cycle", "_give"),
    "meets what was long ago": (
        Tiler,
        r" & valid & self\.o\.ready\)",
        ")",
        "a_window_that_lags_behind",
        "_give",
    ),
    "meets on any line": (
        tiler,
        r"lines\.any\(\) & ",
        "",
        "a_window_that_lags_behind",
        "overlap",
    ),
    "meets in any column": (tiler, r" & columns\.any\(\)", "", "one_tile_a_cycle", "overlap"),
    "meets on the wrong side": (
        tiler,
        r"Mux\(new, after, ahead\)",
        "Mux(new, ahead, after)",
        "one_tile_a_cycle",
        "overlap",
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
REWRITTEN_PAIRS = {
    "an odd pixel cleared while it stands still": (
        Lane,
        r"self\.enable & passes",
        "passes",
        PAIR,
        "_clear_pairs",
    ),
    "an odd pixel read while it stands still": (
        Lane,
        r"odd\.en\.eq\(self\.enable\)",
        "odd.en.eq(1)",
        PAIR,
        "_clear_pairs",
    ),
    "an even pixel cleared while it stands still": (
        Lane,
        r"self\.enable & (\(request)",
        r"\1",
        PAIR,
        "_clear_pairs",
    ),
    "an even pixel kept": (
        Lane,
        r"request\.load \| request\.clear",
        "request.load",
        PAIR,
        "_clear_pairs",
    ),
    "the even pixel twice": (
        Lane,
        r"request\.address\[0\] \| request\.clear",
        "request.address[0]",
        PAIR,
        "_clear_pairs",
    ),
    "marks lost beside what is taken": (
        TileDirtyBits,
        r"self\.take & mine if",
        "self.take if",
        "random_touches",
    ),
}


ALONE = ("not marked where it is loaded", "top outlasts a reset", "meets on any line",
         "meets in any column", "meets on the wrong side")  # fmt: skip
"""What is not a value of a component's own where it is rewritten; each takes a build."""

TABLES = {
    f"{part.__name__}-{config.name}": (part, config, table)
    for config, table in ((PAPER, REWRITTEN), (PAIRED, REWRITTEN_PAIRS))
    for part in dict.fromkeys(row[0] for name, row in table.items() if name not in ALONE)
}


def rewritten(row):
    part, pattern, replacement, _, *method = row
    return part, *(method or ["elaborate"]), pattern, replacement


@pytest.mark.parametrize(("part", "config", "table"), TABLES.values(), ids=TABLES)
def test_rewritten_lines_of_a_part_are_noticed(part, config, table):
    """A part has all faults of the source and of its Verilog in one build and one run."""
    rows = {name: row for name, row in table.items() if row[0] is part and name not in ALONE}
    whole = config is PAPER
    named = {name: row for name, row in FAULTS.items() if row[0] is part and whole}
    component, bench = BENCHES[part]
    edit = chosen([row[2:] for row in named.values()], first=1 + len(rows))
    built = build(lambda: component(config), [rewritten(row) for row in rows.values()], edit)
    tests = {name: row[3] for name, row in rows.items()} | {n: row[1] for n, row in named.items()}
    faults = {name: (test, number) for number, (name, test) in enumerate(tests.items(), 1)}
    assert find_wrong(config, built, bench, faults, whole=whole) == []


def test_a_fault_that_no_test_notices_is_told():
    rows = [rewritten(row) for row in REWRITTEN_PAIRS.values() if row[0] is Lane]
    built = build(lambda: Lane(PAIRED), rows)
    assert find_wrong(PAIRED, built, test_lane, {"none": (PAIR, 0)}, whole=False) == ["none"]


@pytest.mark.parametrize("name", ALONE)
def test_a_rewritten_line_that_takes_a_build_is_noticed(monkeypatch, name):
    part, *_ = row = REWRITTEN[name]
    rewrite(monkeypatch, *rewritten(row))
    component, bench = BENCHES[part]
    assert hasattr(bench, row[3])
    with pytest.raises(SimulationError):
        run_bench(PAPER, component, bench.__file__, test=row[3])
