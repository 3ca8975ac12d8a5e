import numpy as np
import pytest

from splatline.sim import golden
from splatline.sim.stress.case import draw, measure
from splatline.sim.stress.planes import plane_cases
from splatline.sim.stress.word_checks import fragments
from tests.support import plane_words as pw

CASES = plane_cases()


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_no_plane_wraps_or_leaves_its_disc(case):
    assert measure(case, "exact").problems == ()


def test_the_fragments_of_random_plane_words_are_those_of_golden():
    frame = pw.random_frame(np.random.default_rng(3), 400, (40, 30))
    part = fragments(frame)
    nearest = np.full((frame.height, frame.width), 4095)
    np.minimum.at(nearest, (part.line, part.column), part.depth)
    assert np.array_equal(nearest, golden.render(frame).depth)


def test_depths_reach_both_ends_and_slopes_all_scales():
    scales, depths = set(), set()
    for case in CASES:
        frame, picture = draw(case.make(), "exact")
        words = pw.integers_of(frame.codewords)
        scales |= {pw.bits(word, 81, 2) for word in words if not pw.is_control(word)}
        depths |= set(np.unique(picture.depth).tolist())
    assert scales == {0, 1, 2, 3}
    assert min(depths) <= 8  # rims are within the range
    assert max(depths - {4095}) >= 4000
