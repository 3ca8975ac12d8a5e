import dataclasses

import numpy as np
import pytest

from tests.mutants import __main__, judge, prove
from tests.mutants.acts import acts_of
from tests.mutants.batch import Batch, Judged
from tests.mutants.cleared import prove_cleared
from tests.mutants.context import prove_in_context
from tests.mutants.held_inputs import prove_with_held_inputs
from tests.mutants.judge import Verdict
from tests.mutants.mutate import FIXED, Mutant, draw_mutants
from tests.mutants.page import page, share, summary
from tests.mutants.renamed import renaming_of
from tests.mutants.rows import row_of, same_row
from tests.mutants.tops import DESIGNS

PAPER, _, PLANE, SWIFT, AXI = DESIGNS
COUNT = 50
"""Mutants of the sample: those that ``.ci/run`` takes."""


@pytest.mark.parametrize(
    "arguments", [["--preset", "nope"], ["--count", "0"], ["--count", "many"], ["--count", "-3"]]
)
def test_a_wrong_option_is_one_line(arguments, capsys):
    with pytest.raises(SystemExit) as left:
        __main__.main(arguments)
    assert left.value.code == 2
    out, err = capsys.readouterr()
    assert not out
    assert err.count("\n") == 1


def test_the_help_has_examples(capsys):
    with pytest.raises(SystemExit) as left:
        __main__.main(["--help"])
    assert left.value.code == 0
    assert "--preset paper --count 50" in capsys.readouterr().out


def test_a_seed_draws_the_same_mutants_again_and_another_seed_others():
    drawn = draw_mutants(PAPER, COUNT, 1)
    assert len(drawn) == COUNT == len(set(drawn))
    assert drawn == draw_mutants(PAPER, COUNT, 1)
    assert drawn != draw_mutants(PAPER, COUNT, 2)
    assert not any(mutant.port in FIXED for mutant in drawn)
    assert len({mutant.part for mutant in drawn}) > 5


@pytest.fixture(scope="module")
def judged():
    """Verdicts on a sample; the design itself has passed."""
    mutants = draw_mutants(PAPER, COUNT, 1)
    return mutants, judge.judge(PAPER, mutants)


def test_most_of_a_sample_is_noticed(judged):
    _, verdicts = judged
    assert sum(verdict.noticed for verdict in verdicts) > COUNT * 0.7
    kinds = {act.kind for act in acts_of(PAPER)}
    assert {verdict.kind for verdict in verdicts if verdict.noticed} <= kinds


def test_verdicts_are_kept(judged, monkeypatch):
    mutants, verdicts = judged

    def never(*_):
        raise AssertionError

    monkeypatch.setattr(judge, "_play", never)
    assert judge.judge(PAPER, mutants) == verdicts


def test_a_design_that_fails_without_a_mutant_is_told(monkeypatch):
    """Here the bench expects another colour."""
    acts = acts_of(PAPER)[:1]
    items = dict(acts[0].items)
    payload = items["raster"].payload.copy()
    payload[3, 0] ^= np.uint64(1)
    items["raster"] = dataclasses.replace(items["raster"], payload=payload)
    monkeypatch.setattr(judge, "acts_of", lambda _: [dataclasses.replace(acts[0], items=items)])
    with pytest.raises(judge.SimulationError, match="without a mutant fails: value"):
        judge.judge(PAPER, draw_mutants(PAPER, COUNT, 1))


def test_proofs_tell_equal_mutants_from_others(judged):
    mutants, verdicts = judged
    pairs = list(zip(mutants, verdicts, strict=True))
    survivors = [mutant for mutant, verdict in pairs if not verdict.noticed]
    answers = list(prove.prove(PAPER, survivors))
    assert sum(answer in prove.EQUAL for answer in answers) >= len(answers) / 2
    noticed = [m for m, v in pairs if v.noticed and "lane_" in m.module][:3]
    assert not {*prove.prove(PAPER, noticed)} & {*prove.EQUAL}


def test_a_renamed_memory_is_equal_and_a_stuck_address_is_not():
    """An address bit of a lane that is inverted at every access, and the same bit stuck at 0."""
    drawn = draw_mutants(PAPER, 200, 1)
    inverted = next(m for m in drawn if m.mode == "inv" and m.wire.startswith("write__addr_4"))
    assert renaming_of(PAPER, inverted)
    stuck = dataclasses.replace(inverted, mode="const0")
    assert list(prove.prove(PAPER, [inverted, stuck])) == ["renamed", "differs"]


def test_what_only_waits_bounds_or_rare_frames_show_is_noticed():
    """Some of 200 mutants are noticed first by frames that few others need."""
    verdicts = judge.judge(PAPER, draw_mutants(PAPER, 200, 1))
    rare = {"flush beside load", "a raster down to the last line", "rounding once more", "film"}
    assert rare <= {verdict.kind for verdict in verdicts}


def test_a_bit_of_a_line_that_counts_far_down_only_is_noticed():
    """The lines that are loaded, while a beat waits below a window that begins at line 64 or on."""
    drawn = draw_mutants(PLANE, 40, 271127)
    mutant = next(m for m in drawn if m.part == "window.loader" and m.mode == "cnot1")
    (verdict,) = judge.judge(PLANE, [mutant])
    assert verdict.kind == "a raster down to the last line"


def test_survivors_in_the_engine_of_an_axi_top_are_played_alone():
    drawn = draw_mutants(AXI, 200, 1)
    parts = "engine.window.flush_scan written", "engine.tiler turn", "registers.front bus"
    begins = [f"const{n} {part}" for n, part in zip((1, 0, 1), parts, strict=True)]
    mutants = [next(m for m in drawn if str(m).startswith(begin)) for begin in begins]
    verdicts = judge.judge_engine(AXI, mutants, [Verdict("", "-", 1)] * 3)
    assert [verdict.alone for verdict in verdicts] == [True, True, False]


def test_what_the_clearing_overwrites_is_equal_and_no_more():
    """An address bit inverted but in the clearing; the clearing without a bit; a wrong colour."""
    drawn = [*draw_mutants(PAPER, 200, 1), *draw_mutants(PAPER, 3000, 1)]
    inverted = next(m for m in drawn if str(m).startswith("inv window address_2_0[8]"))
    assert list(prove_in_context(PAPER, [inverted])) == ["cleared"]
    sweep = next(m for m in drawn if str(m).startswith("inv window sweep["))
    assert not prove_cleared(PAPER, dataclasses.replace(sweep, mode="const0"))
    colour = next(m for m in drawn if str(m).startswith("inv window.lane loaded[16]"))
    assert not prove_cleared(PAPER, colour)


def test_a_row_of_lanes_with_words_in_other_places_is_equal_and_no_other():
    """An address bit of all even memories, by an inverter and by a bit above; stuck; the mask."""
    inverted = Mutant("inv", "splatline__window", "row_5", "request", 20, None, "request_12[20]")
    by_another = dataclasses.replace(inverted, mode="cnot0", cell="row_2", portbit=26, ctrlbit=28)
    assert list(prove_in_context(SWIFT, [inverted, by_another])) == ["cleared"] * 2
    assert row_of(SWIFT, inverted) == "row_5"
    stuck = dataclasses.replace(inverted, mode="const0")
    assert not row_of(SWIFT, stuck)
    assert not same_row(SWIFT, stuck, "row_5", renaming_of(SWIFT, inverted))
    mask = dataclasses.replace(inverted, portbit=4)
    assert not same_row(SWIFT, mask, "row_5", renaming_of(SWIFT, inverted))


def test_a_bit_that_the_module_around_does_not_read_is_equal():
    drawn = draw_mutants(AXI, 200, 1)
    bit = next(m for m in drawn if str(m).startswith("const1 registers.front bus__awaddr[6]"))
    unread, read = (dataclasses.replace(bit, portbit=n) for n in (1, 2))
    assert list(prove_in_context(AXI, [unread, read])) == ["parent", "open"]


def test_what_no_engine_gives_its_window_shows_no_difference():
    """A line of the initial raster above the image, in a frame that has no lines yet; and below."""
    drawn = draw_mutants(PAPER, 200, 1)
    line = next(m for m in drawn if str(m).startswith("cnot1 window.loader _30_[0]"))
    above = dataclasses.replace(line, mode="const0", portbit=10, ctrlbit=None)
    assert prove_with_held_inputs(PAPER, above)
    assert not prove_with_held_inputs(PAPER, dataclasses.replace(above, portbit=2))


def test_the_page_counts_by_design_and_module():
    parts = ["splatline__tiler", "splatline__tiler", "splatline__window__lane_0_1", "splatline"]
    mutants = [Mutant("inv", module, "cell", "A", n) for n, module in enumerate(parts)]
    verdicts = [
        Verdict("dense", "value", 9),
        *[Verdict("", "-", 99)] * 2,
        Verdict("film", "hang", 1, alone=True),
    ]
    answers = {mutants[1]: "module", mutants[2]: "open"}
    judged = [Judged(Batch(PAPER, 1, 4), mutants, verdicts, answers)]
    text = page(judged)
    assert "| paper | 4 | 2 | 1 | 1 | 1 | 66.7 % |" in text
    assert "| tiler | 2 | 1 | 0 | 1 | 0 | 100.0 % |" in text
    assert "| window.lane | 1 | 0 | 0 | 0 | 1 | 0.0 % |" in text
    assert "- `paper: inv window.lane" in text
    assert "66.7 %" in summary(judged)


def test_a_score_without_mutants_that_count_is_none():
    assert share(0, 3, 3) == "-"
