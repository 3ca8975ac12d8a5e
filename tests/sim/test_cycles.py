import numpy as np
import pytest

from splatline.host.frame import Frame, Tables
from splatline.host.order import end_word
from splatline.rtl.format import PAPER
from splatline.sim.cycles import least_cycles


def frame_of(rows, x, mode):
    scans = sum((first | last << 3) << 6 * row for row, (first, last) in enumerate(rows))
    word = mode | scans << 1 | x << PAPER.x.lsb
    table = np.zeros((128, 3), np.int64)
    stream = np.array([word, end_word(PAPER)], np.uint64)
    return Frame(stream, Tables(np.zeros(3, np.int64), table, table), 512, 512)


@pytest.mark.parametrize(
    ("rows", "x", "mode", "expected"),
    [
        # Four lines, two words each: one cycle only where neighbouring words lie apart.
        ([(0, 7)] * 4, 4, 1, (2, 2, 1)),
        # Three words in each of eight lines: three columns; 24 words in eight banks.
        ([(0, 7)] * 4, 5, 0, (3, 3, 3)),
        # A slanted shape: no line touches more than one word, but together they touch two.
        ([(0, 3), (0, 3), (4, 7), (4, 7)], 4, 1, (2, 1, 1)),
        # A small disc across two words.
        ([(1, 0), (1, 0), (3, 4), (3, 4)], 0, 0, (2, 2, 1)),
        ([(1, 0)] * 4, 1, 0, (1, 1, 1)),
    ],
)
def test_known_shapes(rows, x, mode, expected):
    assert tuple(least_cycles(frame_of(rows, x, mode)).values()) == expected
