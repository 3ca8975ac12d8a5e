import numpy as np

from splatline.host.encode.shape_table import EMPTY_SCANS, shape_table
from splatline.host.shading.normal_levels import level_slopes, quantise


def bitmaps(size):
    """Pixels of every entry of a size, upper rows only: shape (64, 64, half, 2 half)."""
    half = 4 if size <= 8 else 8
    table = shape_table()[size].astype(np.int64)
    pixels = np.zeros((64, 64, half, 2 * half), bool)
    column = np.arange(8)
    for fraction in range(4):
        row0, column0 = 4 * (fraction // 2), 8 * (fraction % 2)
        if row0 >= half or column0 >= 2 * half:
            assert (table[..., fraction] == EMPTY_SCANS).all()
            continue
        for row in range(4):
            first = table[..., fraction] >> 6 * row & 7
            last = table[..., fraction] >> 6 * row + 3 & 7
            covered = (column >= first[..., None]) & (column <= last[..., None])
            pixels[:, :, row0 + row, column0 : column0 + 8] = covered
    return pixels


def ellipse(size):
    """What the formula of the paper says of the same pixels: distance - r^2."""
    half = 4 if size <= 8 else 8
    slopes = level_slopes()
    sx, sy = slopes[:, None, None, None], slopes[None, :, None, None]
    dy = (np.arange(half) + 0.5 - half)[None, None, :, None]
    dx = (np.arange(2 * half) + 0.5 - half)[None, None, None, :]
    metric = dx * dx + dy * dy + (sx * dx + sy * dy) ** 2
    return metric, metric - (size / 2) ** 2


def test_every_entry_is_the_paper_s_ellipse():
    assert shape_table().shape == (17, 64, 64, 4)
    for size in range(17):
        pixels = bitmaps(size)
        metric, distance = ellipse(size)
        filled = (distance <= 0).any(axis=(2, 3))
        clear = np.abs(distance) > 1e-9  # a pixel's centre on the border may fall either way
        same = (pixels == (distance <= 0)) | ~clear
        assert same[filled].all(), size
        # An ellipse that covers no centre has one pixel (and its half turn), the nearest.
        thin = ~filled
        assert (pixels[thin].sum(axis=(1, 2)) == 1).all()
        nearest = metric[thin][pixels[thin]]
        assert np.allclose(nearest, metric[thin][:, -1].min(axis=1))


def test_no_entry_is_empty_and_most_sizes_fill_all_normals():
    for size in range(2, 17):
        assert bitmaps(size).any(axis=(2, 3)).all()


def test_levels_are_even_in_their_measure_and_cover_every_direction():
    slopes = level_slopes()
    measure = slopes / (1 + np.abs(slopes))
    assert np.allclose(np.diff(measure), 2 / 64)
    for level, slope in enumerate(slopes):
        # The slope is part / facing with facing negative.
        assert quantise(-slope, -1.0, 64) == level
        assert quantise(-slope * 1e-30, -1e-30, 64) == level
    assert quantise(1.0, -1e-300, 64) == 0
    assert quantise(-1.0, -1e-300, 64) == 63
    assert quantise(0.0, -1.0, 64) in (31, 32)
