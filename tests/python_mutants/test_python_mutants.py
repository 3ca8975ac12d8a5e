"""Mutants that are chosen well and judged rightly."""

import json
import subprocess
import sys

import pytest

from tests.python_mutants import page
from tests.python_mutants.choose import change, choose, mutate, places, same
from tests.python_mutants.equal import EQUAL
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
        lines = zip(original.split("\n"), changed.split("\n"), strict=True)
        (line,) = {n for n, (one, other) in enumerate(lines, 1) if one != other}
        assert change(mutant) == tuple(
            text.split("\n")[line - 1].strip() for text in (original, changed)
        )
        assert abs(line - mutant.line) <= 3


def test_each_group_has_files_and_tests():
    for group in GROUPS:
        assert len(group.files()) > 3
        assert all((ROOT / place).exists() for place in group.tests)


def test_a_wrong_group_or_count_is_told_in_a_line():
    for words, told in ((["gold"], "there is no group gold"), (["--count", "0"], "at least 1")):
        call = [sys.executable, "-m", "tests.python_mutants", *words]
        done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert told in done.stderr.splitlines()[-1]


def test_the_page_leaves_out_what_is_equal_and_tells_what_misses_the_goal(tmp_path, monkeypatch):
    monkeypatch.setattr(page, "EQUAL", {("a.py", "x = 1 | 0"): "0 changes nothing."})
    place = {"file": "a.py", "line": 3, "before": "x = 1", "after": "x = 1 | 0"}
    for group in GROUPS:
        verdicts = [{**place, "verdict": "noticed"}] * 5 + [{**place, "verdict": "survived"}]
        if group.name == "golden":
            verdicts += [{**place, "after": "x = 2", "verdict": "survived"}]
        (tmp_path / f"{group.name}-1.json").write_text(json.dumps(verdicts))
    told = page.write_page(tmp_path, tmp_path / "page.md")
    assert told == ["golden: 83% are noticed, not 85%"]
    text = (tmp_path / "page.md").read_text()
    assert "| 1 | 7 | 5 | 0 | 1 | 1 | 83% | 85% |" in text
    assert text.count("| `a.py` | 3 | `x = 1` | `x = 1 \\| 0` | 0 changes nothing. |") == 4
    assert "| `a.py` | 3 | `x = 1` | `x = 2` |  |" in text


def test_reasons_are_of_lines_that_are_there():
    for (file, after), reason in EQUAL.items():
        assert after in {change(mutant)[1] for mutant in places(file)}, (file, after)
        assert reason.endswith(".")
