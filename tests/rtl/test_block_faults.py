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
from random_frames import frame_of, random_tables, word

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

BENCHES = {
    LaneRow: test_lane_row,
    BlockTiler: test_block_tiler,
    BeatMarks: test_beat_marks,
    BeatWalker: test_beat_walker,
    BeatEmitter: test_beat_emitter,
}
LAGS = "a_window_that_lags_behind"
MEETS = "neighbours_that_share_a_pixel_meet"
WALK = "written_beats_are_asked_for_once_and_in_order"
COMES = "every_beat_comes_out"
FIRST = "the_first_beat_comes_first"
REWRITTEN = {
    "no depth test": (LaneRow, r"difference\[-1\] & mask", "mask", "random_requests"),
    "ties drawn": (
        LaneRow,
        r"odd\.data\.depth, even\.data\.depth\)",
        r"\g<0> - 1",
        "nearer_wins_and_equal_stays",
    ),
    "odd and even swapped": (
        LaneRow,
        r"Mux\(is_odd, odd\.data\.depth, even\.data\.depth\)",
        "Mux(is_odd, even.data.depth, odd.data.depth)",
        "random_requests",
    ),
    "not cleared": (LaneRow, r"taken\.clear \| \(passes & ~", "(passes & ~", "random_requests"),
    "cleared to a colour": (
        LaneRow,
        r"Mux\(request\.clear, 0, self\.new\.colour\)",
        "self.new.colour",
        "random_requests",
    ),
    "leaving is not background": (
        LaneRow,
        r"Mux\(taken\.clear, read\.data\.depth, background\)",
        "read.data.depth",
        "random_requests",
    ),
    "right border": (
        BlockTiler,
        r"Cat\(words_left >= word for word in range\(2\)\)",
        "-1",
        "right_border",
        "_place",
    ),
    "not turned": (
        BlockTiler,
        r"mask\[::-1\] for",
        "mask for",
        "one_element_a_cycle",
        "_place",
    ),
    "not raised": (
        BlockTiler,
        r"Mux\(shape\.raised, high, low\)",
        "low",
        "middles_at_half_pixels",
        "_place",
    ),
    "not shifted": (
        BlockTiler,
        r"\(lower, shape\.shifted\)",
        "(lower, 0)",
        "middles_at_half_pixels",
        "_place",
    ),
    "in the word of the upper half": (
        BlockTiler,
        r"Mux\(row\[2\], halves\[1\], halves\[0\]\)",
        "halves[0]",
        "middles_at_half_pixels",
        "_place",
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
    "a line too early": (BlockTiler, r"> BLOCK\b", "> BLOCK - 1", LAGS),
    "top of the last frame": (BlockTiler, r"top\.eq\(-ROWS\)", "top.eq(top)", "end_tokens"),
    "never meets": (BlockTiler, r"near\.eq\(apart", "near.eq(0 & apart", MEETS, "_meets"),
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
    "not clipped": (BeatEmitter, r"Cat\(is_last &", "Cat(0 &", COMES, "_join"),
    "clipped a pixel early": (BeatEmitter, r"n > last", "n >= last", COMES, "_join"),
    "clipped as the one behind": (BeatEmitter, r"places\[-2\]\)", "places[-1])", COMES),
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

    Near pixels were there before. No tables are written after it, which would take longer than the
    sweep: none but the memory's counts.
    """
    random = random_tables(rng, config)
    tables = Tables(np.zeros(3, np.int64), random.diffuse, random.specular)

    def frame(z, count):
        elements = [
            word([(0, 7)] * 4, x, z, diffuse=z, material=9, config=config)
            for x in (config.max_width - 8, 40)
        ]
        words = [advance_word(16, config), *elements * count]
        return dataclasses.replace(frame_of(words, config=config), tables=tables)

    yield Job(frame=frame(60, 3))
    for after in (200, 320):
        near = frame(1, 150)
        yield Job(frame=frame(60, 3), followed_by=[near], write_tables="none", reset_after=after)


OVER, DOWN = test_presets.over_an_initial_raster, test_variants.down_the_image
IN_THE_WINDOW = {
    "no conflict": (r"drawn & block\.meets", "0", OVER),
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
    "marks taken beside a load": (r"(?<=enable\.eq\()~loading", "1", OVER),
    "no wait for the sweep": (r"~swept(?=\),\n +going)", "1", behind_the_sweep),
    "a waiting block in the sweep's way": (
        r"offered\.replicate\(BLOCK\)(?= & )",
        "(self.i.valid & ~block.end & ~pressing).replicate(BLOCK)",
        behind_the_sweep,
    ),
}


def collide(text):
    """Make a pixel wrong that is read or written while it is written: as a block RAM may do."""
    port = r"if \((\S+?) ?\)\s+{}\[({}[^]]*\])\] <= (\S+) ;(.*?)"
    text, count = re.subn(
        port.format(r"((?:even|odd)_\d)", "request")
        + port.format(r"\2", "taken")
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
            broken, BlockWindow, [planted[:2] for planted in IN_THE_WINDOW.values()]
        )
        built = wrap(collide(edit(generate(config)[0])), config)
    rng = np.random.default_rng(11)
    jobs = {case: list(case(rng, config)) for case in (OVER, DOWN, behind_the_sweep)}
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
    unnoticed = [name for n, (name, (*_, case)) in numbered if not is_wrong(case, n)]
    assert unnoticed == []
