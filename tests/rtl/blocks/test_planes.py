"""The blocks engine with planes against golden, where its memory is as unkind as it may be."""

import functools

import numpy as np
import pytest

from splatline.contract.presets import SWIFT_PLANE
from splatline.flow.verilog import generate
from splatline.rtl.blocks.plane_row import PlaneLaneRow
from splatline.rtl.blocks.tiler import BlockTiler
from splatline.sim import golden
from splatline.sim.cosim.player import frames
from splatline.sim.cosim.player.jobs import STREAMS
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cycles.cycles import count_cycles
from tests.rtl import test_presets
from tests.rtl.blocks.test_window_faults import collide
from tests.rtl.test_planes import jobs, mismatches
from tests.sim.cycles import test_cycles
from tests.support import plane_words as pw
from tests.support.planted import plant, play_with
from tests.support.random_frames import nonsense, shapes

BLOCKS = {"window": "blocks", "pixels_per_word": 8, "raster_words": 2}
DEEP = pw.DEEP.replace(name="deep-blocks", **BLOCKS)
FLAT = pw.FLAT.replace(name="flat-blocks", window_lines=32, **BLOCKS)
"""At the limits of a configuration, as the engines of ``plane_words``; the second with a window as
narrow and as high as can be."""

FAULTS = {
    "half of the block's lines": (
        BlockTiler,
        "_lay",
        r"plane\.down \* row",
        "plane.down * row[:2]",
    ),
    "half of its columns": (BlockTiler, "_lay", r"\* column", "* column[:2]"),
    "Z in quarters": (BlockTiler, "elaborate", r"lanes\.z << 1", "lanes.z"),
    "moved beyond the block": (BlockTiler, "_half_turns", r"\[: BLOCK - 2\], 1", "[: BLOCK - 1]"),
    "outwards beyond it": (BlockTiler, "_half_turns", r"given\[1:\], 1", "given[1:], 0"),
    "an end moved the other way": (
        BlockTiler,
        "_half_turns",
        r"outwards, inwards\)",
        "inwards, outwards)",
    ),
    "an empty row's half turn": (BlockTiler, "_half_turns", r" & shape\.filled\[k\]", ""),
    "nothing before depth 0": (PlaneLaneRow, "_saturate", r"1, levels\[-1\]", "1, 0"),
    "loaded as the sum is": (PlaneLaneRow, "_saturate", r"self\.request\.store", "0"),
    "nothing beyond": (PlaneLaneRow, "_saturate", r"levels\[bits:-1\]\.any\(\)", "0"),
    "not cleared": (PlaneLaneRow, "_test", r"eq\(caught\.store\)", "eq(0)"),
    "the other word's depth": (PlaneLaneRow, "_test", r'olds\["odd"\]', 'olds["even"]'),
    "as it was read": (PlaneLaneRow, "_test", r"forwarded, old", "old, old"),
    "what the one before drew": (PlaneLaneRow, "_test", r"forwarded, old", "earlier, old"),
    "the other word was drawn": (PlaneLaneRow, "_meet", r"again\.odd\[n\]", "again.even[n]"),
    "of another line": (PlaneLaneRow, "_meet", r" & \(now == last\)", ""),
    "over what is nearer": (PlaneLaneRow, "_meet", r"there & behind", "0"),
    "hidden by what is behind": (PlaneLaneRow, "_meet", r"there & behind", "there"),
    "equal drawn over": (PlaneLaneRow, "_meet", r"new >= last", "new > last"),
    "hidden by another line": (PlaneLaneRow, "_meet", r" & \(then == last\)", ""),
}


def crowded(seed, count=600):
    """A frame of words on few places and of few depths, so that most meet the two before them.

    Some lie eight lines apart, in one row of lanes: the window holds both.
    """
    rng = np.random.default_rng(seed)
    words = [pw.advance(4)]
    spread = (1, 2, 9)[seed % 3]
    steps = (0, 0, 0, 8, 1) if seed % 2 else (0,) * 30 + (1,)
    for _ in range(count):
        rows = np.sort(rng.integers(0, 8, (4, 2)))
        if rng.random() < 0.5:
            rows[:] = 0, 7
        slopes = {name: int(rng.integers(-4, 5)) for name in "ab"}
        x, z = int(rng.integers(5, 5 + spread)), int(rng.integers(40, 56))
        look = {name: int(rng.integers(128)) for name in "dsm"}
        words.append(
            pw.encode(rows.tolist(), mode=int(rng.integers(2)), x=x, z=z, **slopes, **look)
        )
        if lines := int(rng.choice(steps)):
            words.append(pw.advance(lines))
    return pw.make_frame(words, (40, 90), config=SWIFT_PLANE)


def crowds(seeds=range(6)):
    rates = dict.fromkeys(STREAMS, 0.7)
    return [
        frames.Job(frame=crowded(seed), rates=rates if seed > 2 else {}, seed=seed)
        for seed in seeds
    ]


@functools.cache
def for_faults():
    """Frames of random words, crowded ones, and such over a picture that is loaded first."""
    picture = golden.render(crowded(3))
    over = [frames.Job(frame=crowded(seed), initial=picture, seed=seed) for seed in (1, 2)]
    return [*jobs(SWIFT_PLANE, range(4)), *crowds(), *over]


@functools.cache
def unkind():
    """Build the engine with all faults, and with memories that give anything while written."""
    with pytest.MonkeyPatch.context() as patch:
        edit = plant(patch, list(FAULTS.values()))
        return wrap(collide(edit(generate(SWIFT_PLANE)[0])), SWIFT_PLANE)


@pytest.mark.parametrize(
    "config",
    [pytest.param(DEEP, marks=pytest.mark.thorough), FLAT],
    ids=lambda config: config.name,
)
def test_random_words_are_drawn_as_golden_draws_them(config):
    played = jobs(config, range(6))
    assert mismatches(played, frames.play(played)) == [0] * 6


@pytest.mark.planted
def test_without_a_fault_the_build_with_faults_is_right():
    assert mismatches(for_faults(), play_with(0, for_faults(), unkind())) == [0] * 12


@pytest.mark.planted
@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_noticed(name):
    number = list(FAULTS).index(name) + 1
    assert any(mismatches(for_faults(), play_with(number, for_faults(), unkind())))


def draw(jobs):
    """Draw jobs with the preset's engine, whose faults are off: its only build in the tests."""
    return play_with(0, jobs, unkind())


def test_the_preset_draws_what_the_contract_says():
    assert test_presets.wrong_pixels(SWIFT_PLANE, draw) == {}


def test_the_preset_takes_the_cycles_that_are_counted():
    taken, counted = test_presets.cycles(SWIFT_PLANE, draw)
    assert taken == counted
    assert test_cycles.cycles_of_ten_splats(SWIFT_PLANE, draw) <= 100


def test_the_model_counts_its_cycles():
    rng = np.random.default_rng(3)
    played = [frames.Job(frame=crowded(seed)) for seed in range(4)]
    for width, height in ((64, 48), (509, 30), (13, 90), (1, 1)):
        played += [
            frames.Job(frame=part(rng, 400, width, height, config=SWIFT_PLANE))
            for part in (shapes, nonsense)
        ]
    outcomes = play_with(0, played, unkind())
    assert mismatches(played, outcomes) == [0] * 12
    counted = [count_cycles(job.frame, after_reset=n == 0) for n, job in enumerate(played)]
    assert [outcome.cycles for outcome in outcomes] == counted


def test_a_word_a_cycle_in_any_order():
    """Without stalls of the ports: as many cycles more for twice the words as there are words."""
    one, two = (frames.Job(frame=crowded(0, count)) for count in (300, 600))
    outcomes = play_with(0, [one, two], unkind())
    words = len(two.frame.codewords) - len(one.frame.codewords)
    assert outcomes[1].cycles - outcomes[0].cycles <= words


def test_a_frame_starts_from_a_raster_and_another_follows():
    one, other = (job.frame for job in jobs(SWIFT_PLANE, (7, 8)))
    first = golden.render(one)
    played = [
        frames.Job(frame=other, initial=first, rates=dict.fromkeys(STREAMS, rate), seed=1)
        for rate in (1.0, 0.5)
    ]
    for outcome in play_with(0, played, unkind()):
        assert outcome.rasters[0].mismatches(golden.render(other, first)) == 0
    (outcome,) = play_with(0, [frames.Job(frame=one, followed_by=[other])], unkind())
    for frame, raster in zip((one, other), outcome.rasters, strict=True):
        assert raster.mismatches(golden.render(frame)) == 0
