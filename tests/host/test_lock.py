"""Compiled functions release Python's lock, so that threads draw at once, and are kept checked."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def kept_by_numba(source):
    """Return the lines of a module's text where numba's own cache would keep a function."""
    calls = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call))
    return [call.lineno for call in calls if "cache" in {word.arg for word in call.keywords}]


def test_a_function_that_numba_would_keep_is_found():
    assert kept_by_numba("@nb.njit(cache=True)\ndef f(): pass") == [1]
    assert kept_by_numba("@cached_njit(parallel=True)\ndef f(): pass") == []


@pytest.mark.parametrize("room", ["host", "sim", "view"])
def test_every_function_that_is_kept_is_checked_and_releases_the_lock(room):
    """``cached_njit`` does both; see ``tests/host/test_compiled_cache.py``."""
    for file in sorted((ROOT / room).rglob("*.py")):
        assert kept_by_numba(file.read_text(encoding="utf-8")) == [], file
