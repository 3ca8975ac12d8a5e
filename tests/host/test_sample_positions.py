"""Several samples a pixel: where they lie, and what their mean is."""

import dataclasses

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.presets import PAPER, PRESETS
from splatline.host.pipeline import make_frame, make_frames, total_counts
from splatline.host.sample_positions import SAMPLES
from splatline.host.shading.lighting import Light, Lighting
from splatline.host.visibility.view import View, fit_view
from splatline.sim import golden, reference
from splatline.sim.golden.multisample import average
from splatline.sim.reference import point_sampled as float_render
from tests.support.clouds import cloud_of, sphere


@pytest.mark.parametrize("samples", [number for number in SAMPLES if number > 1])
def test_no_two_samples_share_a_line_or_a_column(samples):
    places = np.array(SAMPLES[samples])
    assert len(places) == samples
    assert all(len(set(axis)) == samples for axis in places.T)
    assert (np.abs(places) <= 8).all()
    # About the pixel's centre; the whole 16 fill sixteenths, and so lie half of one off.
    assert (np.abs(places.mean(axis=0)) <= 0.5).all()


def test_a_single_sample_is_the_frame_itself():
    cloud = sphere(2000)
    view, radii = fit_view(cloud, size=(64, 48)), np.full(2000, 0.05)
    (frame,) = make_frames(cloud, view, radii=radii)
    other = make_frame(cloud, view, radii=radii)
    assert np.array_equal(frame.codewords, other.codewords)
    assert np.array_equal(frame.tables.ambient, other.tables.ambient)
    same = set(frame.counts) - {"seconds"}
    assert {key: frame.counts[key] for key in same} == {key: other.counts[key] for key in same}
    assert set(frame.counts["seconds"]) == set(other.counts["seconds"])


@pytest.mark.parametrize("shift", [(7, 0), (0, -5), (-210, 11)])
@pytest.mark.parametrize("quality", ["paper", "fast", "exact"])
def test_a_view_shifted_by_whole_pixels_is_the_same_picture_elsewhere(quality, shift):
    cloud = sphere(4000)
    view = fit_view(cloud, size=(512, 96))
    options = {"radii": np.full(4000, 0.06), "quality": quality, "depth_range": (1.0, 5.0)}
    moved = dataclasses.replace(view, shift=shift)
    before, after = (golden.render(make_frame(cloud, at, **options)) for at in (view, moved))
    right, down = shift
    y, x = np.mgrid[:96, :512]
    inside = (x - right >= 0) & (x - right < 512) & (y - down >= 0) & (y - down < 96)
    assert (after.drawn & inside).sum() > 1000
    unlike = after.depth[inside] != before.depth[y[inside] - down, x[inside] - right]
    # Places are float32: what lies on a border of pixels may fall on its other side.
    assert np.count_nonzero(unlike) <= 3


def test_the_exact_reference_follows_the_shift():
    cloud = sphere(500)
    view, radii = fit_view(cloud, size=(40, 40), zoom=0.7), np.full(500, 0.1)
    before = reference.render(cloud, view, radii, Lighting())
    after = reference.render(
        cloud, dataclasses.replace(view, shift=(3.25, -2.0)), radii, Lighting()
    )
    # A quarter of a pixel is one of its samples.
    assert after.coverage.sum() == pytest.approx(before.coverage.sum(), rel=0.02)
    centre = [(np.mgrid[:40, :40] * one.coverage).sum(axis=(1, 2)) for one in (before, after)]
    moved = centre[1] / after.coverage.sum() - centre[0] / before.coverage.sum()
    assert moved == pytest.approx([-2.0, 3.25], abs=5e-3)


def flat(grey):
    """A square that fills the image, lit to its own grey from everywhere."""
    y, x = np.mgrid[-40:41, -40:41] / 40.0
    places = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    cloud = cloud_of(places, np.tile([0.0, 0.0, 1.0], (len(places), 1)),
                     np.full((len(places), 3), grey))  # fmt: skip
    lighting = Lighting((Light((0.0, 0.0, -1.0), 0.0),), ambient=1.0)
    return cloud, fit_view(cloud, orbit=(0, 0), zoom=2.0, size=(16, 16)), lighting


@pytest.mark.parametrize("preset", ["paper", "rgb24", "swift"])
@pytest.mark.parametrize("samples", list(SAMPLES))
def test_more_samples_have_more_shades(preset, samples):
    config = PRESETS[preset]
    for grey in range(0, 256, 15):
        cloud, view, lighting = flat(grey)
        options = {"radii": np.full(len(cloud), 0.05), "config": config, "lighting": lighting}
        frames = make_frames(cloud, view, samples, **options)
        picture = average([golden.render(frame) for frame in frames])
        assert picture.drawn.all()
        # The equation's value before it is cut off, of which each frame shows the whole levels.
        diffuse = int(frames[0].tables.diffuse[0, 0]) * config.diffuse.mask
        level = diffuse / (1 << config.colour_shift)
        found = picture.to_rgb()[..., 0].mean() * config.channel_max
        assert abs(found - level) <= 0.5 / samples + 1e-9, grey


def one_point(place, diameter):
    """A disc of some diameter in pixels about a place of an image of 16 x 16 pixels."""
    view = View(np.zeros(3), np.eye(3), 100.0, 16, 16, 0.01)
    at = [(place[0] - 8.0) / 100.0, (place[1] - 8.0) / 100.0, 1.0]
    return cloud_of([at], [[0.0, 0.0, -1.0]]), view, np.array([0.5 * diameter / 100.0])


def test_a_sample_that_meets_nothing_stays_empty_where_others_meet_something():
    # About the first sample of four, an eighth and three eighths of a pixel left of and above the
    # centre.
    cloud, view, radii = one_point((5.5 - 2 / 16, 7.5 - 6 / 16), 0.3)
    frames = make_frames(cloud, view, 4, radii=radii)
    assert [frame.counts["elements"] for frame in frames] == [1, 0, 0, 0]
    assert {tuple(frame.counts["skips"]) for frame in frames} == {
        ("facing_away", "no_pixel", "outside", "overdrawn")
    }
    rasters = [golden.render(frame) for frame in frames]
    assert [int(raster.drawn.sum()) for raster in rasters] == [1, 0, 0, 0]
    assert total_counts(frames)["culled"]["no_pixel"] == 3


def test_where_no_sample_meets_anything_each_draws_a_pixel():
    cloud, view, radii = one_point((5.0, 7.0), 0.1)
    frames = make_frames(cloud, view, 4, radii=radii, skips=iter(["no_pixel", "outside"]))
    assert [frame.counts["elements"] for frame in frames] == [1] * 4
    assert {tuple(frame.counts["skips"]) for frame in frames} == {("outside",)}


def test_a_point_at_the_border_that_some_samples_see_is_drawn():
    cloud, view, radii = one_point((16.3, 7.5), 1.0)
    elements = [frame.counts["elements"] for frame in make_frames(cloud, view, 4, radii=radii)]
    assert 0 < sum(elements) < 4
    cloud, view, radii = one_point((30.0, 7.5), 1.0)
    with pytest.raises(InputError, match="nothing of test is in view: of 1 points, 1 outside;"):
        make_frames(cloud, view, 4, radii=radii)


def test_the_depth_range_may_be_an_array():
    cloud, view, radii = one_point((5.5, 7.5), 3.0)
    frames = make_frames(cloud, view, 2, radii=radii, depth_range=np.array([0.5, 2.0]))
    assert [frame.counts["depth_range"] for frame in frames] == [[0.5, 2.0]] * 2


def test_float_sampling_follows_the_shift():
    cloud = sphere(500)
    view, radii = fit_view(cloud, size=(48, 40), zoom=0.6), np.full(500, 0.1)
    moved = dataclasses.replace(view, shift=(5.0, -3.0))
    for depth in ("pixel", "fraction", "splat"):
        before, after = (
            float_render.render(cloud, at, radii, Lighting(), float_render.Steps(depth=depth))
            for at in (view, moved)
        )
        assert before.drawn.sum() > 200
        # The picture lies within the image; a place on a border may round to its other side.
        expected = np.roll(before.seen, (-3, 5), axis=(0, 1))
        assert np.count_nonzero(after.seen != expected) <= 2


def test_the_frames_of_a_picture_have_one_depth_range_and_are_counted_together():
    cloud = sphere(3000)
    view = fit_view(cloud, size=(64, 64))
    frames = make_frames(cloud, view, 4, radii=np.full(3000, 0.05), config=PAPER)
    total = total_counts(frames)
    assert len({tuple(frame.counts["depth_range"]) for frame in frames}) == 1
    assert len({frame.codewords.tobytes() for frame in frames}) == 4
    assert [int(frame.tables.ambient[0]) for frame in frames] == [128, 384, 640, 896]
    assert total["samples"] == 4
    assert total["points"] == 3000
    assert total["codewords"] == sum(len(frame.codewords) for frame in frames)
    assert total["elements"] + sum(total["culled"].values()) == 4 * 3000
    assert total["bits_sent"] == {"table": 64 * total["codewords"]}
    given = make_frames(cloud, view, 2, radii=np.full(3000, 0.05), depth_range=(1.0, 9.0))
    assert [frame.counts["depth_range"] for frame in given] == [[1.0, 9.0]] * 2


def test_edges_and_error_gain_with_samples():
    cloud = dataclasses.replace(sphere(4000), colours=np.full((4000, 3), 200, np.uint8))
    view, radii = fit_view(cloud, size=(96, 96)), np.full(4000, 0.06)
    exact = reference.render(cloud, view, radii, Lighting())
    errors = []
    for samples in (1, 4, 16):
        frames = make_frames(cloud, view, samples, radii=radii)
        picture = average([golden.render(frame) for frame in frames]).to_rgb()
        errors.append(float(np.mean((picture - exact.rgb) ** 2)))
    assert errors[1] < errors[0] / 3.0
    assert errors[2] < errors[1] / 1.3


@pytest.mark.parametrize("samples", [0, 3, 5, 64])
def test_a_number_of_samples_without_a_pattern_is_refused(samples):
    cloud = sphere(10)
    with pytest.raises(InputError, match=f"no pattern of {samples} samples; there are: 1, 2, 4"):
        make_frames(cloud, fit_view(cloud), samples, radii=np.ones(10))
