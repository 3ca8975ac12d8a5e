"""Compiled functions whose files are damaged, old, shared or nowhere."""

import importlib
import os
import sys

import numpy as np
import pytest

from splatline.host import compiled_cache
from splatline.host.compiled_cache import cached_njit

INNER = """
import numba
FACTOR = 3
@numba.njit
def inner(a):
    return a + 1
"""
OUTER = """
from splatline.host.compiled_cache import cached_njit
from inner_of_test import FACTOR, inner
@cached_njit()
def outer(a):
    return inner(a) * FACTOR
"""


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Return a function that imports the two modules anew, as another process would."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def load(inner=INNER, outer=OUTER):
        for name, text in (("inner_of_test", inner), ("outer_of_test", outer)):
            (tmp_path / f"{name}.py").write_text(text)
            monkeypatch.delitem(sys.modules, name, raising=False)
        compiled_cache._digest_of.cache_clear()
        importlib.invalidate_caches()
        return importlib.import_module("outer_of_test").outer

    yield load
    for name in ("inner_of_test", "outer_of_test"):
        sys.modules.pop(name, None)


def hits(function):
    """Return how often a function was taken from its files."""
    return sum(function.stats.cache_hits.values())


def files(folder):
    return sorted((folder / "__pycache__").iterdir())


def cut(data):
    return data[: len(data) // 2]


def flip(data):
    return data[:-200] + bytes([data[-200] ^ 4]) + data[-199:]


DAMAGES = {
    "empty": lambda data: b"",
    "cut": cut,
    "a bit": flip,
    "in its digest": lambda data: bytes([data[0] ^ 1]) + data[1:],
    "any bytes": lambda data: np.random.default_rng(1).bytes(len(data)),
}


def test_a_function_is_taken_from_its_file(load, tmp_path):
    assert (load()(2), len(files(tmp_path))) == (9, 1)
    again = load()
    assert (again(2), hits(again)) == (9, 1)
    assert (again(2.5), hits(again), len(files(tmp_path))) == (10.5, 1, 2)


def test_a_damaged_file_is_as_if_it_were_not_there(load, tmp_path):
    load()(2)
    (file,) = files(tmp_path)
    whole = file.read_bytes()
    for name, damage in DAMAGES.items():
        file.write_bytes(damage(whole))
        compiled = load()
        assert (compiled(2), hits(compiled)) == (9, 0), name
        assert len(file.read_bytes()) > len(whole) // 2, name
    again = load()
    assert (again(2), hits(again)) == (9, 1)
    assert files(tmp_path) == [file]


def test_what_is_compiled_in_counts_though_it_is_of_another_file(load):
    assert load()(2) == 9
    assert load(inner=INNER.replace("a + 1", "a + 2"))(2) == 12
    assert load(inner=INNER.replace("FACTOR = 3", "FACTOR = 4"))(2) == 12
    assert load(outer=OUTER.replace("FACTOR\n", "7\n"))(2) == 21
    assert load()(2) == 9


def test_another_numba_does_not_take_it(load, monkeypatch):
    load()(2)
    monkeypatch.setattr("numba.__version__", "0.0.1")
    compiled = load()
    assert (compiled(2), hits(compiled)) == (9, 0)


def test_two_signatures_saved_at_once_are_not_mixed_up(load, tmp_path, monkeypatch):
    """The second process saves all of its own between the first one's steps."""
    one, other = load(), load()
    write = type(tmp_path).write_bytes

    def interrupted(path, data):
        monkeypatch.setattr(type(tmp_path), "write_bytes", write)
        assert other(2.5) == 10.5
        return write(path, data)

    monkeypatch.setattr(type(tmp_path), "write_bytes", interrupted)
    assert one(2) == 9
    later = load()
    assert (later(2), later(2.5), hits(later)) == (9, 10.5, 2)


def test_a_full_disk_is_no_error(load, tmp_path, monkeypatch):
    def full(path, data):
        path.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(type(tmp_path), "write_bytes", full)
    assert load()(2) == 9
    assert not files(tmp_path)


def test_where_nothing_can_be_written_the_files_are_those_of_a_process(load, tmp_path, monkeypatch):
    def refuse(path, **_):
        if not os.fspath(path).startswith(compiled_cache._scratch().name):
            raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "makedirs", refuse)
    compiled = load()
    assert compiled(2) == 9
    assert compiled._cache.cache_path == compiled_cache._scratch().name
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "inner_of_test.py",
        "outer_of_test.py",
    ]


def test_flushed_files_are_gone(load, tmp_path):
    compiled = load()
    compiled(2)
    compiled._cache.flush()
    assert not files(tmp_path)


def test_options_are_numba_s():
    @cached_njit(error_model="numpy")
    def share(a, b):
        return a / b

    assert share(1.0, 0.0) == np.inf
    assert share.targetoptions["nogil"]
