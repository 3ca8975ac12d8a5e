"""Live view: protocol between page and server.

``GET /?token=T`` gives index.html, ``GET /page/<file>`` a file of a fixed list: no path from the
client reaches the disk. The token is needed for ``/`` and ``/socket`` (query ``token``, compared in
constant time); a wrong one is answered by 403 with one line. Other files need none, as they hold no
data. All have a Content-Security-Policy: no inline script or style, nothing from elsewhere.

WebSocket ``/socket?token=T``. Origin must be that of the address served. Text messages are JSON
objects, at most 4 kB from the client. Unknown or bad ones are answered by
``{"type": "error", "text": "one line"}`` and never end the session. A message larger than 64 kB
ends it.

Client to server (coordinates in pixels of the last ``resize``)::

    {"type":"resize","width":W,"height":H}         size of the canvas in device pixels; 16..4096
    {"type":"turn","dx":px,"dy":px}                drag
    {"type":"pan","dx":px,"dy":px}                 shift-drag, right-drag, two fingers
    {"type":"zoom","factor":f,"x":px,"y":px}       wheel, pinch: distance times f, 0.1..10
    {"type":"look","x":px,"y":px}                  double click: look at the point there
    {"type":"reset"}                               the first camera
    {"type":"orbit","azimuth":a,"elevation":e}     keys
    {"type":"camera","target":[x,y,z],"distance":d,"azimuth":a,"elevation":e}
                                                   after a new connection, as it was before
    {"type":"moving","value":true|false}           pointer down or up: coarse while true
    {"type":"set","name":N,"value":V}              N and V: see below
    {"type":"shown","frame":n}                     acknowledges frame n and those before
    {"type":"save","what":"png"|"words"}           answered by a file
    {"type":"command"}                             answered by a command line

Settings: ``preset``, ``quality``, ``lights``: a name of ``hello``. ``samples``: a number of
``hello``. ``background``: ``"#rrggbb"``. ``colour``: ``{"by":..,"map":..|null,"range":..|null}``.
``show``: ``"picture"`` or ``"depth"``. ``split``: null or ``{"left":X,"right":Y}``, each of
``"paper"``, ``"engine"`` and ``"reference"``; only refined frames are split.

Server to client, text::

    {"type":"hello","name":..,"points":n,"colours":[{"by":..,"label":..}],"maps":[..],
     "presets":[{"name","title","lut4","ff","bram","mult","clock_mhz"|null,"device"|null}],
     "qualities":[{"name","title"}],"lights":[{"name","title"}],"samples":[1,2,4,8,16],
     "notes":[..]}                                 when the cloud is read; again in other colours
    {"type":"settings", each setting, "camera":{"target":[x,y,z],"distance":d,"azimuth":a,
     "elevation":e,"up":..,"fov":..}|null}         after a change, and with each refined frame
    {"type":"progress","text":..,"share":0.4|null} while the cloud is read; share 1 ends it
    {"type":"numbers","frame":n,"codewords":..,"cycles":..,"cycles_per_element":..|null,
     "fps":..|null,"clock_mhz":..|null,"elements":..,"left_out":{reason:points},"points":..,
     "host_ms":..,"golden_ms":..,"samples":..,"width":..,"height":..,"tiles":..,
     "psnr":dB|null}                               with each refined frame
    {"type":"error","text":"one line"}   {"type":"command","text":..}
    {"type":"file","name":..,"mime":..,"bytes":n}  followed by one binary message of kind 3

Server to client, binary: a header of eight little-endian uint32, then the payload: magic
0x4C505330; kind (1 picture, 2 right picture of a split, 3 file); frame (1, 2, ...; of kind 2 that
of its picture, of kind 3 0); width and height of the payload; encoding (0 raw RGBA, 1 PNG); flags
(bit 0: refined); bytes of the payload. A picture smaller than the canvas is scaled up by the
client, and one older than the last one shown is dropped.

The server draws a frame only while few are not acknowledged: see ``view.unshown``. So a slow link
or page has no backlog, and what it gets next is the newest.
"""

from __future__ import annotations

import json
import struct

from splatline.contract.errors import InputError
from splatline.view.events import Event, check_event
from splatline.view.outputs import Picture, SavedFile

from .png import png_bytes

__all__ = [
    "FILE",
    "HEADER",
    "LARGEST_FRAME",
    "MAGIC",
    "MOST_BYTES",
    "PICTURE",
    "PNG",
    "RAW",
    "REFINED",
    "SECOND",
    "file_bytes",
    "picture_bytes",
    "read_message",
]

MAGIC = 0x4C505330
HEADER = struct.Struct("<8I")
PICTURE, SECOND, FILE = 1, 2, 3
"""Kinds of binary messages."""
RAW, PNG = 0, 1
"""Encodings of a picture."""
REFINED = 1
"""Flag of a picture that is as fine as it gets."""

MOST_BYTES = 4096
"""Bytes of a client's message; a larger one is an error."""

LARGEST_FRAME = 1 << 16
"""Bytes of a client's message that end the session."""


def read_message(text: str) -> Event:
    """Return the event of a client's message.

    Raises
    ------
    InputError
        If it is too long, no JSON, or tells no event; one line.
    """
    if len(text) > MOST_BYTES or len(text.encode(errors="replace")) > MOST_BYTES:
        raise InputError(f"a message has at most {MOST_BYTES} bytes")
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        raise InputError("a message must be JSON") from None
    return check_event(message)


def picture_bytes(picture: Picture, *, png: bool) -> bytes:
    """Return a picture as a binary message."""
    height, width = picture.rgba.shape[:2]
    payload = png_bytes(picture.rgba[..., :3]) if png else memoryview(picture.rgba).cast("B")
    header = HEADER.pack(
        MAGIC,
        SECOND if picture.second else PICTURE,
        picture.frame & 0xFFFFFFFF,
        width,
        height,
        PNG if png else RAW,
        REFINED if picture.refined else 0,
        len(payload),
    )
    return b"".join((header, payload))


def file_bytes(saved: SavedFile) -> bytes:
    """Return a file as a binary message."""
    return HEADER.pack(MAGIC, FILE, 0, 0, 0, 0, 0, len(saved.data)) + saved.data
