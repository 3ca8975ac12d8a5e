"""Files written whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from splatline.contract.errors import InputError

__all__ = ["atomic_stream", "atomic_write", "tell_unwritable"]


def atomic_write(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file at once; see :func:`atomic_stream`.

    Parameters
    ----------
    path
        Path of the file; its folder must exist.
    data
        The whole content.

    Raises
    ------
    InputError
        If the file cannot be written; an older file of that name is untouched.
    """
    with atomic_stream(path) as stream, tell_unwritable(path):
        stream.write(data)


@contextlib.contextmanager
def atomic_stream(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Write a temporary file in the same folder, then rename it when the block has ended.

    A reader finds the old content or the new, never a part. A link keeps its target, and an old
    file keeps its permissions. A pipe or device such as ``/dev/stdout`` is written to directly. If
    the block raises, nothing is left behind.

    Parameters
    ----------
    path
        Path of the file; its folder must exist.

    Raises
    ------
    InputError
        If the file cannot be made or renamed; an older file of that name is untouched. Errors of
        the block's own writing are as they are; see :func:`tell_unwritable`.
    """
    with contextlib.ExitStack() as stack:
        with tell_unwritable(path):
            target = Path(os.path.realpath(path))
            is_special = target.exists() and not target.is_file() and not target.is_dir()
            stream = stack.enter_context(_direct(target) if is_special else _replacing(target))
        yield stream
        with tell_unwritable(path):
            stack.close()


@contextlib.contextmanager
def tell_unwritable(path: str | os.PathLike[str]) -> Iterator[None]:
    """Convert the system's errors in the block to ``InputError``: the file cannot be written."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{Path(path)}: cannot be written: {error.strerror or error}") from None


@contextlib.contextmanager
def _direct(target: Path) -> Iterator[IO[bytes]]:
    """Write to a pipe or device; an error of the block is not hidden by one of the last bytes."""
    stream = target.open("wb")
    try:
        yield stream
    except BaseException:
        with contextlib.suppress(OSError):
            stream.close()
        raise
    stream.close()


@contextlib.contextmanager
def _replacing(target: Path) -> Iterator[IO[bytes]]:
    """Write a temporary file in the target's folder and rename it; leave nothing behind."""
    mode = target.stat().st_mode & 0o777 if target.is_file() else 0o666 & ~_umask()
    if target.is_file() and not os.access(target, os.W_OK):
        # A rename would ignore the write protection of the file itself.
        raise PermissionError(None, "the file is write-protected")
    descriptor, name = tempfile.mkstemp(prefix=f".{target.name[:64]}.", dir=target.parent)
    beside = Path(name)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            yield stream
            stream.flush()
            # Without this, a crash of the machine after the rename can leave an empty file.
            os.fsync(stream.fileno())
        beside.chmod(mode)
        beside.replace(target)
    except BaseException:  # also on Ctrl-C
        with contextlib.suppress(OSError):
            beside.unlink()
        raise


def _umask() -> int:
    """Return the process's mask for new files, which can be read only by setting it."""
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
