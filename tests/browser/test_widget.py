"""The notebook's widget in a browser, with the kernel's part in this process."""

import base64

import numpy as np
import pytest

from splatline.view.draw import Settings, draw
from tests.support.clouds import sphere

SIZE = (200, 150)

OPEN = """async (source) => {
  const url = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  const { default: widget } = await import(url);
  const listeners = new Set();
  const values = { width: 200, height: 150, background: "#171a1f" };
  const model = {
    get: (name) => values[name],
    send: (message) => window.toKernel(message),
    on: (name, listener) => listeners.add(listener),
    off: (name, listener) => listeners.delete(listener),
  };
  window.fromKernel = (message, texts) => {
    const buffers = texts.map((text) =>
      new DataView(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer));
    for (const listener of listeners) listener(message, buffers);
  };
  window.leave = widget.render({ model, el: document.body });
}"""

PIXELS = """() => {
  const canvas = document.querySelector("canvas");
  const { width, height } = canvas;
  return [width, height, [...canvas.getContext("2d").getImageData(0, 0, width, height).data]];
}"""


class Notebook:
    """A page that shows a widget, and the widget."""

    def __init__(self, page, view):
        self.page, self.view = page, view
        self.sent = []
        view._loop = None  # Playwright's own loop runs here; a message is answered at once
        view.send = lambda content, buffers=(): self.sent.append((content, buffers))
        page.expose_function("toKernel", lambda message: view._handle_custom_msg(message, []))
        page.evaluate(OPEN, view._esm)

    def deliver(self):
        """Pass on what the widget has sent; return the messages."""
        self.page.wait_for_timeout(15)
        sent, self.sent = self.sent, []
        for content, buffers in sent:
            texts = [base64.b64encode(buffer).decode() for buffer in buffers or ()]
            self.page.evaluate("(told) => window.fromKernel(...told)", [content, texts])
        return [content for content, _ in sent]

    def settle(self):
        """Pass messages on until the refined picture is shown; return the canvas' pixels."""
        refined, quiet = False, 0
        for _ in range(400):
            sent = self.deliver()
            quiet = 0 if sent else quiet + 1
            for content in sent:
                refined = content.get("refined", refined)
            if refined and quiet > 8:
                width, height, pixels = self.page.evaluate(PIXELS)
                return np.array(pixels, np.uint8).reshape(height, width, 4)
            self.view._wake(0.0)
        raise AssertionError("no refined picture")

    def golden(self):
        """Return the picture of the view's camera."""
        live = self.view._session.live
        return draw(live, self.view.camera, SIZE, Settings(samples=4)).rgba


@pytest.fixture
def notebook(chromium):
    pytest.importorskip("anywidget", reason="the extra `notebook` is not installed")
    from splatline.view.notebook.show import show

    page = chromium.new_page(viewport={"width": 400, "height": 300})
    errors = []
    page.on("console", lambda line: errors.append(line.text) if line.type == "error" else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    yield Notebook(page, show(sphere(2000), size=SIZE, samples=4))
    page.close()
    assert errors == []


def test_the_widget_shows_golden_and_follows_the_hand(notebook):
    first = notebook.settle()
    assert first.shape == (150, 200, 4)
    np.testing.assert_array_equal(first, notebook.golden())
    assert "code words" in notebook.page.inner_text("[role=status]")

    before, mouse = notebook.view.camera, notebook.page.mouse
    mouse.move(100, 80)
    mouse.down()
    mouse.move(140, 90, steps=4)
    mouse.up()
    turned = notebook.settle()
    assert notebook.view.camera.azimuth != before.azimuth
    np.testing.assert_array_equal(turned, notebook.golden())
    assert (turned != first).any()

    mouse.wheel(0, -200)
    near = notebook.settle()
    assert notebook.view.camera.distance < before.distance
    np.testing.assert_array_equal(near, notebook.golden())

    notebook.page.keyboard.press("r")
    np.testing.assert_array_equal(notebook.settle(), first)
    notebook.page.evaluate("window.leave()")
    assert notebook.page.query_selector("canvas") is None


def test_a_picture_is_saved(notebook):
    notebook.settle()
    notebook.page.mouse.click(100, 80)
    with notebook.page.expect_download() as download:
        notebook.page.keyboard.press("s")
        for _ in range(20):
            notebook.deliver()
    assert download.value.suggested_filename == "test.png"
