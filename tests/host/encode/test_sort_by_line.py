import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from splatline.contract.frame import are_control
from splatline.contract.presets import PAPER, PLANE
from splatline.host.encode.encode import Encoded
from splatline.host.encode.sort_by_line import advance_word, end_word, sort_by_line
from splatline.sim import golden


def in_chunks(words, lines, cuts=()):
    """Encoded words, cut into chunks at some places."""
    lines = np.array(lines, np.int16)
    edges = np.array([0, *sorted(cuts), len(lines)])
    counts = np.zeros((len(edges) - 1, 1028), np.int32)
    for chunk, (start, stop) in enumerate(itertools.pairwise(edges)):
        np.add.at(counts[chunk], lines[start:stop], 1)
    return Encoded(words, lines, edges[:-1], edges[1:], counts, len(lines))


def by_line(stream, config=PAPER):
    """The elements of each line that has any, in the stream's order: line -> words."""
    low = stream[:, 0] if config.plane else stream
    found, line = {}, 0
    for word, half, control in zip(stream.tolist(), low, are_control(low, config), strict=True):
        if not control:
            found.setdefault(line, []).append(tuple(word) if config.plane else word)
        else:
            line += int(half) >> config.x.lsb & config.x.mask
    return found


def turn(rank, count, total):
    """The share of a line's way at which a word of a group goes."""
    return int((2 * rank + 1) * (total / (2 * count)))


@given(
    st.lists(
        st.tuples(
            st.sampled_from([0, 1, 700, 1027]),
            st.integers(0, 511) | st.sampled_from([0, 7, 8, 300]),
            st.integers(0, 511),
        ),
        max_size=200,
    ).flatmap(
        lambda keys: st.tuples(st.just(keys), st.lists(st.integers(0, len(keys)), max_size=5))
    )
)
def test_words_come_by_line_and_from_every_other_group_of_columns_in_turn(keys_and_cuts):
    keys, cuts = keys_and_cuts
    lines, columns, depths = zip(*keys, strict=True) if keys else ((), (), ())
    words = np.array(columns, np.uint64) << np.uint64(PAPER.x.lsb)
    words |= np.array(depths, np.uint64) << np.uint64(PAPER.z.lsb)
    stream, control_words = sort_by_line(in_chunks(words, lines, cuts), PAPER)
    assert len(stream) == len(lines) + control_words
    assert golden.decode(stream, PAPER)["end"].tolist() == [False] * (len(stream) - 1) + [True]
    found = by_line(stream)
    assert list(found) == sorted(set(lines))
    for line, sent in found.items():
        wanted = []
        for odd in (0, 1):
            groups = {}
            for (at, column, _), word in zip(keys, words.tolist(), strict=True):
                if at == line and column // 8 % 2 == odd:
                    groups.setdefault(column // 8, []).append((column, word))
            total = sum(map(len, groups.values()))
            wanted += sorted(
                (turn(rank, len(group), total), number, rank, word)
                for number, group in groups.items()
                for rank, (_, word) in enumerate(sorted(group))
            )
        assert sent == [word for *_, word in wanted]


def random_words(rng, config, count, width):
    """Elements of any kind, and their lines and columns."""
    columns = rng.integers(0, width, count)
    low = rng.integers(0, 1 << 63, count, dtype=np.uint64) << np.uint64(1)
    low |= rng.integers(0, 2, count, dtype=np.uint64)
    low &= ~np.uint64(config.x.mask << config.x.lsb)
    low |= columns.astype(np.uint64) << np.uint64(config.x.lsb)
    # Few depths, so that many pixels have words of one depth.
    if config.plane:
        high = rng.integers(0, 4, count, dtype=np.uint64) << np.uint64(config.z.lsb - 64 + 1)
        words = np.stack([low, high], axis=1)
    else:
        low &= ~np.uint64(config.z.mask << config.z.lsb)
        low |= rng.integers(0, 4, count, dtype=np.uint64) << np.uint64(config.z.lsb)
        words = low
    kept = ~are_control(low, config)
    return words[kept], rng.integers(4, 40, count)[kept], columns[kept]


@pytest.mark.parametrize("config", [PAPER, PLANE], ids=["words", "planes"])
def test_the_order_of_words_that_share_a_pixel_depends_on_them_alone(config):
    rng = np.random.default_rng(3)
    words, lines, columns = random_words(rng, config, 1200, 96)
    everything = by_line(sort_by_line(in_chunks(words, lines), config)[0], config)
    some = rng.random(len(words)) < 0.4
    shuffled = rng.permutation(np.flatnonzero(some))
    part = by_line(sort_by_line(in_chunks(words[shuffled], lines[shuffled]), config)[0], config)
    pairs = 0
    for line, sent in part.items():
        column = {word: int((word[0] if config.plane else word) >> config.x.lsb & config.x.mask)
                  for word in sent}  # fmt: skip
        rank = {word: number for number, word in enumerate(everything[line])}
        for number, word in enumerate(sent):
            for other in sent[:number]:
                if abs(column[word] - column[other]) <= 8:
                    pairs += 1
                    assert rank[other] < rank[word]
    assert pairs > 300
    assert len(set(columns.tolist())) > 80


@pytest.mark.parametrize("config", [PAPER, PLANE], ids=["words", "planes"])
def test_many_words_of_one_column_are_sorted_in_short_time(config):
    rng = np.random.default_rng(4)
    words, *_ = random_words(rng, config, 30_000, 1)
    found = by_line(sort_by_line(in_chunks(words, np.full(len(words), 9)), config)[0], config)[9]
    key = (lambda word: (word[1], word[0])) if config.plane else None
    assert found == sorted(found, key=key)


def test_one_control_word_crosses_any_number_of_empty_lines_that_x_holds():
    words = np.zeros(3, np.uint64)
    _, control_words = sort_by_line(in_chunks(words, [0, 511, 512]), PAPER)
    assert control_words == 3  # to 511, to 512, the end
    _, control_words = sort_by_line(in_chunks(words[:1], [512]), PAPER)
    assert control_words == 3  # 511 and 1, the end


def test_control_words_are_the_contract_s():
    fields = golden.decode(np.array([advance_word(300, PAPER), end_word(PAPER)], np.uint64), PAPER)
    assert fields["control"].all()
    assert fields["end"].tolist() == [False, True]
    assert fields["x"][0] == 300
