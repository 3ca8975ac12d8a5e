"""A server that dies and comes back."""

from .scripted_server import HELLO, SETTINGS, ScriptedServer, noise, start, until


def test_the_page_connects_again_and_restores_its_settings(serve, open_page, screenshot):
    server, page = start(serve, open_page)
    server.say({**SETTINGS, "lights": "front", "samples": 4})
    server.picture(7, noise(952, 800, seed=1))
    page.stage(frame=7)
    server.close()
    page.page.wait_for_selector("#link:not([hidden])")
    assert page.text("#link") == "The connection is lost. Trying again …"
    screenshot(page, "connection_lost")
    assert page.pixels()[..., :3].std() > 50  # the last picture stands

    again = serve(server.port)
    until(page.page, lambda: again.of_type("camera"))
    page.page.wait_for_selector("#link", state="hidden")
    assert again.of_type("resize")[0] == {"type": "resize", "width": 952, "height": 800}
    restored = {message["name"]: message["value"] for message in again.of_type("set")}
    expected = {**SETTINGS, "lights": "front", "samples": 4}
    assert restored == {name: expected[name] for name in restored}
    assert len(restored) == 8
    camera = {"target": [0, 0, 0], "distance": 5, "azimuth": 30, "elevation": 20}
    assert again.of_type("camera") == [{"type": "camera", **camera}]

    sent = noise(952, 800, seed=2)
    again.picture(1, sent)  # frames are counted anew, and this one is newer than 7
    page.stage(frame=1)
    assert (page.pixels() == sent).all()


def test_another_cloud_begins_with_its_own_settings(serve, open_page):
    server, page = start(serve, open_page)
    server.close()
    page.page.wait_for_selector("#link:not([hidden])")
    again = serve(server.port, ({**HELLO, "name": "another"}, SETTINGS))
    page.page.wait_for_selector("#cloud:text('another')")
    page.page.wait_for_selector("#link", state="hidden")
    page.page.wait_for_timeout(50)
    assert again.of_type("set", "camera") == []


def test_attempts_become_rarer(serve, open_page):
    server = serve()
    page = open_page(server.address)
    until(page.page, lambda: server.connections)
    server.close()
    page.page.wait_for_timeout(3000)
    # Attempts come 0.25, 0.75 and 1.75 s after the end.
    assert 1 <= len(page.retries) <= 3
    assert all("ERR_CONNECTION_REFUSED" in line for line in page.retries)


def test_what_is_done_meanwhile_is_no_error(serve, open_page):
    server, page = start(serve, open_page)
    server.close()
    page.page.wait_for_selector("#link:not([hidden])")
    page.drag((300, 300), (500, 500))
    page.page.mouse.wheel(0, 100)
    page.page.keyboard.press("r")
    page.page.select_option("#preset", "paper")
    page.page.click("#save-png")
    page.page.click("#copy")
    page.page.set_viewport_size({"width": 1000, "height": 600})
    again = ScriptedServer(server.port)
    try:
        page.page.wait_for_selector("#link", state="hidden")
        until(page.page, lambda: again.of_type("camera"))
        assert again.of_type("resize")[0]["width"] == 672
        assert page.page.input_value("#preset") == "rgb24"
    finally:
        again.close()
