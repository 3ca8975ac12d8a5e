"""Chains of engines against golden's composite of the parts, bit for bit."""

import dataclasses
import functools
import itertools

import numpy as np
import pytest

from splatline.contract.chain_links import LINKS
from splatline.contract.presets import PAPER, SWIFT
from splatline.flow.chain_verilog import generate_chain
from splatline.host.encode.partition_methods import METHODS
from splatline.rtl.chain.chain import check_chain
from splatline.sim import golden
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player.chains import ChainJob, build_chain, play_chain
from splatline.sim.cosim.player.player import wrap
from tests.support.engines import engine
from tests.support.random_frames import frame_of, nonsense, random_raster, shapes
from tests.support.stalls import Stalled

SMALL = PAPER.replace(
    name="chained", x_bits=7, line_bits=7, material_bits=4, intensity_bits=8, depth_bits=12,
    colour_shift=11, pixels_per_word=2, window_lines=8,
)  # fmt: skip
"""A small engine, which builds fast."""

ENGINES = 3
QUICKEST = "icarus" if simulator.available("icarus") else "verilator"
"""The simulator that builds faster, for a few short frames."""

RATES = [
    {},
    {"codeword": 0.3},
    {"raster": 0.15},
    {"codeword": 0.7, "raster": 0.6, "initial": 0.3, "table": 0.3},
]


def stalled_chain(link, config=SMALL, engines=ENGINES):
    """A chain in which every link stalls at random."""
    seeds = iter(range(1, 100))

    def around(kind, part):
        return Stalled(part, next(seeds)) if kind in ("queue", "merger") else part

    text, _ = generate_chain(config, engines, link, around=around, queue=2)
    return wrap(text, config, engines)


def check(jobs, **options):
    """Play the jobs in one run and compare every picture; return the outcomes."""
    outcomes = play_chain(jobs, **options)
    for number, (job, outcome) in enumerate(zip(jobs, outcomes, strict=True)):
        for raster, expected in zip(outcome.rasters, job.pictures(), strict=True):
            assert raster.mismatches(expected) == 0, number
        assert in_step(outcome.times), number
    return outcomes


def in_step(times):
    """Return whether no engine began a frame before all had begun the one before it."""
    return all(
        max(before.opened) < min(after.opened) for before, after in itertools.pairwise(times)
    )


def dealt_unevenly(frame, rng):
    """Parts of which all but one have no elements, and parts without any."""
    nothing = dataclasses.replace(frame, codewords=frame.codewords[-1:])
    for place in range(ENGINES):
        yield [frame if n == place else nothing for n in range(ENGINES)]
    yield [nothing] * ENGINES
    yield [shapes(rng, 40, frame.width, frame.height, config=SMALL)] + [nothing] * (ENGINES - 1)


def jobs_of(rng):
    """Every way of partition, uneven ones, initial rasters, frames behind each other, resets."""
    jobs = []
    for seed, rates in enumerate(RATES):
        frame = shapes(rng, 150, 50, 40, config=SMALL)
        any_bits = nonsense(rng, 200, 33, 37, config=SMALL)
        options = {"rates": rates, "seed": seed}
        jobs += [
            ChainJob.partitioned(frame, engines=ENGINES, method=method, **options)
            for method in METHODS
        ]
        jobs.append(ChainJob.partitioned(any_bits, engines=ENGINES, **options))
        for parts in dealt_unevenly(shapes(rng, 60, 50, 40, config=SMALL), rng):
            tables = parts[0].tables
            parts = [dataclasses.replace(part, tables=tables) for part in parts]
            jobs.append(ChainJob(frames=[parts], **options))
        for share in (0.05, 0.6):
            initial = random_raster(rng, 50, 40, share, SMALL)
            jobs.append(ChainJob.partitioned(frame, engines=ENGINES, initial=initial, **options))
        jobs.append(following(rng, seed, {**rates, "table": 1.0}))
        jobs.append(without_new_tables(rng, rates, seed))
        jobs.append(
            ChainJob.partitioned(frame, engines=ENGINES, reset_after=97 * (seed + 2), **options)
        )
    return jobs


def following(rng, seed, rates):
    """Frames that differ in tables and size, some without an element, each pressing on the last."""
    frames = [
        shapes(rng, 90, 50, 40, config=SMALL),
        frame_of([], 20, 20, config=SMALL),
        shapes(rng, 60, 21, 50, config=SMALL),
        shapes(rng, 30, 64, 30, config=SMALL),
    ]
    initial = random_raster(rng, 50, 40, 0.3, SMALL) if seed % 2 else None
    return ChainJob.partitioned(*frames, engines=ENGINES, initial=initial, rates=rates, seed=seed)


def without_new_tables(rng, rates, seed, config=SMALL, engines=ENGINES):
    """Frames that follow while the ones before leave, over an initial raster now and then."""
    frames = [shapes(rng, count, 50, 37, config=config) for count in (70, 5, 40, 0, 0, 70, 70)]
    frames = [dataclasses.replace(frame, tables=frames[0].tables) for frame in frames]
    initial = random_raster(rng, 50, 37, 0.1, config) if seed % 2 else None
    return ChainJob.partitioned(
        *frames,
        engines=engines,
        method="lines",
        write_tables="first",
        initial=initial,
        rates=rates,
        seed=seed,
    )


@pytest.mark.parametrize("link", LINKS)
def test_every_picture_is_golden_s_under_stalls_on_every_link(link):
    check(jobs_of(np.random.default_rng(1)), built=stalled_chain(link))


TILES = SMALL.replace(pixels_per_word=4, window_lines=16)
BLOCKS = SMALL.replace(
    window="blocks", pixels_per_word=8, raster_words=2, window_lines=16,
    channel_bits=6, coefficient_bits=8, colour_shift=9,
)  # fmt: skip
"""With 6 bits a channel."""


@functools.cache
def chain_of_two(config, link):
    """A chain without more stalls than its ports have."""
    return build_chain(config, 2, link)


@pytest.mark.parametrize(
    ("config", "most", "build"),
    # Of blocks an engine that other tests build too: a chain of one adds nothing.
    [(TILES, 4, lambda config: build_chain(config, 1)), (SWIFT, 1, engine)],
    ids=["tiles", "blocks"],
)
def test_frames_follow_each_other_without_a_gap(config, most, build):
    """An engine takes a frame's first code word so many cycles behind the end word.

    With tiles an element waits until the end token has left the tiler.
    """
    rng = np.random.default_rng(2)
    frames = [shapes(rng, 300, 50, 48, largest=3, config=config) for _ in range(5)]
    frames = [dataclasses.replace(frame, tables=frames[0].tables) for frame in frames]
    job = ChainJob.partitioned(*frames, engines=1, write_tables="first")
    # The first of both waits for the memories to be cleared.
    times = check([job, job], built=build(config))[1].times
    assert len(times) == len(frames)
    for before, after in itertools.pairwise(times):
        assert before.closed[0] < after.opened[0] <= before.closed[0] + most
        assert after.opened[0] < before.end_beat


@pytest.mark.parametrize(
    ("config", "most", "link"),
    # Of the other two the same was measured; each takes a build.
    [(TILES, 5, "merge"), (BLOCKS, 1, "load")],
    ids=["tiles", "blocks"],
)
def test_frames_follow_each_other_in_a_chain_without_a_gap(config, most, link):
    """An engine takes a frame's first code word so many cycles behind its end word: as measured.

    With tiles an element waits until the end token has left the tiler. All engines of ``merge``
    keep to that. Of ``load`` the last one does, which has the most to load: those before it are
    ahead, and wait until it has begun the frame at hand. No engine waits until the picture has
    left.
    """
    rng = np.random.default_rng(2)
    frames = [shapes(rng, 900, 50, 48, largest=3, config=config) for _ in range(5)]
    frames = [dataclasses.replace(frame, tables=frames[0].tables) for frame in frames]
    job = ChainJob.partitioned(*frames, engines=2, method="elements", write_tables="first")
    times = check([job, job], built=chain_of_two(config, link))[1].times
    assert len(times) == len(frames)
    for before, after in itertools.pairwise(times):
        gaps = np.subtract(after.opened, before.closed)
        assert gaps.min() > 0
        assert (gaps if link == "merge" else gaps[-1:]).max() <= most
        assert max(after.opened) < before.end_beat


def test_where_depths_differ_a_chain_draws_what_one_engine_draws():
    """Against golden's picture of the whole stream, which knows no parts."""
    rng = np.random.default_rng(3)
    frame = shapes(rng, 200, 60, 50, config=SMALL)
    fields = golden.decode(frame.codewords, SMALL)
    words = frame.codewords & ~np.uint64(SMALL.z.mask << SMALL.z.lsb)
    words |= rng.permutation(SMALL.z.mask)[: len(words)].astype(np.uint64) << np.uint64(SMALL.z.lsb)
    words[fields["control"]] = frame.codewords[fields["control"]]
    frame = dataclasses.replace(frame, codewords=words)
    jobs = [ChainJob.partitioned(frame, engines=ENGINES, method=method) for method in METHODS]
    expected = golden.render(frame)
    for outcome in check(jobs, simulator_name=QUICKEST):
        assert outcome.rasters[0].mismatches(expected) == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((0, "merge"), "1 to 64 engines, not 0"),
        ((65, "merge"), "1 to 64 engines, not 65"),
        ((2.0, "load"), "not 2.0"),
        ((2, "glue"), "one of merge, load, not 'glue'"),
        ((2, "load", 1), "at least 2 beats, not 1"),
    ],
)
def test_what_is_no_chain_is_said(arguments, words):
    with pytest.raises(ValueError, match=words):
        check_chain(*arguments)


def test_the_verilog_has_each_part_once_and_a_port_for_each_engine():
    text, description = generate_chain(SMALL, 4, "merge", "top")
    modules = [line for line in text.splitlines() if line.startswith("module ")]
    names = ["top_first(", "top_engine(", "top_queue(", "top_merger(", "top("]
    assert all(sum(name in line for line in modules) == 1 for name in names)
    ports = {port["name"]: port for port in description["ports"]}
    assert "engine 3" in ports["codewords_3__payload"]["meaning"]
    assert ports["codewords_3__payload"]["width"] == 64
    assert ports["raster__payload"]["direction"] == "output"
    assert (description["engines"], description["link"]) == (4, "merge")
    assert description["latency"]["codeword_to_memory_cycles"] == 4


@pytest.mark.parametrize("link", [pytest.param("merge", marks=pytest.mark.thorough), "load"])
def test_engines_whose_beats_have_two_words(link):
    """Joined as others are, and loaded as a whole."""
    rng = np.random.default_rng(12)
    jobs = [
        ChainJob.partitioned(
            shapes(rng, 150, 50, 40, config=BLOCKS),
            engines=2,
            rates=rates,
            seed=seed,
            initial=random_raster(rng, 50, 40, 0.2, config=BLOCKS) if seed % 2 else None,
        )
        for seed, rates in enumerate(RATES)
    ]
    jobs += [
        without_new_tables(rng, rates, seed, BLOCKS, engines=2) for seed, rates in enumerate(RATES)
    ]
    check(jobs, built=chain_of_two(BLOCKS, link))
