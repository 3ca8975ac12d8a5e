"""A server that says what a test tells it to, and notes what the page says."""

import asyncio
import json
import struct
import threading
import time

import numpy as np
from aiohttp import WSMsgType, web

from splatline.view.server.pages import HEADERS, page_files

PATIENCE = 20.0  # seconds
MAGIC = 0x4C505330

SETTINGS = {
    "type": "settings",
    "preset": "rgb24",
    "quality": "exact",
    "samples": 1,
    "lights": "studio",
    "background": "#171a1f",
    "colour": {"by": "default", "map": None, "range": None},
    "show": "picture",
    "split": None,
    "camera": {"target": [0, 0, 0], "distance": 5, "azimuth": 30, "elevation": 20},
}
HELLO = {
    "type": "hello",
    "name": "scripted",
    "points": 1234567,
    "colours": [{"by": "default", "label": "as in the file"}, {"by": "height", "label": "height"}],
    "maps": ["viridis", "turbo"],
    "presets": [
        {"name": "paper", "title": "the paper's", "lut4": 1, "ff": 2, "bram": 3, "mult": 0}
        | {"clock_mhz": 100.0, "device": "ECP5-25F"},
        {"name": "rgb24", "title": "24-bit colour", "lut4": 1801, "ff": 902, "bram": 9, "mult": 4}
        | {"clock_mhz": 137.0, "device": "LFE5U-25F-6BG381"},
    ],
    "qualities": [{"name": name, "title": name} for name in ("paper", "fast", "exact")],
    "lights": [{"name": name, "title": name} for name in ("studio", "front")],
    "samples": [1, 4, 16],
    "notes": ["normals were estimated"],
}
NUMBERS = {
    "type": "numbers",
    "frame": 1,
    "codewords": 155730,
    "cycles": 311460,
    "cycles_per_element": 1.71,
    "fps": 441.2,
    "clock_mhz": 137.0,
    "elements": 150000,
    "left_out": {"outside": 1000, "no_pixel": 234},
    "points": 151234,
    "host_ms": 5.0,
    "golden_ms": 7.0,
    "samples": 1,
    "width": 200,
    "height": 100,
    "tiles": 1,
    "psnr": None,
}


class ScriptedServer:
    """Serves the page, and one socket whose other end is the test.

    Parameters
    ----------
    port
        0: any free one.
    greeting
        Messages that are sent when a page connects.
    changed
        For planted faults: name of a file -> (text, other text) in it.
    """

    def __init__(self, port=0, greeting=(HELLO, SETTINGS), changed=None):
        self.port = port
        self.greeting = greeting
        self.changed = changed or {}
        self.received = []
        self.connections = 0
        self._sockets = []
        self._transports = []
        self._loop = asyncio.new_event_loop()
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        assert self._ready.wait(10)

    @property
    def address(self):
        return f"http://127.0.0.1:{self.port}/?token=t"

    def close(self):
        """End at once, as if the process were killed: no closing handshake."""
        if not self._loop.is_closed():
            asyncio.run_coroutine_threadsafe(self._end(), self._loop).result(10)
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join(10)
            self._loop.close()

    def say(self, message):
        """Send a text message."""
        self._send(json.dumps(message))

    def picture(self, frame, pixels, *, kind=1, refined=True, png=None):
        """Send a picture of shape (height, width, 4); ``png``: its bytes, if it goes as such."""
        height, width = pixels.shape[:2]
        data = pixels.tobytes() if png is None else png
        words = (MAGIC, kind, frame, width, height, int(png is not None), int(refined), len(data))
        self._send(struct.pack("<8I", *words) + data)

    def raw(self, data):
        """Send bytes as they are."""
        self._send(data)

    def file(self, name, mime, data):
        """Send a file."""
        self.say({"type": "file", "name": name, "mime": mime, "bytes": len(data)})
        self._send(struct.pack("<8I", MAGIC, 3, 0, 0, 0, 0, 0, len(data)) + data)

    def of_type(self, *types):
        """Return the received messages of some types."""
        return [message for message in tuple(self.received) if message["type"] in types]

    def _send(self, data):
        async def send():
            socket = self._sockets[-1]
            await (socket.send_str(data) if isinstance(data, str) else socket.send_bytes(data))

        asyncio.run_coroutine_threadsafe(send(), self._loop).result(10)

    def _run(self):
        asyncio.set_event_loop(self._loop)
        self._loop.run_until_complete(self._start())
        self._ready.set()
        self._loop.run_forever()

    async def _start(self):
        app = web.Application()
        app.add_routes([web.get("/", self._file), web.get("/page/{name}", self._file)])
        app.add_routes([web.get("/socket", self._socket)])
        self._runner = web.AppRunner(app, shutdown_timeout=0)
        await self._runner.setup()
        await web.TCPSite(self._runner, "127.0.0.1", self.port, reuse_address=True).start()
        self.port = self._runner.addresses[0][1]

    async def _end(self):
        for transport in self._transports:
            transport.abort()
        await self._runner.cleanup()

    async def _file(self, request):
        name = request.match_info.get("name", "index.html")
        kind, data = page_files()[name]
        if name in self.changed:
            old, new = (text.encode() for text in self.changed[name])
            assert old in data, f"{name} holds no {old!r}"
            data = data.replace(old, new)
        return web.Response(body=data, content_type=kind, headers=HEADERS)

    async def _socket(self, request):
        socket = web.WebSocketResponse(max_msg_size=4096)
        await socket.prepare(request)
        self.connections += 1
        self._sockets.append(socket)
        self._transports.append(request.transport)
        for message in self.greeting:
            await socket.send_str(json.dumps(message))
        async for message in socket:
            if message.type == WSMsgType.TEXT:
                self.received.append(json.loads(message.data))
        return socket


def noise(width, height, seed=0):
    """Return an opaque picture in which no two pixels need be alike."""
    pixels = np.random.default_rng(seed).integers(0, 256, (height, width, 4), np.uint8)
    pixels[..., 3] = 255
    return pixels


def start(serve, open_page, *form, **options):
    """Start a server and open its page; return both when the page has told its size."""
    server = serve()
    page = open_page(server.address, *form, **options)
    until(page.page, lambda: server.of_type("resize"))
    return server, page


def until(page, condition):
    """Wait until a condition holds, while the page goes on; return its value."""
    end = time.monotonic() + PATIENCE
    while not (value := condition()):
        assert time.monotonic() < end, "the condition did not come true"
        page.wait_for_timeout(10)
    return value
