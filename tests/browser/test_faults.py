"""Faults planted in the page: each is found by the test that guards against it."""

import functools

import pytest

from splatline.view.server.pages import page_files

from . import (
    scripted_server,
    test_accessible,
    test_canvas,
    test_gestures,
    test_reconnection,
    test_states,
)

# Name of the fault: file, text, other text, and the test that must fail (with its parameters).
FAULTS = {
    "a stale frame is drawn": (
        "picture.js",
        "first ? header.frame <= this.last :",
        "first ? false :",
        test_canvas.test_a_frame_older_than_the_last_one_is_dropped,
    ),
    "an overtaken PNG is drawn": (
        "picture.js",
        "if (header.frame !== this.last) return false; // a newer",
        "// a newer",
        test_canvas.test_a_png_that_is_overtaken_is_dropped,
    ),
    "width and height are swapped in what is asked for": (
        "canvas.js",
        "width: canvas.width, height: canvas.height",
        "width: canvas.height, height: canvas.width",
        test_canvas.test_a_picture_is_shown_pixel_for_pixel,
    ),
    "width and height are swapped in a header": (
        "socket.js",
        "width: word(3), height: word(4)",
        "width: word(4), height: word(3)",
        test_canvas.test_a_picture_is_shown_pixel_for_pixel,
    ),
    "a header is read as big-endian": (
        "socket.js",
        "getUint32(4 * index, true)",
        "getUint32(4 * index)",
        test_canvas.test_a_picture_is_shown_pixel_for_pixel,
    ),
    "no frame is acknowledged": (
        "canvas.js",
        ".finally(acknowledge)",
        "",
        test_canvas.test_every_frame_is_acknowledged_once,
    ),
    "a dropped frame is not acknowledged": (
        "canvas.js",
        ".finally(acknowledge)",
        ".then((drawn) => { if (drawn) acknowledge(); return drawn; })",
        test_canvas.test_a_frame_older_than_the_last_one_is_dropped,
    ),
    "the seam shows the pictures on each other's side": (
        "picture.js",
        "this.context.rect(from, 0, width - from, height)",
        "this.context.rect(0, 0, from, height)",
        test_canvas.test_the_second_picture_of_a_split_begins_at_the_seam,
    ),
    "the second picture of an old frame stays": (
        "picture.js",
        "second.frame !== first.frame || ",
        "",
        test_canvas.test_the_second_picture_of_a_split_begins_at_the_seam,
    ),
    "the density of the display is forgotten in a drag": (
        "gestures.js",
        "dx * scale, dy * scale",
        "dx, dy",
        test_gestures.test_a_drag_is_told_in_pixels_of_the_picture,
    ),
    "the first pixels of a drag are lost": (
        "gestures.js",
        "if (this.travel <= SLACK) return;",
        "if (this.travel <= SLACK) return void this.pointers.set(event.pointerId, now);",
        test_gestures.test_a_drag_is_told_in_pixels_of_the_picture,
    ),
    "the right button turns": (
        "gestures.js",
        "event.shiftKey || event.button > 0",
        "event.shiftKey",
        test_gestures.test_a_drag_turns_or_pans_by_its_length,
        {"button": "right", "key": None, "kind": "pan"},
    ),
    "the wheel zooms the wrong way": (
        "gestures.js",
        "Math.exp(pixels * rate)",
        "Math.exp(-pixels * rate)",
        test_gestures.test_the_wheel_zooms_about_the_cursor,
    ),
    "the end of a drag is not told": (
        "gestures.js",
        "if (this.moving) this.#endMotion();",
        "",
        test_gestures.test_a_drag_that_leaves_the_window_ends_when_the_button_is_released,
    ),
    "a pinch zooms the wrong way": (
        "gestures.js",
        "this.#zoom(ratio,",
        "this.#zoom(1 / ratio,",
        test_gestures.test_two_fingers_pan_and_pinch,
    ),
    "the finger that stays turns": (
        "gestures.js",
        'this.mode = "none";',
        "",
        test_gestures.test_the_finger_that_stays_after_a_pinch_does_nothing,
    ),
    "keys are taken from a field": (
        "canvas.js",
        " || isTyping(event.target)",
        "",
        test_gestures.test_keys_belong_to_the_control_that_has_the_focus,
    ),
    "left and right of the keys are swapped": (
        "canvas.js",
        '["Left", -90, 0]',
        '["Left", 90, 0]',
        test_gestures.test_keys,
    ),
    "frames are not counted anew after a restart": (
        "main.js",
        "canvas.restart();",
        "",
        test_reconnection.test_the_page_connects_again_and_restores_its_settings,
    ),
    "the settings are not restored": (
        "main.js",
        "if (before && same) restore(before);",
        "",
        test_reconnection.test_the_page_connects_again_and_restores_its_settings,
    ),
    "the settings of one cloud are given to another": (
        "main.js",
        "if (before && same)",
        "if (before)",
        test_reconnection.test_another_cloud_begins_with_its_own_settings,
    ),
    "the page connects again at once, and again": (
        "socket.js",
        "setTimeout(connect, wait)",
        "setTimeout(connect, 50)",
        test_reconnection.test_attempts_become_rarer,
    ),
    "older settings undo what was asked for": (
        "panel.js",
        "else settings[name] = value;",
        "",
        test_states.test_settings_on_their_way_do_not_undo_what_was_asked_for,
    ),
    "the controls fall back when colours are offered anew": (
        "panel.js",
        "      if (last) show(last);\n    },\n    show,",
        "    },\n    show,",
        test_states.test_controls_show_what_holds_when_colours_are_offered_anew,
    ),
    "a message is taken for HTML": (
        "overlay.js",
        'byId("toast-text").textContent',
        'byId("toast-text").innerHTML',
        test_states.test_a_later_error_is_a_line_that_can_be_closed,
    ),
    "an empty picture is not explained": (
        "main.js",
        "if (message.elements === 0) showEmpty();",
        "if (message.elements === null) showEmpty();",
        test_states.test_nothing_in_view_is_said_until_something_is,
    ),
    "soft text is too dark": (
        "view.css",
        "--soft: #9aa6b2;",
        "--soft: #6b7580;",
        test_accessible.test_text_stands_out_from_its_ground,
    ),
    "the focus is not marked": (
        "view.css",
        ":focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }",
        ":focus-visible { outline: none; }",
        test_accessible.test_tab_reaches_every_control_and_shows_where_it_is,
    ),
    "a long command widens the page": (
        "view.css",
        'font: 12px/1.5 ui-monospace, "DejaVu Sans Mono", monospace; overflow-wrap: anywhere;',
        "font: 12px/1.5 monospace; white-space: nowrap;",
        test_states.test_nothing_reaches_out_of_the_window,
        {"width": 390},
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found(fault, serve, open_page, monkeypatch):
    from playwright.sync_api import Error

    file, text, other, check, *parameters = FAULTS[fault]
    assert page_files()[file].data.decode().count(text) == 1
    monkeypatch.setattr(scripted_server, "PATIENCE", 1.5)
    pages = []

    def open_impatiently(*args, **options):
        page = open_page(*args, **options)
        page.impatient(1500)
        pages.append(page)
        return page

    arguments = {"serve": functools.partial(serve, changed={file: (text, other)})}
    arguments |= {"open_page": open_impatiently, **(parameters[0] if parameters else {})}
    if "screenshot" in check.__code__.co_varnames[: check.__code__.co_argcount]:
        arguments["screenshot"] = lambda page, name: None
    with pytest.raises((AssertionError, Error)):
        check(**arguments)
        assert [line for page in pages for line in page.errors] == []
    for page in pages:
        page.errors.clear()
