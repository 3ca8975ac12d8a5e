"""The page for everybody: names, contrast, the keyboard, and less motion for who asks for it."""

from .scripted_server import HELLO, NUMBERS, SETTINGS, noise, start, until

LEAST_CONTRAST = 4.5  # WCAG 2.2, level AA, for text of ordinary size

CONTRAST = """() => {
    const canvas = document.createElement("canvas").getContext("2d", {willReadFrequently: true});
    const levels = (colours) => {  // painted over each other, as the browser does
        canvas.clearRect(0, 0, 1, 1);
        for (const colour of colours) { canvas.fillStyle = colour; canvas.fillRect(0, 0, 1, 1); }
        return canvas.getImageData(0, 0, 1, 1).data;
    };
    const light = ([red, green, blue]) => [red, green, blue]
        .map((level) => level / 255)
        .map((level) => level <= 0.04045 ? level / 12.92 : ((level + 0.055) / 1.055) ** 2.4)
        .reduce((sum, level, index) => sum + level * [0.2126, 0.7152, 0.0722][index], 0);
    const ratio = (one, other) => {
        const [low, high] = [light(one), light(other)].sort((a, b) => a - b);
        return (high + 0.05) / (low + 0.05);
    };
    const found = [];
    for (const one of document.querySelectorAll("body *")) {
        const own = [...one.childNodes].some((node) => node.nodeType === 3 && node.data.trim());
        const seen = one.checkVisibility({visibilityProperty: true});
        if (!seen || !(own || one.matches("select"))) continue;
        if (one.matches("option, .hidden-label")) continue;
        const grounds = [];
        for (let at = one; at; at = at.parentElement)
            grounds.unshift(getComputedStyle(at).backgroundColor);
        if (one.closest(".stage")) grounds[2] = "#fff";  // of html, body, stage: a white picture
        const ink = getComputedStyle(one).color;
        const contrast = ratio(levels(grounds), levels([...grounds, ink]));
        found.push([contrast, one.outerHTML.slice(0, 120)]);
    }
    return found;
}"""


def busy_page(serve, open_page, **options):
    """Open a page on which everything is shown at once."""
    server, page = start(serve, open_page, **options)
    asked = server.of_type("resize")[-1]
    server.say(
        {
            **SETTINGS,
            "split": {"left": "paper", "right": "reference"},
            "colour": {"by": "height", "map": "turbo", "range": None},
        }
    )
    server.say({**NUMBERS, "psnr": 30.0})
    server.say({"type": "error", "text": "an error"})
    server.say({"type": "command", "text": "splatline render"})
    server.picture(1, noise(asked["width"], asked["height"]))
    page.stage(frame=1)
    page.page.click("#left-out summary")
    return server, page


def test_text_stands_out_from_its_ground(serve, open_page):
    _, page = busy_page(serve, open_page)
    found = page.page.evaluate(CONTRAST)
    page.page.keyboard.press("?")
    found += page.page.evaluate(CONTRAST)
    assert len(found) > 100
    assert [entry for entry in found if entry[0] < LEAST_CONTRAST] == []


def test_everything_has_a_name_for_a_screen_reader(serve, open_page):
    _, page = busy_page(serve, open_page)
    nameless = page.page.evaluate(
        """() => [...document.querySelectorAll("button, input, select, canvas, [role=slider]")]
            .filter((one) => !(one.labels?.length || one.getAttribute("aria-label")
                || one.textContent.trim())).map((one) => one.outerHTML)"""
    )
    assert nameless == []


def test_tab_reaches_every_control_and_shows_where_it_is(serve, open_page):
    _, page = busy_page(serve, open_page)
    page.page.evaluate("document.activeElement.blur()")
    reached, unmarked = set(), []
    for _ in range(60):
        page.page.keyboard.press("Tab")
        where, marked = page.page.evaluate(
            """() => {
                const one = document.activeElement;
                const around = one.closest(".choice label, .seam") ?? one;
                const bar = getComputedStyle(around, "::before").backgroundColor;
                const style = getComputedStyle(around);
                const ring = style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2;
                return [one.id || one.name || one.tagName.toLowerCase(),
                    ring || bar === "rgb(111, 211, 180)"];
            }"""
        )
        reached.add(where)
        if not marked and where != "body":
            unmarked.append(where)
    controls = {"canvas", "seam", "direction", "reset", "depth", "help-open", "toast-close"}
    controls |= {"preset", "quality", "samples", "lights", "colour-by", "colour-map"}
    controls |= {"range-from", "range-to", "background", "compare", "side-left", "side-right"}
    controls |= {"summary", "command", "save-png", "save-words", "copy"}
    assert controls - reached == set()
    assert unmarked == []


def test_nothing_moves_by_itself_for_who_wants_less_motion(serve, open_page):
    server = serve(greeting=())
    page = open_page(server.address, reduced_motion="reduce")
    until(page.page, lambda: server.connections)
    server.say({"type": "progress", "text": "Reading", "share": None})
    page.page.wait_for_selector("#centre[data-state='loading']")
    assert page.page.evaluate("document.getAnimations().length") == 0
    server.say(HELLO)
