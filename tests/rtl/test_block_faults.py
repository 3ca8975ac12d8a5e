"""Planted faults in the window of rows of lanes and before it: each must be noticed."""

import dataclasses
import re

import numpy as np
import pytest
import test_beat_emitter
import test_beat_marks
import test_beat_walker
import test_block_tiler
import test_lane_row
import test_presets
import test_variants
from engines import mismatches
from faults import rewrite, switched_source
from presets import run_bench
from random_frames import films, frame_of, random_tables, word

from splatline.host.frame import Tables
from splatline.host.order import advance_word
from splatline.rtl.beat_emitter import BeatEmitter
from splatline.rtl.beat_marks import BeatMarks
from splatline.rtl.beat_walker import BeatWalker
from splatline.rtl.block_tiler import BlockTiler
from splatline.rtl.block_window import BlockWindow
from splatline.rtl.lane_row import LaneRow
from splatline.rtl.presets import SWIFT
from splatline.rtl.verilog import generate
from splatline.sim.cosim import frames, simulator
from splatline.sim.cosim.frames import Job
from splatline.sim.cosim.player import wrap
from splatline.sim.cosim.simulator import SimulationError
from splatline.sim.raster import Raster

BENCHES = {
    LaneRow: test_lane_row,
    BlockTiler: test_block_tiler,
    BeatMarks: test_beat_marks,
    BeatWalker: test_beat_walker,
    BeatEmitter: test_beat_emitter,
}
LAGS = "a_window_that_lags_behind"
FOLLOWS = "one_pixel_a_cycle"
WALK = "written_beats_are_asked_for_once_and_in_order"
COMES = "every_beat_comes_out"
FIRST = "the_first_beat_comes_first"
REWRITTEN = {
    "no depth test": (LaneRow, r"difference\[-1\] & draws", "draws", "random_requests"),
    "ties drawn": (
        LaneRow,
        r"Cat\(other, behind \^ meets\)",
        r"\g<0> - 1",
        "nearer_wins_and_equal_stays",
    ),
    "odd and even swapped": (
        LaneRow,
        r"Mux\(odd\[column\], olds\[.odd.\], olds\[.even.\]\)",
        'Mux(odd[column], olds["even"], olds["odd"])',
        "random_requests",
    ),
    "not cleared": (
        LaneRow,
        r"Mux\(caught\.clear, 1, mask\[column\]\)",
        "mask[column]",
        "random_requests",
    ),
    "cleared but where it is nearest": (
        LaneRow,
        r"Mux\(caught\.clear, background, read\.data\.depth\)",
        "read.data.depth",
        "random_requests",
    ),
    "cleared but where it was drawn": (
        LaneRow,
        r" & ~caught\.clear",
        "",
        "random_requests",
        "_meet",
    ),
    "cleared but where it was drawn before": (
        LaneRow,
        r" & ~self\.request\.clear",
        "",
        "random_requests",
        "_meet",
    ),
    "cleared to a colour": (
        LaneRow,
        r"Mux\(caught\.clear, 0, self\.new\.colour\)",
        "self.new.colour",
        "random_requests",
    ),
    "leaving is not background": (
        LaneRow,
        r"Mux\(keep, background, read\.data\.depth\)",
        "read.data.depth",
        "random_requests",
    ),
    "leaving from outside": (
        LaneRow,
        r"Mux\(outside, 1, ~request\.clear\)",
        "~request.clear",
        "random_requests",
    ),
    "over what is nearer": (LaneRow, r"Mux\(hides & [^,]+,", "Mux(0,", FOLLOWS, "_meet"),
    "hidden by what is behind": (LaneRow, r" & caught\.behind\[0\]", "", FOLLOWS, "_meet"),
    "hidden by another line": (LaneRow, r" & \(then == last\)", "", FOLLOWS, "_meet"),
    "as it was two cycles before": (LaneRow, r"Mux\(meets & [^,]+,", "Mux(0,", FOLLOWS, "_meet"),
    "as of another line": (LaneRow, r" & \(now == last\)", "", FOLLOWS, "_meet"),
    "over what was nearer": (
        LaneRow,
        r"behind\.eq\(caught\.behind\[1\]\)",
        "behind.eq(0)",
        FOLLOWS,
        "_meet",
    ),
    "hidden by what was behind": (
        LaneRow,
        r"behind\.eq\(caught\.behind\[1\]\)",
        "behind.eq(1)",
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
    "marks clear too much": (
        BeatMarks,
        r"self\.wipe \| \(self\.line\[:own_bits\] == residue\)",
        "1",
        "random_touches",
    ),
    "a look clears": (BeatMarks, r"self\.take & mine", "self.look & mine", "random_touches"),
    "marks forget": (
        BeatMarks,
        r"Mux\(touched, bits, 0\)",
        "Mux(touched, -1, 0)",
        "random_touches",
    ),
    "marked in another parity": (
        BeatMarks,
        r"Cat\(aside_bits\[parity::2\]\)",
        "Cat(aside_bits[1 - parity::2])",
        "every_word_marks_its_beat",
    ),
    "marked though not drawn": (BeatMarks, r"self\.drawing << ", "1 << ", "random_touches"),
    "both words in one beat": (
        BeatMarks,
        r"apart = self\.words\[0\]\[0\]",
        "apart = self.words[0][0] & 0",
        "every_word_marks_its_beat",
    ),
    "a line above the top": (
        BeatWalker,
        r"looked_at < self\.top",
        "looked_at <= self.top",
        "nothing_leaves_unasked",
    ),
    "the next line as this one": (
        BeatWalker,
        r"looked_at\[: config\.slot_bits\]",
        "place",
        WALK,
    ),
    "jumps over what is written": (BeatWalker, r"self\.jump & clean", "self.jump", WALK),
    "comes while beats are behind": (
        BeatWalker,
        r"~behind\.any\(\) & free",
        "free",
        "where_the_window_comes_to_is_told",
    ),
    "comes to what is not loaded": (
        BeatWalker,
        r"self\.jump & clean",
        "clean",
        "where_the_window_comes_to_is_told",
    ),
    "marks taken unasked": (BeatWalker, r" & self\.enable\)", ")", "nothing_leaves_unasked"),
    "left before it has come": (
        BeatWalker,
        r"self\.jump \| loaded",
        "1",
        "nothing_leaves_unasked",
    ),
    "not held by what is asked for": (
        BeatWalker,
        r"m\.Elif\(turns\)",
        "m.Elif(1)",
        "the_window_waits_for_what_is_asked_for",
    ),
    "marks taken while beats wait": (BeatWalker, r" & ~behind\.any\(\)", "", WALK),
    "a stretch skipped": (BeatWalker, r"m\.If\(take \| ~here\)", "m.If(1)", WALK),
    "a line left too early": (BeatWalker, r"take & ~rest\.any\(\)", "take", WALK),
    "never wraps": (
        BeatWalker,
        r"self\._written\(residue\) & \(",
        "0 & (",
        "the_next_frame_is_drawn_while_one_leaves",
        "_wraps",
    ),
    "reached by a first word": (
        BeatWalker,
        r"Mux\(beyond, own\.rotate_left\(1\), 0\)",
        "0",
        "a_block_on_two_stretches_reaches_both",
        "_reached",
    ),
    "reached by blocks alone": (
        BeatWalker,
        r"\(loaded & self\.load\.any\(\)\.replicate\(len\(reach\)\)\)",
        "0",
        "loaded_beats_too",
        "_reached",
    ),
    "the first stretch of the last line": (
        BeatWalker,
        r"Mux\(here & rest\.any\(\), rest, reached\)",
        "Mux(rest.any(), rest, reached)",
        WALK,
    ),
    "forgotten at a turn": (
        BeatWalker,
        r"turned, now, before\)",
        "turned, 0, before)",
        WALK,
        "_reached",
    ),
    "more than there is room for": (
        BeatEmitter,
        r"DEPTH // 2",
        "DEPTH + 2",
        "the_queue_takes_what_there_is_room_for",
    ),
    "end beats beyond the queue": (
        BeatEmitter,
        r"self\.end & self\.room",
        "self.end",
        "end_beats_need_room_too",
    ),
    "over before its beats": (BeatEmitter, r" & ~valid\.any\(\)", "", COMES),
    "background leaves": (BeatEmitter, r"out\.valid & visible\)", "out.valid)", COMES),
    "background in the way": (
        BeatEmitter,
        r"raster\.ready \| blank",
        "raster.ready",
        "background_leaves_untaken",
    ),
    "never forgotten": (
        BeatWalker,
        r"clean \| turned, 0",
        "clean, 0",
        "a_stretch_that_nothing_reached_is_passed_over",
        "_reached",
    ),
}


@pytest.mark.parametrize("broken", REWRITTEN.values(), ids=REWRITTEN)
def test_a_fault_in_a_part_of_the_window_of_rows_is_noticed(monkeypatch, broken):
    part, pattern, replacement, test, *method = broken
    rewrite(monkeypatch, part, *(method or ["elaborate"]), f"(?m){pattern}", replacement)
    bench = BENCHES[part]
    assert hasattr(bench, test)
    with pytest.raises(SimulationError, match="FAIL=1"):
        run_bench(SWIFT, part, bench.__file__, test=test)


def behind_the_sweep(rng, config):
    """A reset, and then at once elements where the lanes are cleared last, and elsewhere.

    Near pixels were there before, or background. No tables are written after it, which would take
    longer than the sweep: none but the memory's counts.
    """
    random = random_tables(rng, config)
    tables = Tables(np.zeros(3, np.int64), random.diffuse, random.specular)

    last = config.max_width - 8

    def frame(z, count, first=last):
        elements = [
            word([(0, 7)] * 4, x, z, diffuse=z, material=9, config=config)
            for x in (first, *[40] * count)
        ]
        words = [advance_word(16, config), *elements]
        return dataclasses.replace(frame_of(words, config=config), tables=tables)

    yield Job(frame=frame(60, 5))
    for after in (200, 320):
        for first in (last, 80):
            near = [frame(1, 300, first)]
            yield Job(frame=frame(60, 5), followed_by=near, write_tables="none", reset_after=after)


def one_after_another(rng, config):
    """Films at full rate."""
    return films(rng, test_presets.RATES[:1], config)


def few(rng, config):
    """Frames of a few elements far apart: each comes to an empty window, as the last one leaves.

    Behind no initial raster, an empty one, and one that ends early.
    """
    for number in range(6):
        start = Raster.background(512, 900, config) if number % 3 else None
        if number % 3 == 2:
            start.depth[:60:4, ::9] = 300
        words = []
        for _ in range(30):
            rows = [(0, int(last)) for last in rng.integers(1, 8, 4)]
            x, z = int(rng.integers(500)), int(rng.integers(511))
            words += [
                advance_word(int(rng.integers(9, 50)), config),
                word(rows, x, z, mode=int(rng.integers(2)), material=9, config=config),
            ]
        yield Job(frame=frame_of(words, 512, 900, config=config), initial=start)


OVER, DOWN = test_presets.over_an_initial_raster, test_variants.down_the_image
FILMS, FEW = one_after_another, few
BEYOND = r"is_last & \(n > self\.last_column\[:bits\]\)"
IN_THE_WINDOW = {
    "nothing was drawn before": (r"other\.drawn & same", "0", OVER, "_follow"),
    "what is drawn lies before all": (r"block\.z >= other\.new\.depth", "0", OVER, "_follow"),
    "what is drawn lies behind all": (r"block\.z >= other\.new\.depth", "1", OVER, "_follow"),
    "an equal pixel drawn over": (
        r"block\.z >= other\.new\.depth",
        "block.z > other.new.depth",
        OVER,
        "_follow",
    ),
    "no wait for what is cleared": (r"(?<=loader\.oldest\.eq\()front", "walker.front", OVER),
    "where the frame before was": (r"-2 \* config\.window_lines", "walker.front", FILMS),
    "nothing is said to be cleared": (r"(?<=cleared\.valid\.eq\()flushing", "0", FEW),
    "another is said to be cleared": (
        r"walker\.flush\.payload\.line\[: config\.slot_bits\]",
        "walker.line",
        FEW,
    ),
    "not clipped": (BEYOND, "0", OVER, "_outside"),
    "clipped a pixel early": (BEYOND, "is_last & (n >= self.last_column[:bits])", OVER, "_outside"),
    "clipped as the next one": (r"(?<=is_last = )requested", "word[1:]", OVER, "_outside"),
    "half a wait for the sweep": (r"sweeping \| just_swept", "sweeping", behind_the_sweep),
    "a block goes where a beat goes first": (r"~\(first & meeting\)", "1", OVER),
    "a block goes where marks go first": (r"~\(marks_first & marking\)", "1", DOWN),
    "a row is not kept for a block": (r"\(first \| ~\(offered & meeting\)\)", "1", OVER),
    "a row is kept from what goes first": (
        r"~\(row_served & first\.replicate\(BLOCK\)\)",
        "0xFF",
        OVER,
    ),
    "loaded in a block's row": (
        r"~\(offered & wanted\.bit_select\(load\.line\[:bits\], 1\)\)",
        "1",
        OVER,
    ),
    "a block goes beside a load that presses": (r"~pressing", "1", OVER),
    "loads go before all else": (
        r"\(pressing \| ~\(leaves & \(refused \| lagging\)\)\)",
        "1",
        OVER,
    ),
    "marks taken in a row that is drawn into": (
        r"\(marks_first \| ~\(offered & marking\)\)",
        "1",
        OVER,
    ),
    "marks taken beside a load": (r"(?<=enable\.eq\()~serving", "1", OVER),
    "no wait for the sweep": (r"~swept(?=\),\n +going)", "1", behind_the_sweep),
    "a waiting block in the sweep's way": (
        r"offered\.replicate\(BLOCK\)(?= & )",
        "(self.i.valid & ~block.end & ~pressing).replicate(BLOCK)",
        behind_the_sweep,
    ),
}


def collide(text):
    """Make a pixel wrong that is read or written while it is written: as a block RAM may do."""
    port = r"if \((\S+?) ?\)\s+{}\[({}[^]]*\])\] <= (\S+?) ?;(.*?)"
    text, count = re.subn(
        port.format(r"((?:even|odd)_\d)", "request")
        + port.format(r"\2", "addresses")
        + r"(_\d+_) <= \2\[\3\];",
        r"if (\1 ) \2[\3] <= \6 && \3 == \7 ? ~\4 : \4 ;\5"
        r"if (\6 ) \2[\7] <= \1 && \3 == \7 ? ~\8 : \8 ;\9"
        r"\g<10> <= \6 && \3 == \7 ? ~\2[\3] : \2[\3];",
        text,
        flags=re.DOTALL,
    )
    assert count == 128, "the lanes' memories look different now"
    return text


def test_faults_in_the_window_of_rows_are_noticed(monkeypatch):
    """Where the memory is as unkind as it may be. One build for them all, which takes the time."""
    config = SWIFT
    with monkeypatch.context() as broken:
        edit = switched_source(
            broken,
            BlockWindow,
            [(*planted[:2], *planted[3:]) for planted in IN_THE_WINDOW.values()],
        )
        built = wrap(collide(edit(generate(config)[0])), config)
    rng = np.random.default_rng(11)
    cases = (OVER, DOWN, FILMS, FEW, behind_the_sweep)
    jobs = {case: list(case(rng, config)) for case in cases}
    run = simulator.run

    def is_wrong(case, number):
        def with_fault(*args, plusargs=(), **rest):
            run(*args, plusargs=[*plusargs, f"+fault={number}"], **rest)

        with monkeypatch.context() as chosen:
            chosen.setattr(simulator, "run", with_fault)
            try:
                outcomes = frames.play(jobs[case], built=built)
            except SimulationError:  # beats outside the frame, or none for too long
                return True
        return any(map(mismatches, jobs[case], outcomes))

    assert [case.__name__ for case in jobs if is_wrong(case, 0)] == []
    numbered = enumerate(IN_THE_WINDOW.items(), 1)
    unnoticed = [name for n, (name, (_, _, case, *_)) in numbered if not is_wrong(case, n)]
    assert unnoticed == []
