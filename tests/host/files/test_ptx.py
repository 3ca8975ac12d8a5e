"""PTX files, written by hand."""

import gzip

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.colours import NEUTRAL
from tests.host.files.kinds import (
    COLOURS,
    COUNT,
    SPHERE,
    assert_coloured,
    assert_sphere,
    ptx,
    read,
    text,
)

MOVED = np.array([[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, 0], [654321.25, 5212345.5, 17.125, 1.0]])
"""A quarter of a turn about z, then into map coordinates; the translation is the last row."""


def test_points_with_intensity_and_colour(tmp_path):
    whole = ptx(SPHERE, np.full(COUNT, 0.5), COLOURS)
    for name, content in (("a.ptx", whole), ("b.ptx.gz", gzip.compress(whole.encode()))):
        cloud = read(tmp_path, name, content)
        assert_coloured(cloud)
        assert cloud.ignored == ("intensity",)


def test_an_intensity_alone_is_grey(tmp_path):
    cloud = read(tmp_path, "a.ptx", ptx(SPHERE, np.arange(COUNT) / COUNT))
    assert_sphere(cloud)
    assert (np.diff(cloud.colours[:, 0].astype(int)) >= 0).all()


def test_each_scan_is_moved_by_its_own_matrix(tmp_path):
    grey = np.full(COUNT, 0.5)
    cloud = read(tmp_path, "a.ptx", ptx(SPHERE, grey, matrix=MOVED) + ptx(SPHERE, grey, COLOURS))
    turned = np.column_stack([-SPHERE[:, 1], SPHERE[:, 0], SPHERE[:, 2]])
    expected = np.vstack([turned + MOVED[3, :3], SPHERE])
    assert np.abs(cloud.positions + cloud.origin - expected).max() < 1e-8
    assert (cloud.colours[:COUNT] == NEUTRAL).all()
    assert np.array_equal(cloud.colours[COUNT:], COLOURS)


def test_empty_returns_are_dropped_and_counted(tmp_path):
    points, grey = SPHERE.copy(), np.full(COUNT, 0.5)
    points[3:9] = 0.0
    cloud = read(tmp_path, "a.ptx", ptx(points, grey, matrix=MOVED))
    assert len(cloud) == COUNT - 6
    assert cloud.dropped == {"non_finite": 0, "empty": 6}


def test_wrong_files(tmp_path):
    whole = ptx(SPHERE, np.full(COUNT, 0.5))
    lines = whole.splitlines(keepends=True)
    for content, message in (
        (ptx(SPHERE, sides=(6, 11)), "ends after 60 of a scan's 66 points"),
        (ptx(SPHERE, sides=(10**6, 10**6)), "promises 1,000,000,000,000 points, more than"),
        (ptx(SPHERE, sides=(6, 0.5)), "a scan of 6 x 0.5 points"),
        (ptx(SPHERE, sides=(6, 9)), "line 65 does not fit a PTX header"),
        (ptx(SPHERE, COLOURS[:, :2]), "points of 5 numbers before line 71; 3, 4 or 7"),
        (ptx(SPHERE, matrix=np.full((4, 4), np.nan)), "transform is none"),
        ("".join(lines[:8]), "ends inside a scan's header"),
        ("".join(lines[:20]) + "a b c\n" + "".join(lines[21:]), "line 21 is no point"),
        ("".join(lines[:20]) + "\n" + "".join(lines[21:]), "line 21 is no point"),
        (ptx(np.zeros((COUNT, 3))), "has no points"),
        (text(SPHERE), "line 1 does not fit a PTX header"),
    ):
        with pytest.raises(InputError, match=message):
            read(tmp_path, "a.ptx", content)
