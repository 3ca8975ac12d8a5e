"""How coarse a moving picture is."""

import pytest

from splatline.view.pace import BUDGET, Pace, ladder


def run(pace, seconds_of, frames):
    """Draw some frames; return the divisor of each."""
    divisors = []
    for _ in range(frames):
        divisors.append(pace.divisor)
        pace.took(seconds_of(pace.divisor))
    return divisors


def test_the_steps_have_the_largest_picture_without_tiles():
    assert ladder((512, 400), (512, 512)) == [1.0, 2.0, 4.0, 8.0]
    assert ladder((1280, 800), (512, 512)) == [1.0, 2.0, 2.5, 4.0, 8.0]
    assert ladder((4096, 4096), (512, 512)) == [1.0, 2.0, 4.0, 8.0]
    assert ladder((8192, 100), (512, 512))[-1] == 8.0


def test_a_fast_picture_keeps_its_size():
    assert set(run(Pace(), lambda divisor: 0.9 * BUDGET, 50)) == {1.0}


def test_a_single_late_picture_changes_nothing_but_two_do():
    pace = Pace()
    pace.took(1.5 * BUDGET)
    assert pace.divisor == 1.0
    pace.took(0.5 * BUDGET)
    pace.took(1.5 * BUDGET)
    assert pace.divisor == 1.0
    pace.took(1.5 * BUDGET)
    assert pace.divisor == 2.0


def test_a_slow_picture_is_halved_until_it_fits():
    divisors = run(Pace(), lambda divisor: 12.0 * BUDGET / divisor**2, 60)
    assert divisors[:3] == [1.0, 2.0, 4.0]
    # Now and then a finer one is tried, lest it has become faster.
    assert divisors.count(4.0) > 50


def test_what_never_fits_is_as_coarse_as_it_gets():
    assert run(Pace(), lambda divisor: 5.0 * BUDGET, 20)[-1] == 8.0


def test_it_is_finer_again_when_the_view_is_faster():
    pace = Pace()
    run(pace, lambda divisor: 12.0 * BUDGET / divisor**2, 10)
    assert pace.divisor == 4.0
    assert run(pace, lambda divisor: 0.05 * BUDGET, 5)[-1] == 1.0


@pytest.mark.parametrize(("share", "divisor"), [(0.5, 1.0), (2.0, 4.0)])
def test_a_picture_at_rest_tells_whether_the_full_size_fits(share, divisor):
    pace = Pace()
    run(pace, lambda divisor: 12.0 * BUDGET / divisor**2, 10)
    pace.took_full(share * BUDGET)
    assert pace.divisor == divisor
