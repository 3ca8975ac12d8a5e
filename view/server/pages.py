"""The files of the page: a fixed list, read once."""

from __future__ import annotations

from importlib import resources
from typing import NamedTuple

__all__ = ["HEADERS", "INDEX", "PageFile", "page_files"]

INDEX = "index.html"

TYPES = {
    ".html": "text/html",
    ".css": "text/css",
    ".js": "text/javascript",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".ico": "image/x-icon",
    ".woff2": "font/woff2",
}
"""Types of the files that are served, by their suffix."""

HEADERS = {
    "Content-Security-Policy": "default-src 'self'; connect-src 'self' ws:;"
    " img-src 'self' blob: data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",  # the address has the token
    "Cache-Control": "no-store",
}
"""Headers of every answer."""


class PageFile(NamedTuple):
    """A file of the page: its type and its bytes."""

    mime: str
    data: bytes


def page_files() -> dict[str, PageFile]:
    """Return the files of the page by their names."""
    folder = resources.files("splatline.view") / "page"
    if not folder.is_dir():
        return {}
    found = {}
    for item in folder.iterdir():
        suffix = "." + item.name.rpartition(".")[2]
        if item.is_file() and suffix in TYPES:
            found[item.name] = PageFile(TYPES[suffix], item.read_bytes())
    return found
