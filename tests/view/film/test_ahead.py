"""Values that threads make: in order, at once, and few of them."""

import threading
import time

import numba
import numpy as np
import pytest

from splatline.view.draw import Settings, draw
from splatline.view.film.ahead import ahead
from splatline.view.film.turntable import fit_turntable, turntable
from splatline.view.live_cloud import live_cloud
from tests.support.clouds import cloud_of, sphere

CORES = min(2, numba.get_num_threads())


def test_values_come_in_order_whichever_is_made_first():
    def make(number):
        time.sleep(0.004 * (number % 3))
        return 10 * number

    assert list(ahead(make, range(20))) == [10 * number for number in range(20)]
    assert list(ahead(make, [])) == []


def test_each_core_makes_a_value():
    together = threading.Barrier(CORES)

    def make(number):
        together.wait(timeout=30.0)  # until the other core makes one too
        return numba.get_num_threads()

    assert list(ahead(make, range(2 * CORES))) == [1] * (2 * CORES)
    assert numba.get_num_threads() >= CORES  # the caller's are as before


def test_an_error_comes_in_its_turn():
    def make(number):
        if number == 3:
            raise ValueError("the fourth")
        return number

    made = ahead(make, range(100))
    assert [next(made) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(ValueError, match="the fourth"):
        next(made)


def test_no_thread_is_left_when_the_rest_is_not_wanted():
    begun = []
    made = ahead(begun.append, range(1000))
    next(made)
    made.close()
    assert len(begun) <= 2 * numba.get_num_threads() + 1
    assert not [each for each in threading.enumerate() if each.name.startswith("splatline-ahead")]


def test_pictures_that_are_drawn_at_once_are_those_drawn_in_turn():
    positions = sphere(3000).positions
    live = live_cloud(cloud_of(positions, positions, 127.5 * (positions + 1.0)))
    cameras = turntable(fit_turntable(live.cloud, live.discs.radii, size=(96, 64)), 16)

    def picture(camera):
        return draw(live, camera, (96, 64), Settings(samples=2)).rgba

    for one, other in zip(ahead(picture, cameras), map(picture, cameras), strict=True):
        np.testing.assert_array_equal(one, other)
