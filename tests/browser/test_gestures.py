"""What the hand does on the canvas becomes messages of the protocol."""

import pytest

from .conftest import NARROW, WIDE
from .scripted_server import HELLO, SETTINGS, start, until

MIDDLE = (476, 400)
MOVES = ("turn", "pan", "zoom", "look", "orbit", "reset", "set", "save")

NOTE_FINGERS = """() => {
    window.fingers = [];
    document.querySelector("canvas").addEventListener(
        "pointerdown", (event) => fingers.push(event.pointerId), true);
}"""
LIFT = """() => {
    const values = {pointerId: fingers[1], clientX: 270, clientY: 300, bubbles: true};
    document.querySelector("canvas").dispatchEvent(new PointerEvent("pointerup", values));
}"""


def total(messages, *names):
    """Return the sums of some values over messages."""
    return tuple(sum(message[name] for message in messages) for name in names)


@pytest.mark.parametrize(
    ("button", "key", "kind"),
    [
        ("left", None, "turn"),
        ("left", "Shift", "pan"),
        ("right", None, "pan"),
        ("middle", None, "pan"),
    ],
)
def test_a_drag_turns_or_pans_by_its_length(serve, open_page, button, key, kind):
    server, page = start(serve, open_page)
    if key:
        page.page.keyboard.down(key)
    page.drag(MIDDLE, (536, 370), button=button)
    if key:
        page.page.keyboard.up(key)
    until(page.page, lambda: server.of_type("moving")[-1:] == [{"type": "moving", "value": False}])
    moved = server.of_type(*MOVES)
    assert {message["type"] for message in moved} == {kind}
    assert total(moved, "dx", "dy") == (60, -30)
    kinds = [message["type"] for message in server.of_type("moving", kind)]
    assert kinds[0] == kinds[-1] == "moving" and kinds.count("moving") == 2
    assert server.of_type("moving")[0]["value"] is True


def test_a_drag_is_told_in_pixels_of_the_picture(serve, open_page):
    server, page = start(serve, open_page, {**WIDE, "device_scale_factor": 2})
    assert server.of_type("resize")[-1] == {"type": "resize", "width": 1904, "height": 1600}
    page.drag(MIDDLE, (486, 405))
    until(page.page, lambda: server.of_type("moving")[1:])
    assert total(server.of_type("turn"), "dx", "dy") == (20, 10)


def test_a_drag_that_leaves_the_window_ends_when_the_button_is_released(serve, open_page):
    server, page = start(serve, open_page)
    page.drag(MIDDLE, (1270, 10))
    until(page.page, lambda: server.of_type("moving")[1:])
    assert total(server.of_type("turn"), "dx", "dy") == (794, -390)
    page.page.mouse.move(600, 300)
    page.page.wait_for_timeout(50)
    assert total(server.of_type("turn"), "dx", "dy") == (794, -390)


def test_the_wheel_zooms_about_the_cursor(serve, open_page):
    server, page = start(serve, open_page)
    page.page.mouse.move(200, 300)
    page.page.mouse.wheel(0, -100)
    nearer = until(page.page, lambda: server.of_type("zoom"))[0]
    assert nearer["factor"] == pytest.approx(0.8607, abs=1e-4)  # e^-0.15
    assert (nearer["x"], nearer["y"]) == (200, 300)
    page.page.mouse.wheel(0, 100)
    farther = until(page.page, lambda: server.of_type("zoom")[1:])[0]
    assert farther["factor"] == pytest.approx(1 / nearer["factor"])
    until(page.page, lambda: server.of_type("moving")[-1]["value"] is False)
    told = [message["value"] for message in server.of_type("moving")]
    assert told == [True, False] * (len(told) // 2)  # more than one pair if the machine is slow


def test_a_double_click_looks_at_a_point(serve, open_page):
    server, page = start(serve, open_page)
    page.page.mouse.dblclick(321, 123)
    assert until(page.page, lambda: server.of_type("look")) == [
        {"type": "look", "x": 321, "y": 123}
    ]
    page.page.mouse.click(100, 100)
    page.page.wait_for_timeout(500)
    page.page.mouse.click(100, 100)
    page.page.mouse.click(300, 300)
    page.page.wait_for_timeout(50)
    assert len(server.of_type(*MOVES)) == 1
    assert server.of_type("moving") == []


def test_keys(serve, open_page):
    server, page = start(serve, open_page)
    expected = {
        "r": {"type": "reset"},
        "1": {"type": "orbit", "azimuth": 0, "elevation": 0},
        "2": {"type": "orbit", "azimuth": 180, "elevation": 0},
        "3": {"type": "orbit", "azimuth": -90, "elevation": 0},
        "4": {"type": "orbit", "azimuth": 90, "elevation": 0},
        "5": {"type": "orbit", "azimuth": 0, "elevation": 90},
        "6": {"type": "orbit", "azimuth": 0, "elevation": -90},
        "7": {"type": "orbit", "azimuth": 45, "elevation": 35.264},
        "8": {"type": "orbit", "azimuth": -45, "elevation": 35.264},
        "9": {"type": "orbit", "azimuth": 135, "elevation": 35.264},
        "d": {"type": "set", "name": "show", "value": "depth"},
        "s": {"type": "save", "what": "png"},
    }
    for key in [*expected, "x", "0"]:
        page.page.keyboard.press(key)
    until(page.page, lambda: len(server.of_type(*MOVES)) >= len(expected))
    assert server.of_type(*MOVES) == list(expected.values())


def test_arrow_keys_turn_and_pan_and_signs_zoom(serve, open_page):
    server, page = start(serve, open_page)
    for key in ("ArrowLeft", "ArrowDown", "Shift+ArrowUp", "+", "-"):
        page.page.keyboard.press(key)
        page.page.wait_for_timeout(30)
    until(page.page, lambda: len(server.of_type("zoom")) == 2)
    assert total(server.of_type("turn"), "dx", "dy") == (-24, 24)
    assert total(server.of_type("pan"), "dx", "dy") == (0, -24)
    assert [message["factor"] for message in server.of_type("zoom")] == [0.8, 1.25]
    assert (server.of_type("zoom")[0]["x"], server.of_type("zoom")[0]["y"]) == MIDDLE


def test_keys_belong_to_the_control_that_has_the_focus(serve, open_page):
    server = serve(greeting=(HELLO, {**SETTINGS, "preset": "paper"}))
    page = open_page(server.address)
    until(page.page, lambda: server.of_type("resize"))
    page.page.focus("#preset")
    page.page.keyboard.press("r")  # chooses `rgb24`, and does not reset the view
    page.page.focus("#samples input")
    page.page.keyboard.press("ArrowRight")
    until(page.page, lambda: len(server.of_type("set")) == 2)
    asked = [(message["name"], message["value"]) for message in server.of_type(*MOVES)]
    assert asked == [("preset", "rgb24"), ("samples", 4)]


def test_help_opens_by_key_and_closes(serve, open_page, screenshot):
    _, page = start(serve, open_page)
    page.page.keyboard.press("?")
    page.page.wait_for_selector("#help[open]")
    screenshot(page, "help")
    page.page.keyboard.press("Escape")
    page.page.wait_for_selector("#help:not([open])", state="attached")
    page.page.click("#help-open")
    page.page.click("#help button")
    page.page.wait_for_selector("#help:not([open])", state="attached")


def test_a_finger_turns(serve, open_page):
    server, page = start(serve, open_page, NARROW)
    page.touch("touchStart", (100, 200))
    for x in range(110, 151, 10):
        page.touch("touchMove", (x, 210))
    page.touch("touchEnd")
    until(page.page, lambda: server.of_type("moving")[1:])
    assert {message["type"] for message in server.of_type(*MOVES)} == {"turn"}
    # The first pixels tell a touch from a drag, and Chromium keeps some of them to itself.
    dx, dy = total(server.of_type("turn"), "dx", "dy")
    assert 60 <= dx <= 100 and 0 <= dy <= 20


def test_two_fingers_pan_and_pinch(serve, open_page):
    server, page = start(serve, open_page, NARROW)
    page.touch("touchStart", (150, 300), (250, 300))
    for step in range(1, 11):  # the middle goes down by 50, and the distance doubles
        page.touch("touchMove", (150 - 5 * step, 300 + 5 * step), (250 + 5 * step, 300 + 5 * step))
    page.touch("touchEnd")
    until(page.page, lambda: server.of_type("moving")[1:])
    assert {message["type"] for message in server.of_type(*MOVES)} == {"pan", "zoom"}
    dx, dy = total(server.of_type("pan"), "dx", "dy")
    assert abs(dx) <= 15 and 70 <= dy <= 100
    factor = 1.0
    for message in server.of_type("zoom"):
        factor *= message["factor"]
        assert abs(message["x"] - 400) <= 20 and 600 <= message["y"] <= 700
    assert 0.45 <= factor <= 0.6


def test_the_finger_that_stays_after_a_pinch_does_nothing(serve, open_page):
    server, page = start(serve, open_page, NARROW)
    page.page.evaluate(NOTE_FINGERS)
    page.touch("touchStart", (150, 300), (250, 300))
    page.touch("touchMove", (140, 300), (260, 300))
    page.touch("touchMove", (130, 300), (270, 300))
    # DevTools lifts all fingers at once only, so the page tells itself that one was lifted.
    page.page.evaluate(LIFT)
    for x in range(130, 60, -10):
        page.touch("touchMove", (x, 300), (270, 300))
    page.touch("touchEnd")
    until(page.page, lambda: server.of_type("moving")[1:])
    assert server.of_type("turn", "look") == []


def test_a_double_tap_looks_at_a_point(serve, open_page):
    server, page = start(serve, open_page, NARROW)
    for _ in range(2):
        page.touch("touchStart", (120, 220))
        page.touch("touchEnd")
    assert until(page.page, lambda: server.of_type("look")) == [
        {"type": "look", "x": 240, "y": 440}
    ]
