"""A real browser: Debian's Chromium, driven by Playwright. Without one, tests are skipped."""

import os
import shutil
from pathlib import Path

import pytest

from .viewer import Viewer

SCREENSHOTS = Path(__file__).parents[2] / "build" / "browser"
CHROMIUM = (
    os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
)
WIDE = {"viewport": {"width": 1280, "height": 800}}
NARROW = {
    "viewport": {"width": 390, "height": 844},
    "device_scale_factor": 2,
    "has_touch": True,
    "is_mobile": True,
}


def pytest_collection_modifyitems(items):
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.browser)


@pytest.fixture(scope="session")
def chromium():
    """The browser."""
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="the extra `browser` is not installed: make test-browser"
    )
    if CHROMIUM is None:
        pytest.skip("no browser: apt-get install chromium")
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", "--headless=new", "--disable-gpu"]
        )
        yield browser
        browser.close()


@pytest.fixture
def open_page(chromium):
    """Open a page at an address; at the end, no page may have written an error to its console."""
    from .live_page import LivePage

    contexts, pages = [], []

    def open_one(address, form=WIDE, **options):
        context = chromium.new_context(**form, accept_downloads=True, **options)
        contexts.append(context)
        page = LivePage(context.new_page())
        pages.append(page)
        page.open(address)
        return page

    yield open_one
    for context in contexts:
        context.close()
    assert [line for page in pages for line in page.errors] == []


@pytest.fixture
def serve():
    """Start a scripted server; all end with the test."""
    pytest.importorskip("aiohttp", reason="the extra `view` is not installed")
    from .scripted_server import ScriptedServer

    servers = []

    def start(*args, **options):
        servers.append(ScriptedServer(*args, **options))
        return servers[-1]

    yield start
    for server in servers:
        server.close()


@pytest.fixture(scope="session")
def terrain_viewer():
    """`splatline view` of the built-in terrain; after all tests, Ctrl-C ends it."""
    pytest.importorskip("aiohttp", reason="the extra `view` is not installed")
    viewer = Viewer()
    yield viewer
    assert viewer.interrupt() == 0


@pytest.fixture
def view():
    """Start `splatline view` with some arguments; it is killed at the end."""
    pytest.importorskip("aiohttp", reason="the extra `view` is not installed")
    viewers = []

    def start(*arguments, **options):
        viewers.append(Viewer(*arguments, **options))
        return viewers[-1]

    yield start
    for viewer in viewers:
        if viewer.process.poll() is None:
            viewer.kill()


@pytest.fixture
def screenshot():
    """Save what a page shows as build/browser/NAME.png."""
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    return lambda page, name: page.page.screenshot(path=SCREENSHOTS / f"{name}.png")
