"""Compiled functions round as IEEE 754 says: the same wherever and however they are compiled.

Where LLVM may contract, reorder or divide otherwise, a function from numba's cache and the same one
compiled in this process give different last bits, and so do two machines.
"""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SAFE = {"nsz"}
BOUNDS = {"host/visibility/groups.py", "host/visibility/quick_test.py"}
"""Their results are bounds with a margin for rounding; exact tests decide what is close."""


def flags_of(source):
    """Return the fastmath flags that a module's text asks for."""
    calls = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call))
    words = (word for call in calls for word in call.keywords if word.arg == "fastmath")
    values = [ast.literal_eval(word.value) for word in words]
    return {flag for value in values for flag in (["all"] if value is True else value or [])}


def test_flags_are_found():
    assert flags_of("@nb.njit(fastmath={'nsz', 'arcp'})\ndef f(): pass") == {"nsz", "arcp"}
    assert flags_of("@nb.njit(fastmath=True)\ndef f(): pass") == {"all"}
    assert flags_of("@nb.njit(cache=True)\ndef f(): pass") == set()


@pytest.mark.parametrize("room", ["host", "sim", "view"])
def test_no_result_depends_on_how_it_was_compiled(room):
    for file in sorted((ROOT / room).rglob("*.py")):
        if file.relative_to(ROOT).as_posix() not in BOUNDS:
            assert flags_of(file.read_text(encoding="utf-8")) <= SAFE, file
