"""Mutants that are chosen well and judged rightly."""

import subprocess
import sys

import pytest

from tests.python_mutants.choose import choose, mutate, same
from tests.python_mutants.groups import GROUPS, ROOT

SOURCE = '''
import numba as nb
@nb.njit(cache=True)
def more(a: int | None, b: float) -> int | float:
    """Add."""
    c: int | float = a + b
    return c
'''


def test_what_does_not_run_is_not_told_apart():
    assert same(SOURCE, SOURCE.replace("|", "+").replace("True", "False"))
    assert not same(SOURCE, SOURCE.replace("a + b", "a - b"))


@pytest.mark.parametrize("group", GROUPS, ids=lambda group: group.name)
def test_mutants_of_a_group_are_of_its_files_and_change_them(group):
    mutants = choose(group, 12, seed=3)
    assert len(set(mutants)) == 12
    assert mutants == choose(group, 12, seed=3)
    assert mutants != choose(group, 12, seed=4)
    for mutant in mutants:
        assert mutant.file in group.files()
        original = (ROOT / mutant.file).read_text()
        changed = mutate(original, mutant)
        assert not same(original, changed)
        (line,) = {
            number
            for number, (one, other) in enumerate(
                zip(original.split("\n"), changed.split("\n"), strict=True), 1
            )
            if one != other
        }
        assert abs(line - mutant.line) <= 3


def test_each_group_has_files_and_tests():
    for group in GROUPS:
        assert len(group.files()) > 3
        assert all((ROOT / folder).is_dir() for folder in group.tests)


def test_a_wrong_group_or_count_is_told_in_a_line():
    for words, told in ((["gold"], "there is no group gold"), (["--count", "0"], "at least 1")):
        call = [sys.executable, "-m", "tests.python_mutants", *words]
        done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert told in done.stderr.splitlines()[-1]
