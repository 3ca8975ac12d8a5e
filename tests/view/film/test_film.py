"""Films decoded again, against golden frames."""

import threading
from fractions import Fraction

import av
import numba
import numpy as np
import pytest
from PIL import Image, ImageSequence

from splatline.contract.errors import InputError
from splatline.view.draw import Settings, draw
from splatline.view.film import film as films
from splatline.view.film.film import film, make_film
from splatline.view.film.form import Form
from splatline.view.film.turntable import fit_turntable, turntable
from splatline.view.film.write_mp4 import write_mp4
from splatline.view.live_cloud import live_cloud
from tests.support.clouds import cloud_of, sphere

SIZE = (96, 64)
SETTINGS = Settings(samples=2, background=(23 / 255, 26 / 255, 31 / 255))
BT709 = (1.5748, 0.1873, 0.4681, 1.8556)
BT601 = (1.402, 0.3441, 0.7141, 1.772)


@pytest.fixture(scope="module")
def live():
    """A ball coloured by place."""
    positions = sphere(3000).positions
    return live_cloud(cloud_of(positions, positions, 127.5 * (positions + 1.0)))


@pytest.fixture(scope="module")
def cameras(live):
    return turntable(fit_turntable(live.cloud, live.discs.radii, size=SIZE), 12)


@pytest.fixture(scope="module")
def golden(live, cameras):
    return [draw(live, camera, SIZE, SETTINGS).rgba[..., :3] for camera in cameras]


def psnr(one, other):
    return 10.0 * np.log10(255.0**2 / np.mean((np.asarray(one, float) - other) ** 2))


def rgb_of(frame, coefficients=BT709):
    """Return a 4:2:0 frame of limited range as red, green and blue, by the standard's formula."""
    planes = frame.to_ndarray(format="yuv420p").astype(float)
    height, width = frame.height, frame.width
    luma = (planes[:height] - 16.0) * 255.0 / 219.0
    chroma = (planes[height:].reshape(2, height // 2, width // 2) - 128.0) * 255.0 / 224.0
    blue, red = chroma.repeat(2, axis=1).repeat(2, axis=2)
    of_red, green_blue, green_red, of_blue = coefficients
    return np.stack(
        [luma + of_red * red, luma - green_blue * blue - green_red * red, luma + of_blue * blue],
        axis=-1,
    ).clip(0.0, 255.0)


def mp4_frames(path):
    with av.open(path) as container:
        stream = container.streams.video[0]
        return stream, list(container.decode(stream))


def picture_frames(path):
    with Image.open(path) as image:
        assert image.info["loop"] == 0
        found = [(np.array(one.convert("RGB")), one.info["duration"])
                 for one in ImageSequence.Iterator(image)]  # fmt: skip
    return [frame for frame, _ in found], [duration for _, duration in found]


def test_an_mp4_has_the_golden_frames(tmp_path, live, cameras, golden):
    made = make_film(live, cameras, tmp_path / "a.mp4", size=SIZE, fps=24, settings=SETTINGS)
    assert (made.frames, made.seconds) == (12, 0.5)
    assert made.bytes == (tmp_path / "a.mp4").stat().st_size
    stream, frames = mp4_frames(tmp_path / "a.mp4")
    assert len(frames) == stream.frames == 12
    assert stream.average_rate == 24
    assert stream.duration * stream.time_base == Fraction(1, 2)
    assert stream.codec_context.pix_fmt == "yuv420p"
    assert (frames[0].width, frames[0].height) == SIZE
    for frame, drawn in zip(frames, golden, strict=True):
        assert psnr(rgb_of(frame), drawn) > 30.0  # colours have half the resolution
        grey = np.array([0.2126, 0.7152, 0.0722])
        assert psnr(rgb_of(frame) @ grey, drawn @ grey) > 34.5
    data = (tmp_path / "a.mp4").read_bytes()
    assert data.index(b"moov") < data.index(b"mdat")


def test_the_colours_of_an_mp4_are_tagged_and_right(tmp_path):
    colours = np.array(
        [[255, 0, 0], [0, 255, 0], [0, 0, 255], [200, 120, 40], [23, 26, 31], [250, 250, 250]]
    )
    frame = np.repeat(np.repeat(colours[np.newaxis], 16, axis=1), 32, axis=0).astype(np.uint8)
    with (tmp_path / "a.mp4").open("wb") as stream:
        write_mp4(iter([frame] * 3), stream, Form((96, 32), 3, 30.0, 100.0))
    stream, frames = mp4_frames(tmp_path / "a.mp4")
    context = stream.codec_context
    # 1 is BT.709 in all three, and the limited range.
    assert context.color_primaries == context.color_trc == context.colorspace == 1
    assert context.color_range == 1
    middles = rgb_of(frames[1])[16, 8::16]
    assert np.abs(middles - colours).max() < 4.0
    # Another matrix would be seen.
    assert np.abs(rgb_of(frames[1], BT601)[16, 8::16] - colours).max() > 10.0


def test_a_lossless_webp_is_golden_to_the_bit(tmp_path, live, cameras, golden):
    make_film(
        live, cameras, tmp_path / "a.webp", size=SIZE, fps=30, fidelity=100, settings=SETTINGS
    )
    frames, durations = picture_frames(tmp_path / "a.webp")
    assert sum(durations) == 400
    assert max(durations) - min(durations) <= 1
    for frame, drawn in zip(frames, golden, strict=True):
        assert (frame == drawn).all()


def test_a_webp_is_near_golden_and_smaller(tmp_path, live, cameras, golden):
    sizes = []
    for fidelity in (30, 80):
        path = tmp_path / "a.webp"
        make_film(live, cameras, path, size=SIZE, fps=30, fidelity=fidelity, settings=SETTINGS)
        frames, _ = picture_frames(path)
        sizes.append(path.stat().st_size)
    assert min(psnr(*pair) for pair in zip(frames, golden, strict=True)) > 32.0
    assert sizes[0] < sizes[1]


def test_a_gif_is_near_golden_and_its_background_exact(tmp_path, live, cameras, golden):
    make_film(live, cameras, tmp_path / "a.gif", size=SIZE, fps=30, settings=SETTINGS)
    frames, durations = picture_frames(tmp_path / "a.gif")
    assert sum(durations) == 400
    for frame, drawn in zip(frames, golden, strict=True):
        assert psnr(frame, drawn) > 32.0
        clear = (drawn == (23, 26, 31)).all(axis=-1)
        assert clear.any()
        assert (frame[clear] == (23, 26, 31)).all()
    assert len(np.unique(np.concatenate(frames).reshape(-1, 3), axis=0)) <= 255


def test_nothing_flickers_in_a_gif_that_stands_still(tmp_path, live, cameras):
    make_film(live, [cameras[0]] * 4, tmp_path / "a.gif", size=SIZE, fps=10, settings=SETTINGS)
    frames, durations = picture_frames(tmp_path / "a.gif")
    assert all((frame == frames[0]).all() for frame in frames)
    assert sum(durations) == 400


@pytest.mark.parametrize("suffix", [".mp4", ".gif", ".webp"])
@pytest.mark.parametrize("error", [KeyboardInterrupt, InputError])
def test_a_film_is_written_whole_or_not_at_all(tmp_path, live, cameras, monkeypatch, suffix, error):
    drawn = []

    def broken(*arguments):
        drawn.append(arguments)
        if len(drawn) > 12 + 4:
            raise error("stopped")
        return np.zeros((64, 96, 3), np.uint8)

    monkeypatch.setattr(films, "_pixels", broken)
    path = tmp_path / f"a{suffix}"
    path.write_text("an older film")
    with pytest.raises(error):
        make_film(live, cameras * 4, path, size=SIZE, fps=30, settings=SETTINGS)
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
    assert path.read_text() == "an older film"
    assert not [each for each in threading.enumerate() if each.name.startswith("splatline-ahead")]


def test_few_frames_are_in_memory(tmp_path, live, cameras, monkeypatch):
    made = []

    def count(*arguments):
        made.append(arguments)
        return np.zeros((64, 96, 3), np.uint8)

    shown, most = [], []

    def progress(share):
        shown.append(share)
        most.append(len(made) - len(shown))

    monkeypatch.setattr(films, "_pixels", count)
    make_film(live, cameras * 5, tmp_path / "a.webp", size=SIZE, fps=30, progress=progress)
    assert len(shown) == 60
    assert shown[-1] == 1.0
    assert max(most) <= 2 * numba.get_num_threads() + 1


def test_one_call_makes_a_film_of_a_cloud(tmp_path):
    made = film(sphere(200), tmp_path / "a.webp", size=(32, 32), seconds=0.2, fps=20)
    assert made.frames == 4
    with pytest.raises(InputError, match="frames"):
        film(sphere(200), tmp_path / "b.webp", seconds=1e9)


@pytest.mark.parametrize(
    ("name", "options", "told"),
    [
        ("a.avi", {}, r"\.mp4"),
        ("a.mp4", {"size": (33, 20)}, "34x20"),
        ("a.gif", {"fps": 60}, "50 frames"),
        ("a.webp", {"fps": 0}, "frames a second"),
        ("a.webp", {"fidelity": 101}, "fidelity"),
        ("a.webp", {"seconds": -1}, "seconds"),
        ("a.webp", {"samples": 3}, "samples"),
        ("absent/a.webp", {"size": (16, 16), "seconds": 0.1}, "absent"),
    ],
)
def test_a_film_that_cannot_be_is_told_in_a_line(tmp_path, name, options, told):
    with pytest.raises(InputError, match=told) as error:
        film(sphere(50), tmp_path / name, **options)
    assert "\n" not in str(error.value)


def test_a_missing_extra_is_told_in_a_line(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "av", None)
    with pytest.raises(InputError, match=r"PyAV: pip install '\.\[film\]'"):
        film(sphere(50), tmp_path / "a.mp4")
