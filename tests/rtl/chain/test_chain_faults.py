"""Planted faults of merger and chain: the benches must notice them, or they prove nothing."""

import dataclasses
import functools

import numpy as np
import pytest

from splatline.contract.presets import PAPER
from splatline.flow.chain_verilog import generate_chain
from splatline.rtl.chain.chain import Chain
from splatline.rtl.chain.merger import Merger
from splatline.rtl.lib.fifo import Fifo
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player.chains import ChainJob, play_chain
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl.chain import test_chain, test_merger
from tests.support.planted import build, find_wrong, plant, play_with
from tests.support.random_frames import frame_of, shapes

pytestmark = pytest.mark.planted

SMALL, ENGINES = test_chain.SMALL, test_chain.ENGINES

QUICKEST = "icarus" if simulator.available("icarus") else "verilator"


MERGER_FAULTS = {
    "the lower place does not go first": (Merger, r"first\.eq\(.*\),", "first.eq(0),"),
    "the place drawn over does not go first": (Merger, r"second\.eq\(.*\),", "second.eq(0),"),
    "a beat is lost": (Merger, r"self\.own\.valid & ~second", "self.own.valid"),
    "a beat of the own picture is lost": (
        Merger,
        r"self\.before\.valid & ~first",
        "self.before.valid",
    ),
    "of equal depths the later stays": (Merger, r"depth <= own", "depth < own"),
    "what was drawn first always stays": (Merger, r"depth <= own\S+", "1)"),
    "what was drawn first never stays": (Merger, r"depth <= own\S+", "0)"),
    "one end ends the frame": (Merger, r"before\.end & own\.end\)", "before.end | own.end)"),
    "a beat goes on alone": (
        Merger,
        r"self\.before\.valid & self\.own\.valid\)",
        "self.before.valid)",
    ),
    "a queue that drops": (Fifo, r"self\.i\.ready\.eq\(fifo\.w_rdy\)", "self.i.ready.eq(1)"),
}


def test_wrong_rules_of_the_merger_are_noticed():
    """All in one build and one run."""
    built = build(
        lambda: Merger(PAPER),
        [(part, "elaborate", *line) for part, *line in MERGER_FAULTS.values()],
        simulator=QUICKEST,
    )
    faults = {name: ("one_over_the_other", n) for n, name in enumerate(MERGER_FAULTS, 1)}
    assert find_wrong(PAPER, built, test_merger, faults, whole=False) == []


def frames_under_table_writes(rng):
    """Frames of other tables behind each other; engines begin and end them far apart."""
    frames = [
        shapes(rng, 12, 20 + n, 16, config=SMALL)
        if n % 2 == 0
        else frame_of([], 20, 20, config=SMALL)
        for n in range(7)
    ]
    nothing = [dataclasses.replace(frame, codewords=frame.codewords[-1:]) for frame in frames]
    parts = [
        [frame if n == number % ENGINES else nothing[number] for n in range(ENGINES)]
        for number, frame in enumerate(frames)
    ]
    for seed, rate in enumerate((1.0, 0.2, 0.05, 0.05, 0.05)):
        yield ChainJob(frames=parts, rates={"codeword": rate}, seed=seed, most_cycles=4000)
    # And without: some engines have nothing to do, and could go on and on.
    same = {"tables": frames[0].tables, "width": 20, "height": 16}
    parts = [[dataclasses.replace(part, **same) for part in row] for row in parts]
    yield ChainJob(frames=parts, write_tables="first", most_cycles=4000)


CHAIN_FAULTS = [
    (r"engine\.tables\.valid\.eq\(self\.tables\.valid & between\)",
     "engine.tables.valid.eq(self.tables.valid)", "writes hold back frames that have begun"),
    (r"self\.tables\.ready\.eq\(between & all_idle\)",
     "self.tables.ready.eq(idle.any())", "engines miss writes"),
    (r"engine\.in_frame \| ~ahead\[n\]", "1", "engines begin the frame after next"),
    (r"words\.ready & ~engine\.in_frame", "words.ready & idle[n]",
     "an engine begins a frame unseen"),
]  # fmt: skip


@functools.cache
def planted_chain():
    """Build the chain with all of these faults."""
    with pytest.MonkeyPatch.context() as patch:
        edit = plant(patch, [(Chain, "_frames", *row[:2]) for row in CHAIN_FAULTS])
        text, _ = generate_chain(SMALL, ENGINES, queue=4)
        return wrap(edit(text), SMALL, ENGINES, simulator_name=QUICKEST)


@pytest.mark.parametrize(
    "number", range(len(CHAIN_FAULTS) + 1), ids=["none", *(row[2] for row in CHAIN_FAULTS)]
)
def test_a_chain_that_mixes_frames_is_noticed(number):
    """A picture is wrong, a frame does not end, or an engine is too far ahead."""
    jobs = list(frames_under_table_writes(np.random.default_rng(5)))

    def wrong():
        try:
            outcomes = play_with(number, jobs, planted_chain(), play_chain)
        except SimulationError:
            assert number
            return True
        pictures = [
            raster.mismatches(expected)
            for job, outcome in zip(jobs, outcomes, strict=True)
            for raster, expected in zip(outcome.rasters, job.pictures(), strict=True)
        ]
        return any(pictures) or not all(test_chain.in_step(outcome.times) for outcome in outcomes)

    assert wrong() == bool(number)
