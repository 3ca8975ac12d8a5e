"""What the page says while it loads, when something fails, and in a narrow window."""

import pytest

from .conftest import NARROW, WIDE
from .scripted_server import HELLO, NUMBERS, SETTINGS, noise, start, until

NO_VALUE = "\N{EN DASH}"


def visible(page, selector):
    return page.page.is_visible(selector)


def test_loading_shows_its_progress_and_nothing_to_touch(serve, open_page, screenshot):
    server = serve(greeting=())
    page = open_page(server.address)
    until(page.page, lambda: server.connections)
    server.say({"type": "progress", "text": "Reading scan.laz", "share": 0.4})
    page.page.wait_for_selector("#centre[data-state='loading']")
    page.page.wait_for_timeout(500)  # it appears gently
    assert page.text("#centre-text") == "Reading scan.laz"
    assert page.text("#centre-share") == "40 %"
    assert page.page.evaluate("document.querySelector('#progress').value") == 0.4
    assert not any(visible(page, part) for part in (".tools", "#settings", ".saves"))
    screenshot(page, "loading")
    server.say({"type": "progress", "text": "Indexing", "share": None})
    page.page.wait_for_selector("#progress:indeterminate")
    server.say({"type": "progress", "text": "", "share": 1})
    server.say(HELLO)
    page.page.wait_for_selector("#centre", state="hidden")
    assert visible(page, "#settings")


def test_an_error_before_there_is_a_cloud_stays_in_the_middle(serve, open_page):
    server = serve(greeting=({"type": "error", "text": "bad.ply: no points"},))
    page = open_page(server.address)
    page.page.wait_for_selector("#centre[data-state='error']")
    assert page.text("#centre") == "bad.ply: no points"


def test_a_later_error_is_a_line_that_can_be_closed(serve, open_page):
    server, page = start(serve, open_page)
    server.say({"type": "progress", "text": "Reading", "share": 0.5})
    server.say({"type": "error", "text": "no field <b>x</b>"})
    page.page.wait_for_selector("#toast:not([hidden])")
    assert page.text("#toast-text") == "no field <b>x</b>"
    assert not visible(page, "#centre")
    page.page.click("#toast-close")
    page.page.wait_for_selector("#toast", state="hidden")


def test_figures_in_hardware(serve, open_page):
    server, page = start(serve, open_page)
    server.say(NUMBERS)
    page.page.wait_for_selector("#fps:text('441')")
    pairs = page.page.locator("#figures > div").all_inner_texts()
    assert [pair.split("\n") for pair in pairs] == [
        ["Code words", "155,730"],
        ["Cycles", "311,460"],
        ["Per element", "1.71"],
        ["Elements", "150,000"],
        ["LUTs", "1,801"],
        ["Block RAMs", "9"],
        ["Flip-flops", "902"],
        ["Multipliers", "4"],
        ["Drawn here in", "12 ms"],
    ]
    assert page.text("#clock") == "rgb24 at 137 MHz on LFE5U-25F"
    assert page.text("#left-out-total") == "1,234 of 151,234 points left out"
    page.page.click("#left-out summary")
    assert page.text("#left-out-list").split("\n") == [
        "outside the picture",
        "1,000",
        "between pixel centres",
        "234",
    ]
    assert page.text("#notes") == "normals were estimated"
    server.say(
        {**NUMBERS, "fps": None, "clock_mhz": None, "cycles_per_element": None, "psnr": 38.25}
    )
    page.page.wait_for_selector("#clock:text('rgb24 has no routed clock')")
    assert page.text("#fps") == NO_VALUE
    assert (
        page.page.locator("#figures > div").first.inner_text() == "PSNR to the reference\n38.3 dB"
    )


def test_nothing_in_view_is_said_until_something_is(serve, open_page):
    server, page = start(serve, open_page)
    server.say({**NUMBERS, "elements": 0, "left_out": {}, "cycles_per_element": None})
    page.page.wait_for_selector("#centre[data-state='empty']")
    assert page.text("#fps") == NO_VALUE
    page.page.click("#centre-reset")
    until(page.page, lambda: server.of_type("reset"))
    server.say(NUMBERS)
    page.page.wait_for_selector("#centre", state="hidden")


@pytest.mark.parametrize(
    ("act", "name", "value"),
    [
        (lambda page: page.select_option("#preset", "paper"), "preset", "paper"),
        (lambda page: page.select_option("#quality", "fast"), "quality", "fast"),
        (lambda page: page.check("#samples [value='16']", force=True), "samples", 16),
        (lambda page: page.select_option("#lights", "front"), "lights", "front"),
        (lambda page: page.fill("#background", "#abcdef"), "background", "#abcdef"),
        (
            lambda page: page.select_option("#colour-by", "height"),
            "colour",
            {"by": "height", "map": None, "range": None},
        ),
        (
            lambda page: page.check("#compare"),
            "split",
            {"left": "paper", "right": "reference"},
        ),
        (lambda page: page.click("#depth"), "show", "depth"),
    ],
)
def test_a_control_sets_its_setting(serve, open_page, act, name, value):
    server, page = start(serve, open_page)
    act(page.page)
    until(page.page, lambda: server.of_type("set"))
    assert server.of_type("set") == [{"type": "set", "name": name, "value": value}]


def test_map_and_range_belong_to_colours_by_a_field(serve, open_page):
    coloured = {**SETTINGS, "colour": {"by": "height", "map": "turbo", "range": [1.5, 9]}}
    server = serve(greeting=(HELLO, coloured))
    page = open_page(server.address)
    page.page.wait_for_selector("#range-row:not([hidden])")
    assert page.page.input_value("#colour-map") == "turbo"
    assert page.page.input_value("#range-from") == "1.5"
    page.page.fill("#range-to", "20")
    page.page.press("#range-to", "Enter")
    until(page.page, lambda: server.of_type("set"))
    value = {"by": "height", "map": "turbo", "range": [1.5, 20]}
    assert server.of_type("set")[-1]["value"] == value
    server.say({**coloured, "colour": value})
    server.say(SETTINGS)
    page.page.wait_for_selector("#range-row", state="hidden")


def test_settings_on_their_way_do_not_undo_what_was_asked_for(serve, open_page):
    server = serve()
    page = open_page(server.address)
    page.page.select_option("#quality", "fast")
    until(page.page, lambda: server.of_type("set"))
    server.say({**SETTINGS, "lights": "front"})  # sent before the server read the message
    until(page.page, lambda: page.page.input_value("#lights") == "front")
    assert page.page.input_value("#quality") == "fast"
    server.say({"type": "error", "text": "no such quality"})  # nor does it come
    page.page.wait_for_selector("#toast:not([hidden])")
    assert page.page.input_value("#quality") == "exact"


def test_what_is_asked_for_and_never_told_is_given_up(serve, open_page):
    server = serve()
    page = open_page(server.address)
    page.page.select_option("#quality", "fast")
    page.page.wait_for_timeout(3300)
    assert page.page.input_value("#quality") == "exact"


def test_controls_show_what_holds_when_colours_are_offered_anew(serve, open_page):
    server = serve(greeting=({**SETTINGS, "preset": "paper", "samples": 4}, HELLO))
    page = open_page(server.address)
    page.page.wait_for_selector('#preset-title:text("the paper\'s")')
    assert page.page.input_value("#preset") == "paper"
    assert page.page.is_checked("#samples [value='4']")


def test_a_file_is_saved_under_its_name(serve, open_page):
    server, page = start(serve, open_page)
    with page.page.expect_download() as waiting:
        page.page.click("#save-words")
        until(page.page, lambda: server.of_type("save"))
        server.file("scan-words.zip", "application/zip", b"zipped")
    assert server.of_type("save") == [{"type": "save", "what": "words"}]
    assert waiting.value.suggested_filename == "scan-words.zip"
    assert waiting.value.path().read_bytes() == b"zipped"


def test_a_command_is_shown_where_the_clipboard_is_kept_from_the_page(serve, open_page):
    server = serve()
    page = open_page(server.address)
    refuse = "() => { navigator.clipboard.writeText = () => Promise.reject(new Error('no')); }"
    page.page.evaluate(refuse)
    page.page.click("#copy")
    until(page.page, lambda: server.of_type("command"))
    server.say({"type": "command", "text": "splatline render 'a b.ply'"})
    page.page.wait_for_selector("#copy:text('Copy it above')")
    assert page.text("#command") == "splatline render 'a b.ply'"
    assert page.page.evaluate("getSelection().toString()") == "splatline render 'a b.ply'"


def test_a_narrow_window_has_a_sheet_and_scrolls_in_no_direction(serve, open_page, screenshot):
    server, page = start(serve, open_page, NARROW)
    asked = server.of_type("resize")[-1]
    assert (asked["width"], asked["height"]) == (780, 1520)
    server.say(NUMBERS)
    server.picture(1, noise(780, 1520))
    page.stage(frame=1)
    assert fits(page)
    assert not visible(page, "#settings") and visible(page, "#fps")
    page.page.tap("#sheet")
    page.page.wait_for_selector("#panel[data-open]")
    page.page.wait_for_timeout(300)
    assert visible(page, "#settings") and visible(page, "#copy")
    assert fits(page)
    screenshot(page, "narrow_sheet")
    page.page.tap("#sheet")
    page.page.wait_for_selector("#settings", state="hidden")
    assert server.of_type("resize")[1:] == []  # the sheet lies over the picture


@pytest.mark.parametrize("width", [320, 390, 760, 761, 1280])
def test_nothing_reaches_out_of_the_window(serve, open_page, width):
    server, page = start(serve, open_page, {**WIDE, "viewport": {"width": width, "height": 800}})
    server.say({**SETTINGS, "split": {"left": "paper", "right": "reference"}})
    server.say({**NUMBERS, "psnr": 30.0})
    server.say({"type": "error", "text": "a long line " * 20})
    server.say({"type": "command", "text": "splatline render " + "x" * 300})
    page.page.wait_for_selector("#command", state="attached")
    page.page.wait_for_timeout(100)
    assert fits(page)


def fits(page):
    """Return whether the page scrolls in no direction and cuts no text off."""
    cut = page.page.evaluate(
        """() => {
            const root = document.documentElement;
            const whole = root.scrollWidth <= innerWidth && root.scrollHeight <= innerHeight;
            const texts = document.querySelectorAll("button, .panel *");
            const cut = [...texts].filter((one) => one.scrollWidth > one.clientWidth + 1
                && one.clientWidth && getComputedStyle(one).overflow !== "clip");
            return [...(whole ? [] : [root]), ...cut].map((one) => one.outerHTML.slice(0, 200));
        }"""
    )
    print(*cut, sep="\n")
    return cut == []
