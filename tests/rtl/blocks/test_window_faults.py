"""Planted faults in the window of rows of lanes, in unkind memories: frames notice each."""

import dataclasses
import re

import numpy as np
import pytest

from splatline.contract.frame import Tables
from splatline.contract.presets import SWIFT
from splatline.contract.raster import Raster
from splatline.flow.verilog import generate
from splatline.host.encode.sort_by_line import advance_word
from splatline.rtl.blocks.window import BlockWindow
from splatline.sim.cosim.player.frames import Job
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl import test_presets, test_variants
from tests.support.faults import switched_source
from tests.support.planted import play_with
from tests.support.random_frames import films, frame_of, random_tables, word

pytestmark = pytest.mark.planted


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
    "where the frame before was": (
        r"-2 \* config\.window_lines",
        "flush_scan.front",
        FILMS,
        "_connect_frame",
    ),
    "nothing is said to be cleared": (r"(?<=cleared\.valid\.eq\()flushing", "0", FEW, "_arbitrate"),
    "another is said to be cleared": (
        r"flush_scan\.flush\.payload\.line\[: config\.slot_bits\]",
        "flush_scan.line",
        DOWN,
        "_arbitrate",
    ),
    "not clipped": (BEYOND, "0", OVER, "_outside"),
    "clipped a pixel early": (BEYOND, "is_last & (n >= self.last_column[:bits])", OVER, "_outside"),
    "clipped as the next one": (r"(?<=is_last = )requested", "word[1:]", OVER, "_outside"),
    "half a wait for the sweep": (
        r"sweeping \| just_swept",
        "sweeping",
        behind_the_sweep,
        "_clear",
    ),
    "a block goes where a beat goes first": (r"~\(first & meeting\)", "1", OVER, "_arbitrate"),
    "a block goes where marks go first": (r"~\(marks_first & marking\)", "1", DOWN, "_arbitrate"),
    "a row is not kept for a block": (
        r"\(first \| ~\(offered & meeting\)\)",
        "1",
        OVER,
        "_arbitrate",
    ),
    "a row is kept from what goes first": (
        r"~\(row_served & first\.replicate\(BLOCK\)\)",
        "0xFF",
        OVER,
        "_arbitrate",
    ),
    "a block goes beside a load": (r"~serving(?= & ~swept)", "1", OVER, "_arbitrate"),
    "a beat leaves beside a load": (r"(?<=room & )~serving", "1", OVER, "_arbitrate"),
    "half a beat": (r"(?<=ready\.eq\(loading & )odd", "1", OVER, "_arbitrate"),
    "the block before as a load is drawn": (r"(?<=If\()grants\.loading", "0", OVER, "_follow"),
    "marks taken in a row that is drawn into": (
        r"\(marks_first\.replicate\(BLOCK\) \| ~reserved\)",
        "0xFF",
        OVER,
        "_arbitrate",
    ),
    "marks taken beside a load": (
        r"(?<=marks=)~serving\.replicate\(BLOCK\)",
        "0xFF",
        OVER,
        "_arbitrate",
    ),
    "no wait for the sweep": (r"~swept(?=\),\n +going)", "1", behind_the_sweep, "_arbitrate"),
    "a waiting block in the sweep's way": (
        r"offered\.replicate\(BLOCK\)",
        "(self.i.valid & ~block.end & ~serving).replicate(BLOCK)",
        behind_the_sweep,
        "_arbitrate",
    ),
}


def collide(text):
    """Make a pixel wrong that is read while it is written: as a block RAM may do."""
    text, count = re.subn(
        r"if \((\S+?) ?\)\s+((?:even|odd)_\d)\[(addresses[^]]*\])\] <= (\S+?) ?;(.*?)"
        r"(_\d+_) <= \2\[(request[^]]*\])\];",
        r"if (\1 ) \2[\3] <= \4 ;\5\6 <= \1 && \3 == \7 ? ~\2[\7] : \2[\7];",
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
    expected = {case: [job.pictures() for job in made] for case, made in jobs.items()}

    def is_wrong(case, number):
        try:
            outcomes = play_with(number, jobs[case], built)
        except SimulationError:  # beats outside the frame, or none for too long
            return True
        return any(
            drawn.mismatches(picture)
            for outcome, pictures in zip(outcomes, expected[case], strict=True)
            for drawn, picture in zip(outcome.rasters, pictures, strict=True)
        )

    assert [case.__name__ for case in jobs if is_wrong(case, 0)] == []
    numbered = enumerate(IN_THE_WINDOW.items(), 1)
    unnoticed = [name for n, (name, (_, _, case, *_)) in numbered if not is_wrong(case, n)]
    assert unnoticed == []
