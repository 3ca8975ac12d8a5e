import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from splatline.contract.presets import PAPER
from splatline.host.encode.encode import Encoded
from splatline.host.encode.sort_by_line import advance_word, end_word, sort_by_line
from splatline.sim import golden


def in_chunks(words, lines, turns=None, cuts=()):
    """Encoded words, cut into chunks at some places."""
    lines = np.array(lines, np.int16)
    turns = np.zeros(len(lines), np.uint8) if turns is None else np.array(turns, np.uint8)
    edges = np.array([0, *sorted(cuts), len(lines)])
    counts = np.zeros((len(edges) - 1, 1028), np.int32)
    for chunk, (start, stop) in enumerate(itertools.pairwise(edges)):
        np.add.at(counts[chunk], lines[start:stop], 1)
    return Encoded(words, lines, turns, edges[:-1], edges[1:], counts, len(lines))


@given(
    st.lists(
        st.tuples(st.integers(0, 1027), st.sampled_from([0, 1, 7, 300, 511]), st.integers(0, 255)),
        max_size=200,
    ).flatmap(
        lambda keys: st.tuples(st.just(keys), st.lists(st.integers(0, len(keys)), max_size=5))
    )
)
def test_words_come_by_line_and_from_four_strips_of_it_by_column_and_turn(keys_and_cuts):
    keys, cuts = keys_and_cuts
    lines, columns, turns = zip(*keys, strict=True) if keys else ((), (), ())
    # Elements that no line of the test could mistake: MODE 0, and their number for a payload.
    words = np.arange(len(lines), dtype=np.uint64) << np.uint64(25)
    words |= np.array(columns, np.uint64) << np.uint64(PAPER.x.lsb)
    stream, control_words = sort_by_line(in_chunks(words, lines, turns, cuts), PAPER)
    assert len(stream) == len(lines) + control_words
    fields = golden.decode(stream, PAPER)
    assert fields["end"].tolist() == [False] * (len(stream) - 1) + [True]
    line, found = 0, {}
    for word, field in zip(stream, fields, strict=True):
        if not field["control"]:
            found.setdefault(line, []).append(int(word) >> 25 & 255)
        elif not field["end"]:
            line += int(field["x"])
    assert list(found) == sorted(set(lines))
    for line, numbers in found.items():
        ordered = sorted(
            (number for number in range(len(lines)) if lines[number] == line),
            key=lambda number: (columns[number], turns[number]),
        )
        assert [number for strip in range(4) for number in numbers[strip::4]] == ordered


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
