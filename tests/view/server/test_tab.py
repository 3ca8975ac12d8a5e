"""A page's connection, over a real WebSocket."""

import asyncio
import dataclasses
import json
import time

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.wanted import ColourBy
from splatline.view.choices import Choices
from splatline.view.draw import Settings, draw
from splatline.view.subject import Subject
from tests.view.server.pages import client, serve
from tests.view.views import ball, write_ball

SIZE = (64, 48)


def rgba(picture):
    """Return the pixels of a raw picture."""
    header, payload = picture
    assert header[5] == 0
    assert header[7] == len(payload)
    return np.frombuffer(payload, np.uint8).reshape(header[4], header[3], 4)


def test_a_page_gets_hello_and_a_refined_picture_with_numbers():
    subject = ball()

    async def use(address):
        async with client(address) as page:
            await page.send("resize", width=SIZE[0], height=SIZE[1])
            hello = await page.message("hello")
            shown = await page.picture(refined=True)
            numbers = await page.message("numbers")
            settings = await page.message("settings")
            return hello, shown, numbers, settings

    hello, shown, numbers, settings = serve(subject, use)
    assert (hello["name"], hello["points"]) == ("ball", 2000)
    assert [row["by"] for row in hello["colours"]] == ["default", "height"]
    for name in ("presets", "qualities", "lights"):
        assert all(row["name"] and row["title"] for row in hello[name])
    assert numbers["frame"] == shown[0][2]
    assert settings["camera"]["up"] == "y"
    live = subject.read(None)
    camera = subject.home(live, SIZE).rounded()
    assert np.array_equal(rgba(shown), draw(live, camera, SIZE).rgba)


def test_bad_messages_are_answered_and_end_nothing():
    bad = ["", "{", "[]", '"x"', '{"type":"nothing"}', '{"type":"turn","dx":"1","dy":2}',
           "[" * 4000, "x" * 5000]  # fmt: skip

    async def use(address):
        async with client(address) as page:
            for text in bad:
                await page.socket.send_str(text)
                error = await page.message("error")
                assert "\n" not in error["text"]
            await page.socket.send_bytes(b"123")
            await page.message("error")
            await page.send("resize", width=SIZE[0], height=SIZE[1])
            return await page.picture()

    assert serve(ball(), use)


def test_a_huge_message_ends_its_own_session_alone():
    async def use(address):
        async with client(address) as page, client(address) as other:
            await page.socket.send_str("x" * (1 << 17))
            while not page.socket.closed:
                await page.socket.receive(10)
            assert page.socket.close_code == 1009
            await other.send("resize", width=SIZE[0], height=SIZE[1])
            return await other.picture(refined=True)

    assert serve(ball(), use)


def test_a_client_that_acknowledges_nothing_gets_two_frames_and_then_the_newest():
    async def use(address):
        async with client(address) as page:
            page.acknowledges = False
            await page.send("resize", width=SIZE[0], height=SIZE[1])
            await page.send("moving", value=True)
            first = await page.picture()
            for _ in range(50):
                await page.send("turn", dx=2, dy=0)
                await asyncio.sleep(0.002)
            second = await page.picture()
            with pytest.raises(TimeoutError):
                while True:
                    message = await asyncio.wait_for(page.next(), 0.4)
                    assert isinstance(message, dict)
            await page.send("command")
            asked = await page.message("command")
            await page.send("shown", frame=second[0][2])
            third = await page.picture()
            await page.send("command")
            return [first, second, third], asked["text"], await page.message("command")

    (first, second, third), asked, command = serve(ball(), use)
    assert [shown[0][2] for shown in (first, second, third)] == [1, 2, 3]
    # The third one has all steps: it is that of the command.
    assert asked == command["text"]
    words = command["text"].split()
    azimuth, elevation = map(float, words[words.index("--orbit") + 1].split(","))
    subject = ball()
    live = subject.read(None)
    camera = dataclasses.replace(
        subject.home(live, SIZE).rounded(), azimuth=azimuth, elevation=elevation
    )
    # The button is down, so its specks are not closed.
    assert np.array_equal(rgba(third), draw(live, camera, SIZE, Settings(close_specks=False)).rgba)


def test_an_acknowledgement_of_what_was_never_sent_counts_for_nothing():
    async def use(address):
        async with client(address) as page:
            page.acknowledges = False
            await page.send("resize", width=SIZE[0], height=SIZE[1])
            await page.picture()
            await page.send("shown", frame=1000)
            await page.send("moving", value=True)
            frames = 1
            for _ in range(20):
                await page.send("turn", dx=2, dy=0)
                await asyncio.sleep(0.02)
            with pytest.raises(TimeoutError):
                while True:
                    frames += isinstance(await asyncio.wait_for(page.next(), 0.3), tuple)
            return frames

    assert serve(ball(), use) <= 4


def test_several_tabs_have_cameras_and_settings_of_their_own():
    async def use(address):
        async with client(address) as one, client(address) as other:
            for page in (one, other):
                await page.send("resize", width=SIZE[0], height=SIZE[1])
            await one.send("set", name="preset", value="paper")
            await one.send("orbit", azimuth=90, elevation=0)
            await asyncio.gather(one.picture(refined=True), other.picture(refined=True))
            await one.send("command")
            await other.send("command")
            return (await one.message("command"))["text"], (await other.message("command"))["text"]

    one, other = serve(ball(), use)
    assert "--preset paper" in one
    assert "--preset" not in other
    assert "--orbit 30,20" in other


def test_files_are_sent_after_their_names():
    async def use(address):
        async with client(address) as page:
            await page.send("resize", width=SIZE[0], height=SIZE[1])
            await page.picture(refined=True)
            found = []
            for what in ("png", "words"):
                await page.send("save", what=what)
                told = await page.message("file")
                found.append((told, await page.next()))
            return found

    for told, (header, payload) in serve(ball(), use):
        assert header[1] == 3
        assert header[7] == len(payload) == told["bytes"]
        assert payload[:4] in (b"\x89PNG", b"PK\x03\x04")


def test_a_bad_file_is_told_in_the_page_and_the_server_lives(tmp_path):
    path = tmp_path / "bad.ply"
    path.write_bytes(b"ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nend_header\n1\n")

    async def use(address):
        errors = []
        for _ in range(2):
            async with client(address) as page:
                await page.send("resize", width=SIZE[0], height=SIZE[1])
                errors.append((await page.message("error"))["text"])
                await page.send("command")
                await page.message("error")
        return errors

    errors = serve(Subject(path=path, name="bad"), use)
    assert "bad.ply" in errors[0]
    assert errors[0] == errors[1]
    assert "\n" not in errors[0]


def test_other_colours_are_read_with_progress_and_bad_ones_refused(tmp_path):
    subject = Subject(path=write_ball(tmp_path / "ball.csv"), name="ball", up="z")

    async def use(address):
        async with client(address) as page:
            await page.send("resize", width=SIZE[0], height=SIZE[1])
            hello = await page.message("hello")
            first = await page.picture(refined=True)
            await page.send("set", name="colour", value={"by": "warmth", "map": "magma"})
            assert (await page.message("progress"))["text"]
            await page.message("hello")
            warm = await page.picture(refined=True)
            await page.send("set", name="colour", value={"by": "no such column"})
            error = await page.message("error")
            settings = await page.until(
                lambda each: isinstance(each, dict) and each["type"] == "settings"
                and each["colour"]["by"] == "warmth"
            )  # fmt: skip
            return hello, first, warm, error, settings

    hello, first, warm, error, _ = serve(subject, use)
    assert {"by": "warmth", "label": "warmth"} in hello["colours"]
    assert "no such column" in error["text"]
    assert not np.array_equal(rgba(first), rgba(warm))
    live = subject.read(ColourBy("warmth", "magma"))
    camera = subject.home(live, SIZE).rounded()
    assert np.array_equal(rgba(warm), draw(live, camera, SIZE).rgba)


def test_what_fails_unexpectedly_is_told_too(caplog):
    class Broken(Subject):
        def read(self, colour, progress=None, base=None):
            raise KeyError("a bug")

    async def use(address):
        async with client(address) as page:
            return await page.message("error")

    error = serve(Broken(name="broken"), use)
    assert "broken cannot be read" in error["text"]
    assert "a bug" in caplog.text


def test_the_server_ends_while_a_cloud_is_read():
    """A read ends at its next word of progress."""
    ended = []

    class Endless(Subject):
        def read(self, colour, progress=None, base=None):
            start = time.monotonic()
            try:
                while time.monotonic() < start + 10.0:
                    progress("Reading", 0.5)
                    time.sleep(0.001)
            finally:
                ended.append(time.monotonic() - start)

    async def use(address):
        async with client(address) as page:
            assert (await page.message("progress"))["text"] == "Reading"

    serve(Endless(name="endless"), use)
    assert ended[0] < 5.0


def test_the_first_settings_are_those_of_the_command_line():
    async def use(address):
        async with client(address) as page:
            await page.send("resize", width=SIZE[0], height=SIZE[1])
            return await page.message("settings")

    settings = serve(ball(), use, Choices(Settings(samples=4, lights="side")))
    assert (settings["samples"], settings["lights"]) == (4, "side")
    assert json.loads(json.dumps(settings)) == settings


def test_an_address_that_is_taken_is_an_error_of_one_line():
    from splatline.view.server.run import running

    async def use(address):
        with pytest.raises(InputError, match="cannot be served"):
            async with running(ball(), Choices(), port=address.port):
                pass

    serve(ball(), use)
