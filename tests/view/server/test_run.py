"""What a live view does beside serving: it opens the browser, and ends on a signal."""

import os
import signal
import threading
import webbrowser

import pytest

from splatline.view.choices import Choices
from splatline.view.draw import Settings
from splatline.view.server.run import serve
from tests.view.views import ball


@pytest.mark.parametrize("browser", [True, False])
def test_the_browser_is_opened_at_the_address_unless_it_is_not_wanted(browser, monkeypatch):
    opened, announced = [], []
    asked = threading.Event()

    def announce(address):
        announced.append(address)
        threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()

    monkeypatch.setattr(webbrowser, "open", lambda address: (opened.append(address), asked.set()))
    serve(ball(), Choices(Settings()), browser=browser, announce=announce)
    assert len(announced) == 1
    assert "127.0.0.1" in announced[0]
    if browser:
        assert asked.wait(5.0)
    assert opened == announced * browser
