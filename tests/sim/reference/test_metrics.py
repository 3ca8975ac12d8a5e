import json
import math

import numpy as np
import pytest

from splatline.contract.raster import Raster
from splatline.sim.reference.metrics import compare
from splatline.sim.reference.reference import Reference

KEYS = {
    "psnr_db", "psnr_foreground_db", "ssim", "hole_fraction", "silhouette_iou", "depth_rmse",
}  # fmt: skip
RANGE = (10.0, 20.0)


def scene(width=20, height=16):
    """A square in front of white, drawn without any error: the raster, and a reference of it."""
    raster = Raster.background(width, height)
    raster.depth[4:12, 6:14] = 255
    raster.colour[4:12, 6:14] = [7, 0, 0]
    coverage = raster.drawn.astype(np.float64)
    depth = np.where(raster.drawn, 15.0, np.nan)
    return raster, Reference(raster.to_rgb(), depth, coverage)


def test_equal_pictures_have_no_error():
    measures = compare(*scene(), depth_range=RANGE)
    assert set(measures) == KEYS
    assert measures["psnr_db"] is None  # infinite
    assert measures["psnr_foreground_db"] is None
    assert measures["ssim"] == pytest.approx(1.0)
    assert measures["hole_fraction"] == 0.0
    assert measures["silhouette_iou"] == 1.0
    assert measures["depth_rmse"] == 0.0


def test_a_constant_error_has_the_psnr_of_its_size():
    raster, exact = scene()
    off = Reference(exact.rgb * 0.9 + 0.05, exact.depth, exact.coverage)  # 0.05 everywhere
    assert compare(raster, off)["psnr_db"] == pytest.approx(-20 * math.log10(0.05))
    assert compare(raster, off)["psnr_foreground_db"] == pytest.approx(-20 * math.log10(0.05))


def test_the_foreground_is_measured_apart():
    raster, exact = scene()
    rgb = exact.rgb.copy()
    rgb[exact.coverage == 1.0] -= [0.1, 0.0, 0.0]
    measures = compare(raster, Reference(rgb, exact.depth, exact.coverage))
    assert measures["psnr_foreground_db"] == pytest.approx(-10 * math.log10(0.01 / 3))
    assert measures["psnr_db"] == pytest.approx(-10 * math.log10(0.01 / 3 * 64 / 320))


def test_the_background_is_that_of_the_reference():
    raster, exact = scene()
    black = Reference(raster.to_rgb((0, 0, 0)), exact.depth, exact.coverage)
    assert compare(raster, black, background=(0, 0, 0))["psnr_db"] is None
    assert compare(raster, black)["psnr_db"] == pytest.approx(-10 * math.log10(256 / 320))


def test_a_missing_pixel_is_a_hole():
    raster, exact = scene()
    raster.depth[5, 7] = raster.config.background_depth
    raster.colour[5, 7] = 0
    measures = compare(raster, exact, depth_range=RANGE)
    assert measures["hole_fraction"] == pytest.approx(1 / 64)
    assert measures["silhouette_iou"] == pytest.approx(63 / 64)
    assert measures["depth_rmse"] == 0.0


def test_a_pixel_that_is_not_wholly_covered_cannot_be_a_hole():
    raster, exact = scene()
    coverage = exact.coverage.copy()
    coverage[5, 7] = 0.9375
    raster.depth[5, 7] = raster.config.background_depth
    measures = compare(raster, Reference(exact.rgb, exact.depth, coverage))
    assert measures["hole_fraction"] == 0.0
    assert measures["silhouette_iou"] == pytest.approx(63 / 64)


def test_a_shifted_silhouette_overlaps_by_the_rest():
    raster, exact = scene()
    moved = Reference(exact.rgb, exact.depth, np.roll(exact.coverage, 2, axis=1))
    assert compare(raster, moved)["silhouette_iou"] == pytest.approx(6 / 10)


def test_half_a_coverage_is_outside_and_more_is_inside():
    raster, exact = scene()
    coverage = np.where(exact.coverage == 1.0, 0.5, 0.0)
    assert compare(raster, Reference(exact.rgb, exact.depth, coverage))["silhouette_iou"] == 0.0
    coverage[coverage == 0.5] = 0.5625
    assert compare(raster, Reference(exact.rgb, exact.depth, coverage))["silhouette_iou"] == 1.0


def test_the_depth_error_is_a_share_of_the_range():
    raster, exact = scene()
    off = Reference(exact.rgb, exact.depth + 1.0, exact.coverage)
    assert compare(raster, off, depth_range=RANGE)["depth_rmse"] == pytest.approx(0.1)
    raster.depth[4:8, 6:14] = 0  # half of the pixels at 10, the others at 15, all should be at 15
    assert compare(raster, exact, depth_range=RANGE)["depth_rmse"] == pytest.approx(
        math.sqrt(0.125)
    )


def test_the_largest_depth_code_is_the_end_of_the_range():
    raster, exact = scene()
    raster.depth[raster.drawn] = 510
    far = Reference(exact.rgb, exact.depth + 5.0, exact.coverage)
    assert compare(raster, far, depth_range=list(RANGE))["depth_rmse"] == pytest.approx(0.0)


def test_ssim_is_that_of_wang_and_others():
    # Two constant pictures: only the luminance term counts, (2 a b + c) / (a^2 + b^2 + c).
    raster = Raster.background(16, 16)
    nothing = np.full((16, 16), np.nan)
    exact = Reference(np.full((16, 16, 3), 0.5), nothing, np.zeros((16, 16)))
    c = 0.01**2
    expected = (2 * 0.5 + c) / (1 + 0.25 + c)
    assert compare(raster, exact)["ssim"] == pytest.approx(expected)


def test_what_is_not_defined_is_none():
    raster = Raster.background(10, 30)  # too narrow for the window of SSIM
    empty = Reference(raster.to_rgb(), np.full((30, 10), np.nan), np.zeros((30, 10)))
    assert compare(raster, empty, depth_range=RANGE) == dict.fromkeys(KEYS)


@pytest.mark.parametrize("depth_range", [None, (3.0, 3.0)])
def test_without_a_range_there_is_no_depth_error(depth_range):
    assert compare(*scene(), depth_range=depth_range)["depth_rmse"] is None


def test_the_measures_are_plain_numbers():
    raster, exact = scene()
    raster.depth[5, 7] = raster.config.background_depth
    raster.colour[5, 7] = 0
    measures = compare(raster, exact, depth_range=RANGE)
    assert json.loads(json.dumps(measures, allow_nan=False)) == measures
    assert {type(value) for value in measures.values()} == {float}


def test_pictures_of_two_sizes_do_not_compare():
    with pytest.raises(ValueError, match=r"\(16, 21\)"):
        compare(scene(width=21)[0], scene()[1])
