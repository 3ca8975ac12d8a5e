"""Planted faults in the parts of the window of rows of lanes, and before it: each is noticed."""

import pytest

from splatline.contract.presets import SWIFT
from splatline.rtl.blocks.dirty_bits import BlockDirtyBits
from splatline.rtl.blocks.flush_scan import BlockFlushScan
from splatline.rtl.blocks.lane_row import LaneRow
from splatline.rtl.blocks.readout import BlockReadout
from splatline.rtl.blocks.tiler import BlockTiler
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl.blocks import (
    test_dirty_bits,
    test_flush_scan,
    test_lane_row,
    test_readout,
    test_tiler,
)
from tests.support.bench_config import run_bench
from tests.support.faults import rewrite
from tests.support.planted import build, find_wrong

pytestmark = pytest.mark.planted

BENCHES = {
    LaneRow: test_lane_row,
    BlockTiler: test_tiler,
    BlockDirtyBits: test_dirty_bits,
    BlockFlushScan: test_flush_scan,
    BlockReadout: test_readout,
}
LAGS = "a_window_that_lags_behind"
FOLLOWS = "one_pixel_a_cycle"
WALK = "written_beats_are_asked_for_once_and_in_order"
COMES = "every_beat_comes_out"
REWRITTEN = {
    "no depth test": (LaneRow, r"difference\[-1\] & draws", "draws", "random_requests", "_test"),
    "ties drawn": (
        LaneRow,
        r"Cat\(other, behind \^ meets\)",
        r"\g<0> - 1",
        "nearer_wins_and_equal_stays",
        "_test",
    ),
    "odd and even swapped": (
        LaneRow,
        r"Mux\(odd\[column\], olds\[.odd.\], olds\[.even.\]\)",
        'Mux(odd[column], olds["even"], olds["odd"])',
        "random_requests",
        "_test",
    ),
    "not cleared": (
        LaneRow,
        r"Mux\(caught\.clear, 1, mask\[column\]\)",
        "mask[column]",
        "random_requests",
        "_test",
    ),
    "cleared but where it is nearest": (
        LaneRow,
        r"Mux\(caught\.store, -1, getattr\(again, half\)\)",
        "getattr(again, half)",
        "random_requests",
        "_meet",
    ),
    "cleared but where it was drawn": (
        LaneRow,
        r" & ~caught\.store",
        "",
        "random_requests",
        "_meet",
    ),
    "loaded but where it is nearest": (
        LaneRow,
        r"Mux\(caught\.store, -1",
        "Mux(caught.clear, -1",
        "random_requests",
        "_meet",
    ),
    "the even word left where it is": (
        LaneRow,
        r"caught\.clear \| caught\.both",
        "caught.clear",
        "random_requests",
        "_stages",
    ),
    "loaded into both": (
        LaneRow,
        r"caught\.clear \| caught\.both",
        "caught.store",
        "random_requests",
        "_stages",
    ),
    "not loaded": (
        LaneRow,
        r"request\.draw \| request\.store",
        "request.draw",
        "random_requests",
        "_stages",
    ),
    "cleared to a colour": (
        LaneRow,
        r"Mux\(caught\.clear, 0, (self\.new\[column\]\.colour)\)",
        r"\1",
        "random_requests",
        "_stages",
    ),
    "leaving is not background": (
        LaneRow,
        r"Mux\(keep, self\.config\.background_depth, pixel\.depth\)",
        "pixel.depth",
        "random_requests",
        "_leave",
    ),
    "leaving from outside": (
        LaneRow,
        r"Mux\(outside, 1, ~self\.request\.clear\)",
        "~self.request.clear",
        "random_requests",
        "_keep",
    ),
    "over what is nearer": (LaneRow, r"Mux\(hides & [^,]+,", "Mux(0,", FOLLOWS, "_meet"),
    "hidden by what is behind": (LaneRow, r" & caught\.behind\[0\]", "", FOLLOWS, "_meet"),
    "hidden by another line": (LaneRow, r" & \(then == last\)", "", FOLLOWS, "_meet"),
    "as it was two cycles before": (LaneRow, r"Mux\(meets,", "Mux(0,", FOLLOWS, "_meet"),
    "as of another line": (LaneRow, r" & \(now == last\)", "", FOLLOWS, "_meet"),
    "over what was nearer": (
        LaneRow,
        r"behind\.eq\(.*\[1\]\)",
        "behind.eq(0)",
        FOLLOWS,
        "_meet",
    ),
    "hidden by what was behind": (
        LaneRow,
        r"~caught\.store & caught\.behind\[1\]",
        "~caught.store",
        FOLLOWS,
        "_meet",
    ),
    "right border": (
        BlockTiler,
        r"Cat\(words_left >= word for word in range\(2\)\)",
        "-1",
        "right_border",
        "_shape",
    ),
    "not turned": (
        BlockTiler,
        r"mask\[::-1\] for",
        "mask for",
        "one_element_a_cycle",
        "_shape",
    ),
    "not raised": (
        BlockTiler,
        r"Mux\(shape\.raised, high, low\)",
        "low",
        "middles_at_half_pixels",
        "_shape",
    ),
    "not shifted": (
        BlockTiler,
        r"\(0, shape\.shifted\)",
        "(0, 0)",
        "middles_at_half_pixels",
        "_turn",
    ),
    "in the word of the upper half": (
        BlockTiler,
        r"Mux\(row\[2\], turned\.odd\[1\], turned\.odd\[0\]\)",
        "turned.odd[0]",
        "middles_at_half_pixels",
        "_lay",
    ),
    "a line misplaced": (
        BlockTiler,
        r"top\[:3\] > q\)",
        "top[:3] > q + 1)",
        "one_element_a_cycle",
        "_lines",
    ),
    "in the image as the line before": (
        BlockTiler,
        r"is_next = top\[:3\] > q",
        "is_next = top[:3] > q + 1",
        "upper_and_lower_border",
        "_lines",
    ),
    "not rotated to its line": (
        BlockTiler,
        r"top\[:3\], f\"column",
        'turned.x[:3], f"column',
        "one_element_a_cycle",
        "_lay",
    ),
    "no wait for lines": (BlockTiler, r"\(near \| last\.end\)", "1", LAGS),
    "lost while it waits": (BlockTiler, r"self\.o\.valid & self\.o\.ready", "self.o.ready", LAGS),
    "shown as it is laid out": (BlockTiler, r"m\.If\(laid\)", "m.If(there)", LAGS),
    "touched where it is not": (
        BlockTiler,
        r"Cat\(\(mask & odd\)\.any\(\)",
        "Cat(mask.any()",
        "one_element_a_cycle",
    ),
    "a row that is not wanted": (
        BlockTiler,
        r"Cat\(mask\.any\(\) for",
        "Cat(mask[:-1].any() for",
        "one_element_a_cycle",
    ),
    "a line too early": (BlockTiler, r"> BLOCK\b", "> BLOCK - 1", LAGS),
    "a line that is cleared": (
        BlockTiler,
        r" & ~\(self\.cleared\.valid & [^\n]+\)",
        ")",
        "a_block_waits_for_its_places_alone",
    ),
    "any line that is cleared": (
        BlockTiler,
        r"self\.cleared\.valid & ~_outside\(left, mode\)",
        "self.cleared.valid",
        "a_block_waits_for_its_places_alone",
    ),
    "no coming in sight": (
        BlockTiler,
        r"self\.empties & waiting",
        "0",
        "a_block_waits_for_its_places_alone",
    ),
    "coming to another element": (BlockTiler, r"self\.empties & waiting", "self.empties", LAGS),
    "the place that it comes from": (
        BlockTiler,
        r" & _outside\(behind\[:bits\], mode\)",
        "",
        "a_block_waits_for_its_places_alone",
    ),
    "a fraction of the one before": (BlockTiler, r"waiting & last\.mode", "last.mode", LAGS),
    "eight lines of a fraction": (
        BlockTiler,
        r"waiting & last\.mode",
        "0",
        "a_block_waits_for_its_places_alone",
    ),
    "top of the last frame": (BlockTiler, r"top\.eq\(-ROWS\)", "top.eq(top)", "end_tokens"),
    "a stretch is taken in all residues": (
        BlockDirtyBits,
        r"self\.look(?= & self)",
        "self.look.any().replicate(len(residues))",
        "random_touches",
    ),
    "a look clears": (
        BlockDirtyBits,
        r" & self\.take\.replicate\(len\(residues\)\)",
        "",
        "random_touches",
    ),
    "marks forget": (
        BlockDirtyBits,
        r"Mux\(touched, bits, 0\)",
        "Mux(touched, -1, 0)",
        "random_touches",
    ),
    "marked in another parity": (
        BlockDirtyBits,
        r"loaded_bit\[parity::2\]",
        "loaded_bit[1 - parity::2]",
        "every_word_marks_its_beat",
    ),
    "marked though not drawn": (BlockDirtyBits, r"self\.drawing << ", "1 << ", "random_touches"),
    "both words in one beat": (
        BlockDirtyBits,
        r"apart = self\.words\[0\]\[0\]",
        "apart = self.words[0][0] & 0",
        "every_word_marks_its_beat",
    ),
    "a line above the top": (
        BlockFlushScan,
        r"looked_at < self\.top",
        "looked_at <= self.top",
        "nothing_leaves_unasked",
        "_look",
    ),
    "the next line as this one": (
        BlockFlushScan,
        r"looked_at\[: config\.slot_bits\]",
        "line[: config.slot_bits]",
        WALK,
        "_look",
    ),
    "jumps over what is written": (
        BlockFlushScan,
        r"self\.jump & clean",
        "self.jump",
        WALK,
        "_look",
    ),
    "comes while beats are behind": (
        BlockFlushScan,
        r"~behind\.any\(\) & leaving\.free",
        "leaving.free",
        "where_the_window_comes_to_is_told",
        "_beats",
    ),
    "comes to what is not loaded": (
        BlockFlushScan,
        r"self\.jump & clean",
        "clean",
        "where_the_window_comes_to_is_told",
        "_look",
    ),
    "marks taken unasked": (BlockFlushScan, r" & may\.any\(\)", "", "nothing_leaves_unasked"),
    "marks taken in all residues": (BlockFlushScan, r"self\.line_row & ", "", WALK),
    "the row of the line before": (
        BlockFlushScan,
        r"self\._row_of\(leaving\.looked_at\)",
        "self.line_row",
        WALK,
    ),
    "the row of a line that was jumped over": (
        BlockFlushScan,
        r"self\._row_of\(self\.top\)",
        "self.line_row",
        WALK,
    ),
    "left before it has come": (
        BlockFlushScan,
        r"self\.jump \| loaded",
        "1",
        "nothing_leaves_unasked",
        "_look",
    ),
    "not held by what is asked for": (
        BlockFlushScan,
        r"m\.Elif\(turns\)",
        "m.Elif(1)",
        "the_window_waits_for_what_is_asked_for",
        "_beats",
    ),
    "marks taken while beats wait": (BlockFlushScan, r" & ~behind\.any\(\)", "", WALK, "_beats"),
    "a stretch skipped": (BlockFlushScan, r"m\.If\(take \| ~here\)", "m.If(1)", WALK, "_stretches"),
    "a line left too early": (BlockFlushScan, r"take & ~rest\.any\(\)", "take", WALK, "_stretches"),
    "never wraps": (
        BlockFlushScan,
        r"self\._written\(residue\) & \(",
        "0 & (",
        "the_next_frame_is_drawn_while_one_leaves",
        "_wraps",
    ),
    "reached by a first word": (
        BlockFlushScan,
        r"Mux\(beyond, own\.rotate_left\(1\), 0\)",
        "0",
        "a_block_on_two_stretches_reaches_both",
        "_reached",
    ),
    "reached by blocks alone": (
        BlockFlushScan,
        r"\(loaded & self\.load\.any\(\)\.replicate\(len\(reach\)\)\)",
        "0",
        "loaded_beats_too",
        "_reached",
    ),
    "the first stretch of the last line": (
        BlockFlushScan,
        r"Mux\(here & rest\.any\(\), rest, reached\)",
        "Mux(rest.any(), rest, reached)",
        WALK,
        "_stretches",
    ),
    "forgotten at a turn": (
        BlockFlushScan,
        r"turned, now, before\)",
        "turned, 0, before)",
        WALK,
        "_reached",
    ),
    "more than there is room for": (
        BlockReadout,
        r"DEPTH // 2",
        "DEPTH + 2",
        "the_queue_takes_what_there_is_room_for",
    ),
    "end beats beyond the queue": (
        BlockReadout,
        r"self\.end & self\.room",
        "self.end",
        "end_beats_need_room_too",
    ),
    "over before its beats": (BlockReadout, r" & ~valid\.any\(\)", "", COMES),
    "background leaves": (BlockReadout, r"out\.valid & visible\)", "out.valid)", COMES),
    "background in the way": (
        BlockReadout,
        r"raster\.ready \| blank",
        "raster.ready",
        "background_leaves_untaken",
    ),
    "never forgotten": (
        BlockFlushScan,
        r"clean \| turned, 0",
        "clean, 0",
        "a_stretch_that_nothing_reached_is_passed_over",
        "_reached",
    ),
}


ALONE = ("not turned", "not raised", "not shifted", "a fraction of the one before",
         "eight lines of a fraction")  # fmt: skip
"""What is not a value of the hardware where it is rewritten; each takes a build."""


def rewritten(name):
    part, pattern, replacement, _, *method = REWRITTEN[name]
    return part, *(method or ["elaborate"]), f"(?m){pattern}", replacement


@pytest.mark.parametrize("part", BENCHES, ids=lambda part: part.__name__)
def test_faults_in_a_part_of_the_window_of_rows_are_noticed(part):
    """A part has all of its faults in one build and one run, first without a fault."""
    names = [name for name, row in REWRITTEN.items() if row[0] is part and name not in ALONE]
    built = build(lambda: part(SWIFT), [rewritten(name) for name in names])
    faults = {name: (REWRITTEN[name][3], number) for number, name in enumerate(names, 1)}
    assert find_wrong(SWIFT, built, BENCHES[part], faults) == []


@pytest.mark.parametrize("name", ALONE)
def test_a_fault_that_takes_a_build_is_noticed(monkeypatch, name):
    part, _, _, test, *_ = REWRITTEN[name]
    rewrite(monkeypatch, *rewritten(name))
    bench = BENCHES[part]
    assert hasattr(bench, test)
    with pytest.raises(SimulationError, match="FAIL=1"):
        run_bench(SWIFT, part, bench.__file__, test=test)
