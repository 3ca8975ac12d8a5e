"""Plane words of the host, by the contract in plain Python, against the disc's true plane."""

import dataclasses

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.contract.presets import PLANE
from splatline.host.encode.encode import encode
from splatline.host.encode.partition import partition
from splatline.host.encode.plane_block import row_ends
from splatline.host.encode.sort_by_line import sort_by_line
from splatline.host.frame_file import describe_frame, load_frame, save_frame
from splatline.host.pipeline import make_frame
from splatline.host.visibility.footprint import conic
from splatline.host.visibility.occlusion import cover_planes, new_pyramid
from splatline.host.visibility.splats import SPLAT, Splats
from splatline.host.visibility.view import View, fit_view
from splatline.sim import golden
from tests.support import plane_words as pw
from tests.support.clouds import cloud_of, sphere
from tests.support.codewords import bits

FOCAL = 800.0
WIDTH, HEIGHT = 64, 48


def view_of(focal=FOCAL):
    return View(np.zeros(3), np.eye(3), focal, WIDTH, HEIGHT, 0.01)


def one_splat(column, line, diameter, slopes, depth=1.0):
    data = np.zeros(1, SPLAT)
    data["column"], data["line"], data["diameter"] = column, line, diameter
    data["slope_x"], data["slope_y"] = slopes
    data["depth"] = depth
    data["look"] = 5
    return Splats.of(data)


def words_of(splats, limits, **options):
    splats = dataclasses.replace(splats, depth_range=limits)
    found = encode(splats, view_of(), PLANE, **options)
    words, lines = found.together()
    return pw.integers_of(words), lines.tolist()


def pixels_of(words, lines):
    """Return depth by (line, column) of words, inside the image."""
    found = {}
    for word, y in zip(words, lines, strict=True):
        x = bits(word, 47, 9)
        for row in range(8):
            for column in range(8):
                place = y - 4 + row, x + column
                inside = 0 <= place[0] < HEIGHT and place[1] < WIDTH
                if inside and pw.covers(word, row, column):
                    assert place not in found
                    found[place] = pw.depth_at(word, row, column)
    return found


def ellipse(column, line, diameter, slopes):
    """Return the pixels of a splat by its rows, inside the image and outside."""
    a, b = (column - WIDTH / 2) / FOCAL, (line - HEIGHT / 2) / FOCAL
    form = conic(a, b, *slopes)
    found = set()
    for row in range(-40, 100):
        first, last, filled = row_ends(row, column, line, (diameter / 2) ** 2, form)
        if filled:
            found |= {(row, pixel) for pixel in range(first, last + 1)}
    return found


def random_splat(rng, diameter, inside=True):
    edge = 10 if inside else -5
    column, line = rng.uniform(edge, WIDTH - edge), rng.uniform(edge, HEIGHT - edge)
    slopes = np.float32(rng.normal(size=2) * 10 ** rng.uniform(-2, 1))
    values = np.float32([column, line, diameter])
    return tuple(map(float, values)), tuple(map(float, slopes))


def in_image(pixels):
    return {(row, column) for row, column in pixels if 0 <= row < HEIGHT and 0 <= column < WIDTH}


@pytest.mark.parametrize("seed", range(3))
def test_what_fits_a_block_is_one_word_with_nearly_its_own_pixels(seed):
    rng = np.random.default_rng(seed)
    wrong = total = 0
    for _ in range(150):
        (column, line, diameter), slopes = random_splat(rng, rng.uniform(0.3, 7.9))
        # Far away, so that the perspective of the disc itself changes no pixel.
        splats = one_splat(column, line, diameter, slopes)
        words, lines = words_of(splats, (0.5, 1.5))
        true = ellipse(column, line, diameter, slopes)
        if not true:
            assert not words
            continue
        rows = {row for row, _ in true}
        columns = {column for _, column in true}
        fits = max(rows) - min(rows) < 8 and max(columns) - min(columns) < 8
        assert fits
        assert len(words) == 1
        found = set(pixels_of(words, lines))
        if max(rows) - min(rows) < 4:
            assert found == true
        upper = {place for place in true if place[0] < lines[0]}
        assert upper <= found
        wrong += len(found ^ true)
        total += len(true)
    assert wrong <= 0.01 * total


@pytest.mark.parametrize("seed", range(3))
def test_every_pixel_has_the_depth_of_the_disc_s_plane(seed):
    rng = np.random.default_rng(10 + seed)
    steps = []
    for _ in range(200):
        (column, line, diameter), slopes = random_splat(rng, rng.uniform(0.5, 14.0))
        span = 10 ** rng.uniform(-1.5, 0.5)
        limits = 1.0 - span * 0.5, 1.0 + span * 0.5
        words, lines = words_of(one_splat(column, line, diameter, slopes), limits)
        for word, y in zip(words, lines, strict=True):
            step = (1, 2, 4, 16)[bits(word, 81, 2)] / 4
            steps.append(step)
            pixels = pixels_of([word], [y])
            # The plane is exact at the disc's centre, or at the middle of a fraction's pixels.
            middle = np.mean([*pixels], axis=0) + 0.5 if len(words) > 1 else (line, column)
            for (row, pixel), z in pixels.items():
                away = abs(row + 0.5 - middle[0]) + abs(pixel + 0.5 - middle[1])
                du, dv = pixel + 0.5 - column, row + 0.5 - line
                # Slopes are rounded to half a step each, and where the perspective of a steep disc
                # bends its depth the tangent lies below it.
                g = (slopes[0] * du + slopes[1] * dv) / FOCAL
                true = (1.0 / (1.0 + g) - limits[0]) / span * 4094
                edge = 0.75 + 0.5 * step * away
                bent = 4094 / span * 4 * g * g
                steepest = 4094 / span / FOCAL * max(map(abs, slopes))
                corner = 7 * steepest * 2
                if steepest < 240 and corner < true < 4094 - corner:
                    assert abs(z - true) <= edge + bent + 1e-6
                assert 0 <= z <= 4094
    assert {0.25, 0.5, 1.0, 4.0} <= set(steps)


def test_large_splats_and_splats_at_the_border_have_their_own_pixels():
    rng = np.random.default_rng(4)
    for _ in range(150):
        (column, line, diameter), slopes = random_splat(rng, rng.uniform(1.0, 30.0), inside=False)
        if (diameter / 2) ** 2 > 0.02 * FOCAL:  # drawn in true perspective
            continue
        words, lines = words_of(one_splat(column, line, diameter, slopes), (0.5, 1.5))
        true = in_image(ellipse(column, line, diameter, slopes))
        found = set(pixels_of(words, lines))
        symmetric = any(bits(word, 0, 1) == 0 for word in words)
        assert len(found ^ true) <= (2 if symmetric else 0)


def test_a_frame_without_a_depth_range_is_flat():
    words, _ = words_of(one_splat(20.0, 20.0, 6.0, (0.5, 0.2)), (1.0, 1.0))
    assert [bits(word, 67, 14) for word in words] == [0]
    words, _ = words_of(one_splat(20.0, 20.0, 60.0, (1e6, -1e6), depth=0.011), (0.0, 1e-300))
    assert all(0 <= pw.depth_at(word, row, 0) <= 4095 for word in words for row in range(8))


@pytest.fixture(scope="module")
def cloud():
    return sphere(3000)


def frame_of(cloud, size=(96, 80), radius=0.06, **options):
    options = {"config": PLANE, **options}
    return make_frame(
        cloud, fit_view(cloud, size=size), radii=np.full(len(cloud), radius), **options
    )


def test_a_frame_is_drawn_by_the_contract(cloud):
    frame = frame_of(cloud, size=(40, 36))
    expected = pw.draw(frame)
    found = golden.render(frame)
    assert np.array_equal(found.depth, expected.depth)
    assert np.array_equal(found.colour, expected.colour)
    assert found.drawn.mean() > 0.5


def two_spheres(count=40000):
    """Return an even sphere inside another, whose points face both ways."""
    number = np.arange(count) + 0.5
    z, turn = 1.0 - 2.0 * number / count, np.pi * (1.0 + 5.0**0.5) * number
    radius = np.sqrt(1.0 - z * z)
    outer = np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=1)
    return cloud_of(np.concatenate([outer, 0.8 * outer]), np.tile(outer, (2, 1)), two_sided=True)


@pytest.mark.parametrize("radius", [0.012, 0.018])
def test_hidden_splats_change_no_depth(radius):
    # Words of equal depth may come in another order, so colours may change there.
    both = two_spheres()
    plain = frame_of(both, size=(400, 400), radius=radius)
    skips = {*plain.counts["skips"], "hidden"}
    hidden = frame_of(both, size=(400, 400), radius=radius, skips=skips)
    assert hidden.counts["culled"]["hidden"] > 5000
    assert np.array_equal(golden.render(plain).depth, golden.render(hidden).depth)


def test_fast_and_exact_are_one_and_paper_is_refused(cloud):
    exact, fast = (frame_of(cloud, quality=quality) for quality in ("exact", "fast"))
    assert np.array_equal(exact.codewords, fast.codewords)
    with pytest.raises(InputError, match="draws every splat exactly"):
        frame_of(cloud, quality="paper")


def test_each_line_s_words_come_from_groups_of_columns_in_turn(cloud):
    frame = frame_of(cloud)
    lines, here = [], []
    for word in pw.integers_of(frame.codewords):
        if pw.is_control(word):
            lines.append(here)
            here = []
        else:
            here.append(bits(word, 47, 9))
    assert max(map(len, lines)) > 20
    for found in lines:
        odd = [column // 8 % 2 for column in found]
        assert odd == sorted(odd)
        for group in {column // 8 for column in found}:
            columns = [column for column in found if column // 8 == group]
            assert columns == sorted(columns)
    assert frame.counts["bits_sent"] == {"table": 96 * len(frame.codewords)}


def test_a_cell_of_the_pyramid_hides_nothing_that_is_seen():
    rng = np.random.default_rng(8)
    size = 32, 24
    tight = 0
    for _ in range(10):
        # A word for every cell, which it covers, and others at random.
        words = [
            pw.encode(
                [(0, 7)] * 4, x=8 * (cell % 4), z=int(rng.integers(8192)),
                scale=int(rng.integers(4)),
                a=int(rng.integers(-64, 64)), b=int(rng.integers(-64, 64)),
            )
            for cell in range(24)
        ]  # fmt: skip
        at = [4 * (cell // 4) + 4 for cell in range(24)]
        while len(words) < 60:
            word = pw.random_word(rng, size)
            if not pw.is_control(word) and bits(word, 47, 9) < 32:  # as a host's
                words.append(word)
                at.append(int(rng.integers(0, 24)))
        order = np.argsort(at, kind="stable")
        words, lines = [words[i] for i in order], np.array(at, np.int16)[order]
        codewords = pw.array_of(words)
        pyramid = new_pyramid(*size, PLANE)
        chunk = np.array([0]), np.array([len(words)])
        cover_planes(pyramid, codewords, lines, *chunk, PLANE)
        stream, y = [], 0
        for word, line in zip(words, lines.tolist(), strict=True):
            if line > y:
                stream.append(pw.advance(line - y))
            stream.append(word)
            y = line
        depth = golden.render(pw.make_frame(stream, size)).depth
        largest = depth.reshape(6, 4, 4, 8).max(axis=(1, 3))
        assert (pyramid.bound >= largest).all()
        tight += np.count_nonzero(pyramid.bound < 4095)
    assert tight > 50


@pytest.mark.parametrize("method", ["columns", "elements", "lines"])
def test_a_chain_s_parts_draw_the_same_depth(cloud, method):
    frame = frame_of(cloud)
    # The bits of control words that mean nothing may be anything.
    control = (frame.codewords[:, 1] == 0).nonzero()[0]
    frame.codewords[control[:-1]] |= np.array([1 << 63, 0xFFFFFFFF], np.uint64)
    parts = partition(frame, 3, method)
    assert sum(part.counts["elements"] for part in parts) == len(frame.codewords) - len(control)
    whole = golden.render(frame)
    assert np.array_equal(golden.render_parts(parts).depth, whole.depth)


def test_a_frame_of_plane_words_goes_to_disk_and_back(cloud, tmp_path):
    frame = frame_of(cloud)
    path = tmp_path / "a.frame"
    save_frame(frame, path)
    assert path.stat().st_size == 16 * len(frame.codewords)
    assert np.array_equal(np.fromfile(path, "<u8").reshape(-1, 2), frame.codewords)
    back = load_frame(path)
    assert np.array_equal(back.codewords, frame.codewords)
    assert back.config == PLANE
    facts = describe_frame(back)
    kinds = ("control_words", "symmetric_words", "fraction_words")
    assert sum(facts[kind] for kind in kinds) == len(frame.codewords)
    assert facts["symmetric_words"] > 0
    assert 0 <= facts["z_range"][0] < facts["z_range"][1] <= 8191
    path.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(InputError, match="not whole 128-bit words"):
        load_frame(path)
    path.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(InputError, match="does not end with an end-of-frame word"):
        load_frame(path)


def test_a_sorted_stream_holds_every_word_once(cloud):
    frame = frame_of(cloud)
    view = fit_view(cloud, size=(96, 80))
    assert isinstance(frame, Frame)
    splats = one_splat(20.0, 20.0, 6.0, (0.5, 0.2))
    encoded = encode(dataclasses.replace(splats, depth_range=(0.5, 1.5)), view, PLANE)
    stream, controls = sort_by_line(encoded, PLANE)
    assert (controls, stream.shape) == (2, (3, 2))
    assert np.array_equal(stream[1], encoded.together()[0][0])
