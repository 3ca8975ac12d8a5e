"""Compiled functions release Python's lock, so that threads draw at once."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def holders(source):
    """Return the lines of a module's text that compile what Python calls, and hold the lock."""
    calls = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call))
    found = ((call.lineno, {word.arg for word in call.keywords}) for call in calls)
    return [line for line, words in found if "cache" in words and "nogil" not in words]


def test_a_function_that_holds_the_lock_is_found():
    assert holders("@nb.njit(cache=True)\ndef f(): pass") == [1]
    assert holders("@nb.njit(cache=True, nogil=True)\ndef f(): pass") == []


@pytest.mark.parametrize("room", ["host", "sim", "view"])
def test_no_compiled_function_holds_the_lock(room):
    for file in sorted((ROOT / room).rglob("*.py")):
        assert holders(file.read_text(encoding="utf-8")) == [], file
