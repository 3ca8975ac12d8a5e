"""The canvas shows the pictures that the server sends, pixel for pixel, and acknowledges them."""

import io

import numpy as np
from PIL import Image

from .scripted_server import SETTINGS, noise, start, until


def size_asked(server):
    """Return width and height that the page asked for."""
    asked = server.of_type("resize")[-1]
    return asked["width"], asked["height"]


def png(pixels):
    """Return the bytes of a picture as a PNG."""
    data = io.BytesIO()
    Image.fromarray(pixels[..., :3]).save(data, "png")
    return data.getvalue()


def test_a_picture_is_shown_pixel_for_pixel(serve, open_page):
    server, page = start(serve, open_page)
    width, height = size_asked(server)
    assert (width, height) == page.canvas_size() == (952, 800)
    sent = noise(width, height)
    server.picture(1, sent)
    page.stage(frame=1, refined="true")
    np.testing.assert_array_equal(page.pixels(), sent)


def test_a_png_is_shown_pixel_for_pixel(serve, open_page):
    server, page = start(serve, open_page)
    sent = noise(*size_asked(server), seed=1)
    server.picture(1, sent, png=png(sent))
    page.stage(frame=1)
    np.testing.assert_array_equal(page.pixels(), sent)


def test_a_coarse_picture_is_scaled_to_the_whole_canvas(serve, open_page):
    server, page = start(serve, open_page)
    width, height = size_asked(server)
    coarse = np.full((height // 4, width // 4, 4), 255, np.uint8)
    coarse[: height // 8, : width // 8, :3] = 0  # the corner at the upper left
    server.picture(1, coarse, refined=False)
    page.stage(frame=1, refined="false")
    shown = page.pixels()
    assert (shown[:390, :466, :3] == 0).all()
    assert (shown[410:, :] == 255).all() and (shown[:, 486:] == 255).all()


def test_a_frame_older_than_the_last_one_is_dropped(serve, open_page):
    server, page = start(serve, open_page)
    size = size_asked(server)
    newer, older = noise(*size, seed=2), noise(*size, seed=3)
    server.picture(5, newer)
    server.picture(4, older)
    until(page.page, lambda: len(server.of_type("shown")) == 2)
    np.testing.assert_array_equal(page.pixels(), newer)


def test_a_png_that_is_overtaken_is_dropped(serve, open_page):
    server, page = start(serve, open_page)
    slow = noise(*size_asked(server), seed=4)
    server.picture(1, slow, png=png(slow))
    server.picture(2, np.full((16, 16, 4), 255, np.uint8))  # drawn while the other is decoded
    until(page.page, lambda: len(server.of_type("shown")) == 2)
    assert [message["frame"] for message in server.of_type("shown")] == [2, 1]
    assert (page.pixels() == 255).all()


def test_every_frame_is_acknowledged_once(serve, open_page):
    server, page = start(serve, open_page)
    size = size_asked(server)
    for frame in (1, 2, 3):
        server.picture(frame, noise(*size, seed=frame))
    until(page.page, lambda: len(server.of_type("shown")) >= 3)
    page.page.wait_for_timeout(50)
    assert [message["frame"] for message in server.of_type("shown")] == [1, 2, 3]


def test_a_damaged_picture_is_one_line_and_is_acknowledged(serve, open_page):
    server, page = start(serve, open_page)
    size = size_asked(server)
    server.picture(1, noise(*size), png=b"no PNG")
    until(page.page, lambda: server.of_type("shown"))
    page.page.wait_for_selector("#toast:not([hidden])")
    assert page.text("#toast-text") == "Frame 1 could not be drawn."


def test_a_message_of_another_protocol_is_one_line(serve, open_page):
    server, page = start(serve, open_page)
    for data in (b"", b"short", bytes(32), b"0PSL" + bytes(40)):
        server.raw(data)
        page.page.wait_for_selector("#toast:not([hidden])")
        assert page.text("#toast-text") == "This page does not fit its server. Load it again."
        page.page.click("#toast-close")


def test_the_second_picture_of_a_split_begins_at_the_seam(serve, open_page):
    server, page = start(serve, open_page)
    width, height = size_asked(server)
    left, right = noise(width, height, seed=6), noise(width, height, seed=7)
    server.say({**SETTINGS, "split": {"left": "paper", "right": "reference"}})
    server.picture(1, left)
    server.picture(1, right, kind=2)
    page.stage(frame=1, kind=2)
    middle = width // 2
    expected = np.concatenate([left[:, :middle], right[:, middle:]], axis=1)
    np.testing.assert_array_equal(page.pixels(), expected)
    assert page.page.locator(".seam-side").all_inner_texts() == [
        "Paper's engine",
        "Exact reference",
    ]

    page.drag((middle, 400), (238, 500))  # the seam follows the hand
    np.testing.assert_array_equal(page.pixels()[:, 238:], right[:, 238:])
    np.testing.assert_array_equal(page.pixels()[:, :238], left[:, :238])
    page.page.keyboard.press("End")
    np.testing.assert_array_equal(page.pixels(), left)
    assert server.of_type("turn") == []

    server.picture(2, left)  # a moving picture has no second one
    page.stage(frame=2)
    page.page.keyboard.press("Home")
    np.testing.assert_array_equal(page.pixels(), left)


def test_another_size_of_the_window_is_another_size_of_the_picture(serve, open_page):
    server, page = start(serve, open_page)
    server.picture(1, noise(*size_asked(server)))
    page.stage(frame=1)
    page.page.set_viewport_size({"width": 1000, "height": 600})
    until(page.page, lambda: size_asked(server) == (672, 600))
    assert page.canvas_size() == (672, 600)
    assert page.pixels()[..., 3].min() == 255  # the old picture stands until there is a new one
