"""Compiled functions, kept in files that are checked before they are used.

numba's own cache trusts its files. A damaged one is a traceback or wrong machine code, and two
processes that compile two signatures of a function at once may swap their files. It knows the text
of a function's own file, not that of the functions and numbers that were compiled into it.
"""

from __future__ import annotations

import contextlib
import hashlib
import inspect
import pickle
import tempfile
import uuid
from collections.abc import Callable, Iterator
from functools import cache, cached_property
from pathlib import Path
from types import CodeType
from typing import Any, ClassVar

import numba
import numpy as np
from numba.core import caching
from numba.core.dispatcher import Dispatcher
from numba.core.serialize import dumps

__all__ = ["CheckedCache", "cached_njit"]

DIGEST = hashlib.sha256().digest_size

CONSTANTS = bool, int, float, complex, str, bytes, tuple, np.generic, np.dtype
"""Types of globals that are compiled into a function as they are; arrays are as well."""


def cached_njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return the decorator ``numba.njit`` with a cache of checked files, without Python's lock.

    Parameters
    ----------
    **options
        Of ``numba.njit``.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        compiled = numba.njit(nogil=True, **options)(function)
        compiled._cache = CheckedCache(compiled.py_func)
        return compiled

    return decorate


class _ScratchLocator(caching.InTreeCacheLocator):
    """A folder of this process alone, where no other can be written to: it compiles anew."""

    def get_cache_path(self) -> str:
        """Return the folder."""
        return _scratch().name


@cache
def _scratch() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="splatline-")


class _Files(caching.CompileResultCacheImpl):
    """The cached files of a function: their place and their contents."""

    _locator_classes: ClassVar = [
        caching.UserProvidedCacheLocator,
        caching.InTreeCacheLocator,
        caching.UserWideCacheLocator,
        _ScratchLocator,
    ]


class CheckedCache(caching.FunctionCache):
    """The cache of a function: a file a signature, named after it."""

    _impl_class = _Files

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._cache_file = _CheckedFile(Path(self._cache_path), self._impl.filename_base, function)

    def _save_overload(self, sig: Any, data: Any) -> None:
        """Save what was compiled, if there is room for it: it is used in any case."""
        with contextlib.suppress(OSError):
            super()._save_overload(sig, data)


class _CheckedFile:
    """Files that begin with a digest of all that they depend on, and of what is in them.

    A file that is damaged, or of other sources, another numba or another Splatline, has another
    digest. It is as if it were not there, and is replaced.
    """

    def __init__(self, folder: Path, name: str, function: Callable[..., Any]) -> None:
        self._folder, self._name, self._function = folder, name, function

    def load(self, key: object) -> Any:
        """Return what was saved under a key; None if there is nothing, or nothing whole."""
        try:
            data = self._path(key).read_bytes()
        except OSError:
            return None
        if data[:DIGEST] != self._digest(data[DIGEST:]):
            return None
        known, saved = pickle.loads(data[DIGEST:])
        return saved if known == key else None

    def save(self, key: object, data: object) -> None:
        """Save under a key, at once."""
        path = self._path(key)
        content = dumps((key, data))
        scratch = self._folder / f".{uuid.uuid4().hex}.nbc"
        try:
            scratch.write_bytes(self._digest(content) + content)
            scratch.replace(path)
        except BaseException:
            scratch.unlink(missing_ok=True)
            raise

    def flush(self) -> None:
        """Forget all that was saved."""
        for path in self._folder.glob(f"{self._name}.*.nbc"):
            path.unlink(missing_ok=True)

    def _path(self, key: object) -> Path:
        named = hashlib.sha256(repr(key).encode()).hexdigest()[:16]
        return self._folder / f"{self._name}.{named}.nbc"

    def _digest(self, content: bytes) -> bytes:
        return hashlib.sha256(self._stamp + content).digest()

    @cached_property
    def _stamp(self) -> bytes:
        """Digest of numba's version and of all that is compiled into the function."""
        parts = hashlib.sha256(numba.__version__.encode())
        for part in _compiled_into(self._function, set()):
            parts.update(part)
        return parts.digest()


def _compiled_into(function: Callable[..., Any], seen: set[object]) -> Iterator[bytes]:
    """Yield the text of a function's file, and its constants; then those of all that it calls."""
    seen.add(function)
    yield from _text_of(function, seen)
    for name, value in _globals_of(function):
        if isinstance(value, CONSTANTS):
            yield f"{name}={value!r}".encode()
        elif isinstance(value, np.ndarray):
            yield f"{name}={value.dtype}{value.shape}".encode() + value.tobytes()
        elif isinstance(value, Dispatcher) and value.py_func not in seen:
            yield from _compiled_into(value.py_func, seen)
        elif (defined := getattr(value, "_defn", None)) is not None and defined not in seen:
            yield from _compiled_into(defined, seen)  # an intrinsic of numba
        elif isinstance(value, type) and value.__module__.startswith("splatline"):
            yield from _text_of(value, seen)  # a named tuple


def _text_of(defined: Any, seen: set[object]) -> Iterator[bytes]:
    """Yield the digest of the file of a function or class, once."""
    file = inspect.getfile(defined)
    if file not in seen:
        seen.add(file)
        yield _digest_of(file)


@cache
def _digest_of(file: str) -> bytes:
    """Return the digest of a file's text: as it is when it is first asked for."""
    return hashlib.sha256(Path(file).read_bytes()).digest()


def _globals_of(function: Callable[..., Any]) -> Iterator[tuple[str, object]]:
    """Yield the name and value of each global that a function or one within it may use."""
    names = sorted(_names(function.__code__))
    for name in names:
        if name in function.__globals__:
            value = function.__globals__[name]
            yield name, value
            if inspect.ismodule(value) and value.__name__.startswith("splatline"):
                yield from ((each, vars(value)[each]) for each in names if each in vars(value))


def _names(code: CodeType) -> set[str]:
    """Return the names of globals and attributes in a code."""
    inner = (part for part in code.co_consts if isinstance(part, CodeType))
    return set(code.co_names).union(*map(_names, inner))
