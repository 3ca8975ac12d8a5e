"""Engines with planes against golden: every 96-bit word draws the depth that the contract says."""

import dataclasses
import functools

import numpy as np
import pytest

from splatline.contract.presets import PLANE
from splatline.flow.verilog import generate
from splatline.host.pipeline import make_frame
from splatline.host.visibility.view import fit_view
from splatline.rtl.engine import Engine
from splatline.rtl.front.sequencer import Sequencer
from splatline.rtl.tiles.plane_depths import PlaneDepths
from splatline.rtl.tiles.tiler import Tiler
from splatline.rtl.tiles.window import TileWindow
from splatline.sim import golden
from splatline.sim.cosim.player import frames
from splatline.sim.cosim.player.chains import ChainJob, build_chain, play_chain
from splatline.sim.cosim.player.jobs import STREAMS
from splatline.sim.cosim.player.player import wrap
from tests.support import engines
from tests.support import plane_words as pw
from tests.support.clouds import sphere
from tests.support.codewords import random_tables
from tests.support.engines import engine
from tests.support.planted import plant, play_with

ENGINES = [
    pytest.param(config, marks=[pytest.mark.thorough] if config is pw.DEEP else [])
    for config in pw.CONFIGS
]

FAULTS = {
    "no slope of the lower half": (Tiler, "_plane", r"lower \+ past", "past"),
    "the wrong group of lines": (Tiler, "_plane", r"past\[i\]", "past[0]"),
    "the wrong tile of two": (Tiler, "_plane", r"column \+ tile\.next", "tile.next"),
    "columns of the word before": (Tiler, "_plane", r"tile\.next\[j\]", "0"),
    "the block's own column": (Tiler, "_plane", r" - given\.before", ""),
    "the block's own line": (Tiler, "_plane", r" - given\.above", ""),
    "the lines of another block": (Sequencer, "elaborate", r"eq\(top\[:2\]\)", "eq(top[1:3])"),
    "moved beyond the block": (Tiler, "_halves", r"moved & ~stays", "moved"),
    "an end moved the other way": (Tiler, "_halves", r"Mux\(out, -1, 1\)", "Mux(out, 1, -1)"),
    "an empty row's half turn": (Tiler, "_halves", r" & shape\.filled\[k\]", ""),
    "the next frame goes early": (Engine, "elaborate", r"eq\(depths\.ending\)", "eq(0)"),
    "nothing before depth 0": (PlaneDepths, "_sum", r"step & total\[-1\]", "0"),
    "nothing beyond": (PlaneDepths, "_sum", r" & ~beyond", ""),
    "no overlap": (PlaneDepths, "elaborate", r"overlap\(m, tile, given\)", "0"),
    "the colour of the tile after": (
        PlaneDepths,
        "elaborate",
        r"shaded\.eq\(shaded",
        "shaded.eq(self.shade",
    ),
    "not cleared": (TileWindow, "_draw_depth", r"depth\.eq\(~0\)", "depth.eq(1)"),
}


def jobs(config, seeds, stalls=(0.0, 0.4), count=400):
    """Frames of random words, without and with stalls."""
    size = (40, 30) if config.x_bits > 6 else (33, 32)
    found = []
    for seed in seeds:
        frame = pw.random_frame(np.random.default_rng(seed), count, size, config)
        rates = dict.fromkeys(STREAMS, 1.0 - stalls[seed % len(stalls)])
        found.append(frames.Job(frame=frame, rates=rates, seed=seed))
    return found


def mismatches(played, outcomes):
    return [engines.mismatches(*pair) for pair in zip(played, outcomes, strict=True)]


def faulty_jobs():
    """Four frames, and two that are followed at once by one far below its window's first lines."""
    square = pw.encode([(0, 7)] * 4, mode=0, x=9, z=200, d=9)
    low = pw.make_frame([pw.advance(26), square], (40, 30))
    single = jobs(PLANE, range(4))
    return [
        *single,
        *(
            frames.Job(
                frame=job.frame,
                followed_by=[dataclasses.replace(low, tables=job.frame.tables)],
                write_tables="first",
            )
            for job in single[:2]
        ),
    ]


@pytest.mark.parametrize("config", ENGINES, ids=lambda config: config.name)
def test_random_words_are_drawn_as_golden_draws_them(config):
    played = jobs(config, range(6))
    assert mismatches(played, frames.play(played, built=engine(config))) == [0] * 6


def test_a_frame_starts_from_a_raster_and_another_follows():
    one, other = (job.frame for job in jobs(PLANE, (7, 8)))
    first = golden.render(one)
    (outcome,) = frames.play([frames.Job(frame=other, initial=first)], built=engine(PLANE))
    assert outcome.rasters[0].mismatches(golden.render(other, first)) == 0
    (outcome,) = frames.play([frames.Job(frame=one, followed_by=[other])], built=engine(PLANE))
    for frame, raster in zip((one, other), outcome.rasters, strict=True):
        assert raster.mismatches(golden.render(frame)) == 0


@pytest.mark.parametrize("config", ENGINES, ids=lambda config: config.name)
def test_every_extreme_of_slopes_scale_and_depth_at_every_place(config):
    played = [frames.Job(frame=frame) for frame in pw.extreme_frames(config)]
    assert mismatches(played, frames.play(played, built=engine(config))) == [0] * len(played)


def wide_jobs():
    """Random words about columns 2,048 and 4,095, and a small scene beyond column 2,048."""
    rng = np.random.default_rng(9)
    words = []
    for line in range(12):
        for x in (*rng.integers(2030, 2060, 12), *rng.integers(4076, 4096, 12)):
            word = pw.random_word(rng, (4096, 40), pw.WIDE)
            if not pw.is_control(word):
                lsb, width = pw.widths(pw.WIDE)["x"]
                words.append(word & ~((1 << width) - 1 << lsb) | int(x) << lsb)
        words.append(pw.advance(line % 3 + 1, pw.WIDE))
    tables = random_tables(rng, pw.WIDE)
    for width in (4096, 4095, 4087):
        yield frames.Job(frame=pw.make_frame(words, (width, 40), tables, pw.WIDE))
    ball = sphere(400)
    view = dataclasses.replace(fit_view(ball, size=(4096, 40)), shift=(900.0, 0.0))
    yield frames.Job(frame=make_frame(ball, view, radii=np.full(400, 0.1), config=pw.WIDE))


def test_a_wide_engine_draws_beyond_column_2048():
    played = list(wide_jobs())
    assert mismatches(played, frames.play(played, built=engine(pw.WIDE))) == [0] * len(played)
    for job in played:
        drawn = golden.render(job.frame).drawn
        assert drawn[:, 2048:].sum() > 300
    assert not drawn[:, :2048].any()  # the scene


@pytest.mark.thorough
def test_a_chain_of_two_draws_the_parts_over_each_other():
    """``tests/rtl/chain`` has chains of blocks, without planes."""
    frame, other = (job.frame for job in jobs(pw.FLAT, (9, 10)))
    played = [
        ChainJob.partitioned(frame, other, engines=2, method=method, rates=rates, seed=3)
        for method, rates in (("lines", {}), ("elements", {"codeword": 0.5, "raster": 0.4}))
    ]
    outcomes = play_chain(played, built=build_chain(pw.FLAT, 2))
    for job, outcome in zip(played, outcomes, strict=True):
        for raster, expected in zip(outcome.rasters, job.pictures(), strict=True):
            assert raster.mismatches(expected) == 0


@functools.cache
def planted():
    with pytest.MonkeyPatch.context() as patch:
        edit = plant(patch, [(part, *rest) for part, *rest in FAULTS.values()])
        return wrap(edit(generate(PLANE)[0]), PLANE)


@pytest.mark.planted
def test_without_a_fault_the_build_with_faults_is_right():
    played = faulty_jobs()
    assert mismatches(played, play_with(0, played, planted())) == [0] * 6


@pytest.mark.planted
@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_noticed(name):
    played = faulty_jobs()
    number = list(FAULTS).index(name) + 1
    assert any(mismatches(played, play_with(number, played, planted())))
