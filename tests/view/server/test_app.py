"""Who may use the server, and what it gives."""

import asyncio

import aiohttp
import pytest

from splatline.view.server.app import MOST_TABS, is_loopback
from splatline.view.server.pages import HEADERS, page_files
from tests.view.server.pages import client, serve
from tests.view.views import ball


@pytest.fixture
def page(monkeypatch):
    """Puts a page of two files in place."""
    from splatline.view.server import app
    from splatline.view.server.pages import PageFile

    files = {
        "index.html": PageFile("text/html", b"<p>page"),
        "main.js": PageFile("text/javascript", b"1"),
    }
    monkeypatch.setattr(app, "page_files", lambda: files)
    return files


async def get(url, **headers):
    """Return status, text and headers of an address."""
    async with aiohttp.ClientSession() as session, session.get(url, headers=headers) as answer:
        return answer.status, await answer.text(), answer.headers


def ask(*paths, **headers):
    """Return the answers to some paths; each is made by a function of the address."""

    async def use(address):
        return [await get(path(address), **headers) for path in paths]

    return serve(ball(), use)


def test_the_page_needs_the_token_and_its_files_do_not(page):
    answers = ask(
        lambda address: address,
        lambda address: address.with_query({}),
        lambda address: address.with_query(token=address.query["token"][:-1]),
        lambda address: address.with_query(token="é\x00"),
        lambda address: address.with_path("/page/main.js").with_query({}),
    )
    assert [status for status, _, _ in answers] == [200, 403, 403, 403, 200]
    assert answers[0][1] == "<p>page"
    assert answers[1][1].count("\n") == 1
    assert "token" in answers[1][1]
    for _, _, headers in answers:
        assert all(headers[name] == value for name, value in HEADERS.items())
    policy = answers[0][2]["Content-Security-Policy"]
    assert "default-src 'self'" in policy
    assert "unsafe-inline" not in policy


@pytest.mark.parametrize(
    "path",
    ["/page/..%2fsession.py", "/page/%2e%2e/session.py", "/page//etc/passwd", "/page/session.py",
     "/page/", "/session.py", "/page/index.html/../main.js%00", "/page/__init__.py"],
)  # fmt: skip
def test_no_path_reaches_the_disk(page, path):
    from yarl import URL

    [(status, text, _)] = ask(lambda address: URL(f"{address.origin()}{path}", encoded=True))
    assert status == 404
    assert "import" not in text


def test_another_name_is_refused(page):
    [(status, text, _)] = ask(lambda address: address, Host="rebound.example.org:80")
    assert status == 403
    assert text.count("\n") == 1
    [(status, _, _)] = ask(lambda address: address, Host="localhost:80")
    assert status == 200


@pytest.mark.parametrize(
    ("token", "origin", "status"),
    [(None, None, 403), ("wrong", None, 403), (None, "http://evil.example", 403),
     ("right", "http://evil.example", 403), ("right", "", 403), ("right", "null", 403)],
)  # fmt: skip
def test_a_socket_needs_the_token_and_the_origin(token, origin, status):
    async def use(address):
        given = address.query["token"] if token == "right" else token or ""
        url = address.with_path("/socket").with_query(token=given)
        headers = {} if origin == "" else {"Origin": origin or str(address.origin())}
        async with aiohttp.ClientSession() as session:
            with pytest.raises(aiohttp.WSServerHandshakeError) as caught:
                await session.ws_connect(url, headers=headers)
            return caught.value.status

    assert serve(ball(), use) == status


def test_there_is_a_limit_of_tabs():
    async def use(address):
        import contextlib

        async with contextlib.AsyncExitStack() as stack:
            for _ in range(MOST_TABS):
                await stack.enter_async_context(client(address))
            with pytest.raises(aiohttp.WSServerHandshakeError) as caught:
                await stack.enter_async_context(client(address))
            assert caught.value.status == 503
        await asyncio.sleep(0.1)
        async with client(address) as page:
            await page.send("resize", width=32, height=32)
            await page.picture()

    serve(ball(), use)


def test_files_of_the_page_have_types_that_browsers_take():
    for name, file in page_files().items():
        assert "/" not in name
        assert file.data
        assert file.mime.partition("/")[0] in ("text", "image", "font")


@pytest.mark.parametrize(
    ("host", "own"),
    [("127.0.0.1", True), ("127.8.0.1", True), ("::1", True), ("localhost", True),
     ("0.0.0.0", False), ("192.168.1.4", False), ("example.org", False), ("", False)],
)  # fmt: skip
def test_loopback_is_known(host, own):
    assert is_loopback(host) is own
