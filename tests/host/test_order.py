import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from splatline.host.encode import Encoded
from splatline.host.order import advance_word, end_word, sort_by_line
from splatline.rtl.format import PAPER
from splatline.sim import golden


def in_chunks(words, lines, cuts=()):
    """Encoded words, cut into chunks at some places."""
    lines = np.array(lines, np.int16)
    edges = np.array([0, *sorted(cuts), len(lines)])
    counts = np.zeros((len(edges) - 1, 1028), np.int32)
    for chunk, (start, stop) in enumerate(itertools.pairwise(edges)):
        np.add.at(counts[chunk], lines[start:stop], 1)
    return Encoded(words, lines, edges[:-1], edges[1:], counts, len(lines))


@given(
    st.lists(st.integers(0, 1027), max_size=200).flatmap(
        lambda lines: st.tuples(st.just(lines), st.lists(st.integers(0, len(lines)), max_size=5))
    )
)
def test_words_come_by_line_with_the_halves_of_each_dealt_in_turn(lines_and_cuts):
    lines, cuts = lines_and_cuts
    # Elements that no line of the test could mistake: MODE 0, and their number for a payload.
    words = np.arange(len(lines), dtype=np.uint64) << np.uint64(25)
    stream, control_words = sort_by_line(in_chunks(words, lines, cuts), PAPER)
    assert len(stream) == len(lines) + control_words
    fields = golden.decode(stream, PAPER)
    assert fields["end"].tolist() == [False] * (len(stream) - 1) + [True]
    line, found = 0, []
    for word, field in zip(stream, fields, strict=True):
        if not field["control"]:
            found.append((line, int(word) >> 25))
        elif not field["end"]:
            line += int(field["x"])
    expected = []
    for line in sorted(set(lines)):
        numbers = [number for number, own in enumerate(lines) if own == line]
        half = (len(numbers) + 1) // 2
        dealt = itertools.zip_longest(numbers[:half], numbers[half:])
        expected += [(line, number) for pair in dealt for number in pair if number is not None]
    assert found == expected


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
