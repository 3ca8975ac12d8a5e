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
from splatline.sim.cosim.blocks import run_bench
from splatline.sim.cosim.player.chains import ChainJob, play_chain
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cosim.simulator import SimulationError
from tests.rtl.chain import test_chain, test_merger
from tests.support.faults import fault, rewrite
from tests.support.planted import plant, play_with
from tests.support.random_frames import frame_of, shapes

SMALL, ENGINES = test_chain.SMALL, test_chain.ENGINES

QUICKEST = "icarus" if simulator.available("icarus") else "verilator"


def expect_noticed(edit=None):
    """The merger's bench fails on what it sees, and not because nothing was built."""
    with pytest.raises(SimulationError) as failure:
        run_bench(
            Merger(PAPER),
            test_merger.__file__,
            test="one_over_the_other",
            edit=edit,
            simulator_name=QUICKEST,
        )
    assert "FAIL=1" in str(failure.value)


MERGER_FAULTS = [
    ("first", "1'h0", "the lower place does not go first"),
    ("second", "1'h0", "the place drawn over does not go first"),
    ("before__ready", "i__ready & own__valid", "a beat is lost"),
    ("own__ready", "i__ready & before__valid", "a beat of the own picture is lost"),
]


@pytest.mark.parametrize(
    ("signal", "value"), [pytest.param(*planted[:2], id=planted[2]) for planted in MERGER_FAULTS]
)
def test_a_fault_in_the_merger_is_noticed(signal, value):
    expect_noticed(fault("dut", signal, value))


@pytest.mark.parametrize(
    ("pattern", "replacement"),
    [
        pytest.param(r"depth <= own", "depth < own", id="of equal depths the later stays"),
        pytest.param(r"depth <= own\S+", "1)", id="what was drawn first always stays"),
        pytest.param(r"depth <= own\S+", "0)", id="what was drawn first never stays"),
        pytest.param(
            r"before\.end & own\.end\)", "before.end | own.end)", id="one end ends the frame"
        ),
        pytest.param(
            r"self\.before\.valid & self\.own\.valid\)",
            "self.before.valid)",
            id="a beat goes on alone",
        ),
    ],
)
def test_a_wrong_rule_of_the_merger_is_noticed(monkeypatch, pattern, replacement):
    rewrite(monkeypatch, Merger, "elaborate", pattern, replacement)
    expect_noticed()


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


def test_a_queue_that_drops_is_noticed(monkeypatch):
    rewrite(
        monkeypatch, Fifo, "elaborate", r"self\.i\.ready\.eq\(fifo\.w_rdy\)", "self.i.ready.eq(1)"
    )
    expect_noticed()
