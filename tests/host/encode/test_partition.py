"""Dealing: every element once, in sorted streams of about the same length."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from splatline.contract.errors import InputError
from splatline.contract.frame import Frame, Tables
from splatline.contract.presets import PAPER, PRESETS
from splatline.host.encode.partition import partition
from splatline.host.encode.partition_methods import METHODS
from splatline.host.encode.sort_by_line import advance_word, end_word
from splatline.sim import golden
from tests.support.variants import variant


def frame_of(words, config=PAPER, width=96, height=64):
    size = (1 << config.material_bits, 3)
    kd = np.arange(size[0] * 3).reshape(size) % (1 << config.coefficient_bits)
    tables = Tables(np.zeros(3, np.int64), kd, kd[::-1].copy())
    return Frame(np.array(words, np.uint64), tables, width, height, config)


def random_frame(seed, count, config=PAPER, depths=None, advance=0.1, ended=True):
    """Any 64 bits: elements, steps down, and an end; ``depths`` gives each element its own."""
    rng = np.random.default_rng(seed)
    words = rng.integers(0, 1 << 64, count, np.uint64)
    if depths is not None:
        words &= ~np.uint64(config.z.mask << config.z.lsb)
        words |= depths.astype(np.uint64) << np.uint64(config.z.lsb)
        # All in the picture, and no control words but for those below.
        words &= ~np.uint64((config.x.mask & ~63) << config.x.lsb | 1)
    stepping = rng.random(count) < advance
    words[stepping] = [advance_word(int(n), config) for n in rng.integers(0, 5, stepping.sum())]
    words[golden.decode(words, config)["end"]] ^= np.uint64(1 << config.control_end.lsb)
    return frame_of([*words, *[end_word(config)] * ended], config)


def elements_of(frame):
    """Pairs of (line, word) in the stream's order."""
    fields = golden.decode(frame.codewords, frame.config)
    last = int(np.flatnonzero(fields["end"])[0])
    steps = fields["control"] & ~fields["end"]
    lines = np.cumsum(np.where(steps, fields["x"].astype(np.int64), 0))
    kept = ~fields["control"][:last]
    return list(
        zip(lines[:last][kept].tolist(), frame.codewords[:last][kept].tolist(), strict=True)
    )


@given(
    seed=st.integers(0, 1 << 20),
    count=st.integers(0, 400),
    engines=st.integers(1, 9),
    method=st.sampled_from(list(METHODS)),
    config=st.sampled_from([PAPER, variant("depth12")]),
    advance=st.sampled_from([0.0, 0.1, 0.9]),
)
def test_every_element_is_dealt_once_and_to_its_line(seed, count, engines, method, config, advance):
    frame = random_frame(seed, count, config, advance=advance)
    parts = partition(frame, engines, method)
    assert len(parts) == engines
    taken = [elements_of(part) for part in parts]
    assert sorted(itertools.chain(*taken)) == sorted(elements_of(frame))
    for part, elements in zip(parts, taken, strict=True):
        assert part.codewords[-1] == end_word(config)
        assert part.counts == {"elements": len(elements)}
        assert len(part.codewords) <= len(frame.codewords)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("engines", [2, 4, 8])
def test_the_parts_are_of_one_size(method, engines):
    sizes = [
        len(elements_of(p))
        for p in partition(random_frame(1, 20_000, advance=0.01), engines, method)
    ]
    # Lines with fewer elements than engines cannot be cut evenly.
    most = {"columns": 12, "elements": 1, "lines": 200}[method]
    assert max(sizes) - min(sizes) <= most


@pytest.mark.parametrize("method", METHODS)
def test_the_parts_over_each_other_are_the_whole_where_depths_differ(method):
    depths = np.random.default_rng(2).permutation(511)
    frame = random_frame(3, 511, depths=depths, advance=0.05)
    expected = golden.render(frame)
    assert expected.drawn.mean() > 0.3
    raster = None
    for part in partition(frame, 5, method):
        raster = golden.render(part, raster)
    assert raster.mismatches(expected) == 0


def test_round_robin_keeps_the_order():
    frame = random_frame(4, 1000)
    whole = elements_of(frame)
    for n, part in enumerate(partition(frame, 3, "elements")):
        assert elements_of(part) == whole[n::3]


def test_lines_stay_together():
    owners = {}
    for n, part in enumerate(partition(random_frame(5, 2000), 4, "lines")):
        for line, _ in elements_of(part):
            assert owners.setdefault(line, n) == n


@pytest.mark.parametrize("preset", ["paper", "rgb24", "swift"])
def test_strips_of_columns_lie_side_by_side_and_their_halves_take_turns(preset):
    frame = random_frame(6, 4000, PRESETS[preset])
    last = {}
    for part in partition(frame, 4, "columns"):
        lines = {}
        for line, word in elements_of(part):
            lines.setdefault(line, []).append(word >> PAPER.x.lsb & PAPER.x.mask)
        for line, columns in lines.items():
            assert min(columns) >= last.get(line, 0), "a strip lies right of the one before"
            last[line] = max(columns)
            for turn, some in enumerate(np.array_split(sorted(columns), 2)):
                assert columns[turn::2] == list(some)


def test_steps_longer_than_x_holds_are_cut():
    far = [advance_word(500, PAPER)] * 3
    frame = frame_of([5, *far, 7, end_word(PAPER)])
    first, second = partition(frame, 2, "elements")
    assert elements_of(second) == [(1500, 7)]
    assert len(second.codewords) == 5
    assert elements_of(first) == [(0, 5)]


@pytest.mark.parametrize(
    ("frame", "engines", "method", "words"),
    [
        (random_frame(1, 5), 2, "cards", "no partition method named 'cards'; there are: columns"),
        (random_frame(1, 5), 0, "lines", "at least one engine, not 0"),
        (random_frame(1, 5, ended=False), 2, "lines", "no end-of-frame word"),
    ],
)
def test_what_cannot_be_dealt_is_said(frame, engines, method, words):
    with pytest.raises(InputError, match=words):
        partition(frame, engines, method)
