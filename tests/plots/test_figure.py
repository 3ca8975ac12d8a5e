import numpy as np
import pytest
from PIL import Image

from splatline.contract.errors import InputError
from splatline.contract.presets import PAPER
from splatline.contract.raster import Raster
from splatline.plots import figure
from splatline.sim.reference.reference import Reference

NAMES = [
    "depth.png", "difference.png", "engine.png", "figure.png", "golden.png", "reference.png",
]  # fmt: skip


def read(path):
    with Image.open(path) as picture:
        return np.asarray(picture)


def scene(width=48, height=32, seed=4):
    rng = np.random.default_rng(seed)
    raster = Raster.background(width, height)
    inside = rng.random((height, width)) < 0.5
    raster.depth[inside] = rng.integers(0, 511, (height, width))[inside]
    raster.colour[inside] = rng.integers(0, 8, (height, width, 3))[inside]
    rgb = np.clip(raster.to_rgb(figure.BACKGROUND) + rng.normal(0, 0.1, (height, width, 3)), 0, 1)
    return raster, Reference(rgb, np.where(inside, 5.0, np.nan), inside.astype(float))


def write(folder, *, rtl=False, stats=None, **size):
    golden, exact = scene(**size)
    verilog = Raster(golden.depth.copy(), golden.colour.copy()) if rtl else None
    figure.picture_set(folder, rtl=verilog, golden=golden, reference=exact, stats=stats)
    return golden, exact


def test_rgb_is_rounded_and_clipped_to_8_bits(tmp_path):
    rgb = np.array([[[0.0, 1.0, 0.5], [-1.0, 2.0, 127.4 / 255]]])
    figure.save_rgb(tmp_path / "a.png", rgb)
    assert read(tmp_path / "a.png").tolist() == [[[0, 255, 128], [0, 255, 127]]]


def test_the_background_is_a_colour_of_8_bits(tmp_path):
    figure.save_rgb(tmp_path / "a.png", np.full((1, 1, 3), figure.BACKGROUND))
    assert read(tmp_path / "a.png").tolist() == [[[23, 26, 31]]]


def test_a_depth_picture_has_all_of_the_depth(tmp_path):
    raster = Raster.background(32, 16)
    raster.depth[:] = np.arange(512).reshape(16, 32)
    figure.save_depth(tmp_path / "a.png", raster)
    picture = read(tmp_path / "a.png").astype(np.int64)
    assert picture[0, 0] == 65535
    assert picture[-1, -1] == 0
    assert (np.diff(picture.ravel()) < 0).all()
    np.testing.assert_array_equal(511 - np.rint(picture * 511 / 65535), raster.depth)


@pytest.mark.parametrize("save", ["rgb", "depth"])
def test_a_picture_that_cannot_be_written_is_bad_input(tmp_path, save):
    with pytest.raises(InputError, match="missing"):
        if save == "rgb":
            figure.save_rgb(tmp_path / "missing" / "a.png", np.zeros((1, 1, 3)))
        else:
            figure.save_depth(tmp_path / "missing" / "a.png", Raster.background(1, 1))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("rtl", [False, True])
def test_the_set_has_every_picture_in_the_image_s_size(tmp_path, rtl):
    golden, exact = write(tmp_path, rtl=rtl)
    assert sorted(path.name for path in tmp_path.iterdir()) == NAMES
    drawn = golden.to_rgb(figure.BACKGROUND)
    np.testing.assert_array_equal(read(tmp_path / "engine.png"), np.rint(drawn * 255))
    np.testing.assert_array_equal(read(tmp_path / "golden.png"), np.rint(drawn * 255))
    np.testing.assert_array_equal(read(tmp_path / "reference.png"), np.rint(exact.rgb * 255))
    assert read(tmp_path / "depth.png").shape == (32, 48)


def test_the_difference_is_amplified(tmp_path):
    raster = Raster.background(2, 1)
    exact = Reference(raster.to_rgb((0, 0, 0)), np.full((1, 2), np.nan), np.zeros((1, 2)))
    exact.rgb[0] = [[0.1, 0.0, 0.2], [0.25, 0.26, 1.0]]
    figure.picture_set(tmp_path, rtl=None, golden=raster, reference=exact, background=(0, 0, 0))
    expected = [[[102, 0, 204], [255, 255, 255]]]
    assert figure.GAIN == 4
    assert read(tmp_path / "difference.png").tolist() == expected


def test_the_engine_s_picture_is_the_verilog_s(tmp_path):
    golden, exact = scene()
    verilog = Raster.background(48, 32)
    verilog.depth[0, 0] = 3
    figure.picture_set(tmp_path, rtl=verilog, golden=golden, reference=exact)
    np.testing.assert_array_equal(
        read(tmp_path / "engine.png"), np.rint(verilog.to_rgb(figure.BACKGROUND) * 255)
    )
    np.testing.assert_array_equal(
        read(tmp_path / "golden.png"), np.rint(golden.to_rgb(figure.BACKGROUND) * 255)
    )
    depth = read(tmp_path / "depth.png")
    assert np.argwhere(depth).tolist() == [[0, 0]]


def test_an_empty_picture_has_a_figure_too(tmp_path):
    raster = Raster.background(8, 8)
    exact = Reference(raster.to_rgb(), np.full((8, 8), np.nan), np.zeros((8, 8)))
    figure.picture_set(tmp_path, rtl=raster, golden=raster, reference=exact)
    assert sorted(path.name for path in tmp_path.iterdir()) == NAMES


def test_the_files_are_named(tmp_path):
    golden, exact = scene()
    files = figure.picture_set(tmp_path, rtl=None, golden=golden, reference=exact)
    assert sorted(files) == [tmp_path / name for name in NAMES]


def test_pictures_of_two_sizes_do_not_make_a_set(tmp_path):
    golden, _ = scene()
    with pytest.raises(ValueError, match="sizes"):
        figure.picture_set(tmp_path, rtl=None, golden=golden, reference=scene(width=47)[1])
    assert not list(tmp_path.iterdir())


def test_a_wide_deep_engine_has_a_depth_picture(tmp_path):
    config = PAPER.replace(depth_bits=16, x_bits=4, intensity_bits=6)
    raster = Raster.background(2, 1, config)
    raster.depth[0, 0] = 1
    figure.save_depth(tmp_path / "a.png", raster)
    assert read(tmp_path / "a.png").tolist() == [[65534, 0]]
