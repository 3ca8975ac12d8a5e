"""Two hundred random events, and a server that is killed amid them and comes back."""

import random

import numpy as np

from .golden_terrain import golden

SMALL = {"viewport": {"width": 840, "height": 500}}
SEED = 20260731
EVENTS = 200
KILLED_AFTER = 120

PRESETS = ("paper", "rgb24", "lanes8", "swift", "plane", "swift-plane")


def place(rng):
    """Return a place on the canvas, away from what lies over it."""
    return rng.randint(130, 500), rng.randint(70, 420)


def events(rng, page):
    """Return what may be done, by name; each is called without arguments."""
    mouse, keyboard = page.mouse, page.keyboard

    def drag():
        mouse.move(*place(rng))
        mouse.down(button=rng.choice(("left", "left", "right")))
        mouse.move(*place(rng), steps=rng.randint(1, 8))
        mouse.up(button="left")
        mouse.up(button="right")

    def wheel():
        mouse.move(*place(rng))
        mouse.wheel(0, rng.choice((-240, -120, 120, 240)))

    def choose(control, values):
        page.select_option(control, rng.choice(values))

    return {
        "drag": drag,
        "wheel": wheel,
        "double click": lambda: mouse.dblclick(*place(rng)),
        "key": lambda: keyboard.press(rng.choice("123456789rd+-")),
        "arrow": lambda: keyboard.press(rng.choice(("ArrowLeft", "Shift+ArrowUp", "ArrowDown"))),
        "preset": lambda: choose("#preset", PRESETS),
        "quality": lambda: choose("#quality", ("paper", "fast", "exact")),
        "lights": lambda: choose("#lights", ("studio", "front", "side", "matte", "none")),
        "samples": lambda: page.click(f"#samples label:has([value='{rng.choice((1, 2))}'])"),
        "colour": lambda: choose("#colour-by", ("default", "height")),
        "background": lambda: page.fill("#background", f"#{rng.randrange(1 << 24):06x}"),
        "compare": lambda: page.click("#compare"),
        "size": lambda: page.set_viewport_size(
            {"width": rng.randint(780, 900), "height": rng.randint(440, 540)}
        ),
        "nothing": lambda: page.wait_for_timeout(rng.randint(0, 60)),
    }


def test_200_random_events_and_a_killed_server_leave_no_error(view, open_page, screenshot):
    rng = random.Random(SEED)
    server = view()
    page = open_page(server.address, SMALL)
    page.settled()
    acts = events(rng, page.page)
    often = ["drag", "wheel", "key", "nothing"] * 3
    for number in range(EVENTS):
        if number == KILLED_AFTER:
            server.kill()
            page.page.wait_for_selector("#link:not([hidden])")
        if number == KILLED_AFTER + 20:
            view(port=server.port)
            page.page.wait_for_selector("#link", state="hidden", timeout=page.patience)
        acts[rng.choice([*acts, *often])]()

    # The first settings again: only what golden draws can be compared.
    page.page.set_viewport_size(SMALL["viewport"])
    page.settled(lambda: page.page.click("#reset"))
    if page.told("settings")["split"]:
        page.settled(lambda: page.page.uncheck("#compare"))
    if page.told("settings")["show"] == "depth":
        page.settled(lambda: page.page.click("#depth"))
    if page.told("settings")["colour"]["by"] != "default":
        page.settled(lambda: page.page.select_option("#colour-by", "default"))
    settings = page.told("settings")
    np.testing.assert_array_equal(page.pixels(), golden(settings, page.canvas_size()).rgba)
    assert page.retries != []  # the attempts while the server was away, see live_page.RETRY
    screenshot(page, "after_200_events")
