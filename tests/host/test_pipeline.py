import dataclasses

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.presets import DEFAULT
from splatline.host.files.readers import read_cloud
from splatline.host.pipeline import make_frame, make_frames
from splatline.host.shading.lighting import Light, Lighting
from splatline.host.visibility.block_index import build_index
from splatline.host.visibility.view import fit_view
from splatline.sim import golden
from tests.support.clouds import cloud_of, sphere
from tests.support.variants import variant


def frame_of(cloud, size=(96, 80), radius=0.06, **options):
    view = fit_view(cloud, size=size)
    return make_frame(cloud, view, radii=np.full(len(cloud), radius), **options)


def test_counts_add_up():
    frame = frame_of(sphere())
    counts = frame.counts
    assert counts["points"] == 2000
    assert counts["elements"] + sum(counts["culled"].values()) == 2000
    assert counts["culled"]["facing_away"] > 800
    assert counts["codewords"] == len(frame.codewords)
    assert counts["control_words"] == golden.decode(frame.codewords, frame.config)["control"].sum()
    low, high = counts["depth_range"]
    assert 0 < low < high
    assert all(seconds >= 0 for seconds in counts["seconds"].values())


def test_a_sphere_is_a_round_lit_closed_picture():
    frame = frame_of(sphere(6000), radius=0.08, size=(128, 128))
    picture = golden.render(frame)
    y, x = np.mgrid[:128, :128] + 0.5
    from_middle = np.hypot(x - 64, y - 64)
    radius = from_middle[picture.drawn].max()
    assert 55 < radius < 64
    assert picture.drawn[from_middle < radius - 4].mean() > 0.995
    # The middle is nearest, and the light comes from the upper left.
    assert picture.depth[64, 64] < 60 < picture.depth[64, 16]
    assert picture.colour[40, 40].sum() > picture.colour[100, 100].sum()


def test_the_nearer_surface_hides_the_further():
    near, far = [0, 0, 1.0], [0, 0, -1.0]
    cloud = cloud_of([far, near], [[0, 0, 1]] * 2, [[0, 0, 255], [255, 0, 0]])
    view = fit_view(cloud, orbit=(0, 0), size=(64, 64), up="y")
    lamp = Lighting((Light((0, 0, -1), 1.0),), 0.0, 0.0)
    for order in ([0, 1], [1, 0]):
        shuffled = dataclasses.replace(
            cloud, positions=cloud.positions[order], colours=cloud.colours[order]
        )
        picture = golden.render(
            make_frame(shuffled, view, radii=np.array([0.2, 0.2]), lighting=lamp)
        )
        red, _, blue = picture.colour[32, 32]
        assert red == DEFAULT.channel_max
        assert blue == 0


def test_the_same_cloud_gives_the_same_words():
    first, second = (frame_of(sphere()) for _ in range(2))
    assert (first.codewords == second.codewords).all()


@pytest.mark.parametrize("radii", [np.ones(9), np.full(10, -1.0), np.full(10, np.nan)])
def test_bad_radii_are_refused(radii):
    cloud = sphere(10)
    with pytest.raises(InputError, match="radius"):
        make_frame(cloud, fit_view(cloud), radii=radii)


def test_the_quality_is_chosen_by_name_and_recorded():
    frames = {name: frame_of(sphere(), quality=name) for name in ("paper", "fast", "exact")}
    for name, frame in frames.items():
        assert frame.counts["quality"] == name
        # The symmetric shapes have no element without a pixel.
        drawn = frame.counts["elements"] + frame.counts["culled"]["no_pixel"]
        assert drawn == frames["paper"].counts["elements"]
    assert frame_of(sphere()).counts["quality"] == "exact"
    with pytest.raises(InputError, match="there are: paper, fast, exact"):
        frame_of(sphere(), quality="best")


def test_nothing_in_view_is_one_clear_line():
    cloud = cloud_of([[0, 0, 0], [1, 1, 1]], [[0, 0, 1]] * 2)
    view = fit_view(cloud, size=(64, 64))
    behind = dataclasses.replace(view, eye=view.eye + 100 * view.axes[2])
    with pytest.raises(InputError, match=r"nothing of test is in view: of 2 points, 2 outside"):
        make_frame(cloud, behind, radii=np.ones(2))


@pytest.mark.parametrize("size", [(513, 10), (10, 1025)])
def test_an_image_beyond_the_engine_is_refused(size):
    with pytest.raises(InputError, match="at most 512x1024"):
        frame_of(sphere(10), size=size)


@pytest.mark.parametrize("offset", [(1e6, -3e6, 2e5), (1e7, 1e7, 1e7)])
def test_a_scan_in_map_coordinates_draws_the_picture_it_draws_at_the_origin(tmp_path, offset):
    ball = sphere(3000)
    # Millimetres, so that the offset loses nothing.
    places = np.rint(ball.positions * 1024) / 1024
    frames = []
    for shift in (np.zeros(3), np.array(offset)):
        path = tmp_path / "scan.npz"
        np.savez(path, positions=places + shift, normals=ball.normals, colours=ball.colours)
        frames.append(frame_of(read_cloud(path)))
    assert np.array_equal(frames[0].codewords, frames[1].codewords)


def test_an_index_gives_the_frame_that_its_cloud_gives():
    cloud = sphere()
    view, radii = fit_view(cloud, size=(96, 80)), np.full(len(cloud), 0.06)
    index = build_index(cloud, radii)
    assert np.array_equal(
        make_frame(index, view).codewords, make_frame(cloud, view, radii=radii).codewords
    )
    with pytest.raises(TypeError, match="radii and materials already"):
        make_frame(index, view, radii=radii)
    with pytest.raises(TypeError, match="measure_discs"):
        make_frame(cloud, view)


def test_an_engine_with_fewer_materials_refuses_the_index():
    rng = np.random.default_rng(3)
    ball = sphere()
    cloud = dataclasses.replace(ball, colours=rng.integers(0, 256, (2000, 3)).astype(np.uint8))
    index = build_index(cloud, np.full(2000, 0.06))
    view = fit_view(cloud, size=(64, 64))
    with pytest.raises(InputError, match="128 materials, an engine of preset depth12 holds 64"):
        make_frame(index, view, config=variant("depth12"))
    frame = make_frame(cloud, view, radii=np.full(2000, 0.06), config=variant("depth12"))
    assert golden.render(frame).drawn.any()


def test_the_share_is_told_after_the_index_and_after_each_frame():
    cloud = sphere(200)
    view = fit_view(cloud, size=(32, 32))
    radii = np.full(len(cloud), 0.1)
    told = []
    make_frames(cloud, view, 4, radii=radii, progress=told.append)
    assert told == pytest.approx([16 / 20, 17 / 20, 18 / 20, 19 / 20, 1.0])
    told.clear()
    make_frames(build_index(cloud, radii), view, 4, progress=told.append)
    assert told == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
