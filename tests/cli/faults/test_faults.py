"""A sample of the campaign, and faults of the program that it must notice."""

import json

import pytest

from tests.cli.faults.__main__ import main
from tests.cli.faults.compiled import damaged_functions, shared_functions
from tests.cli.faults.forker import Forker
from tests.cli.faults.inputs import corrupted_frames
from tests.cli.faults.page import BEGIN, END, write_page
from tests.cli.faults.trials import KINDS, Bench

COMMANDS = ("encode", "film gif", "registers")
TRIALS = 4

WRITES_AT_ONCE = """
import contextlib
from splatline.contract import atomic_write

@contextlib.contextmanager
def direct(target):
    with target.open("wb") as stream:
        yield stream

atomic_write._replacing = direct
"""

HAS_A_TRACEBACK = """
from splatline.cli import main
main._file_trouble = None
main.InputError = ZeroDivisionError
"""


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    folder = tmp_path_factory.mktemp("faults")
    with Forker(("encode", "film gif")) as forker:
        yield Bench(forker, folder, COMMANDS)


@pytest.mark.parametrize("kind", KINDS)
def test_files_are_whole_and_errors_are_a_line(bench, kind):
    outcomes = [bench.play(KINDS[kind], seed) for seed in range(TRIALS)]
    if kind == "killed at any time":  # on a busy machine a run may end before its time
        more = (bench.play(KINDS[kind], seed) for seed in range(TRIALS, 50))
        while "killed" not in {outcome for outcome, _ in outcomes}:
            outcomes.append(next(more))
    assert [wrong for _, wrong in outcomes if wrong] == []
    assert {"refused", "killed"} & {outcome for outcome, _ in outcomes} or kind == "little memory"


@pytest.mark.parametrize(
    ("planted", "kinds", "told"),
    [
        (WRITES_AT_ONCE, ("full disk", "killed in a write"), "is not whole"),
        (HAS_A_TRACEBACK, ("full disk",), "ends with 1"),
    ],
    ids=["writes at once", "has a traceback"],
)
def test_a_planted_fault_is_noticed(tmp_path, planted, kinds, told):
    with Forker((), planted) as forker:
        bench = Bench(forker, tmp_path, ("registers",))
        for kind in kinds:
            wrong = [bench.play(KINDS[kind], seed)[1] for seed in range(TRIALS)]
            assert any(told in each for each in wrong), wrong


def test_frames_and_compiled_functions_that_are_damaged_are_refused_or_right(tmp_path):
    found = [
        *corrupted_frames(range(100), tmp_path),
        *damaged_functions(range(5), tmp_path),
        *shared_functions(range(1), tmp_path),
    ]
    assert [wrong for _, wrong in found if wrong] == []
    assert sum(outcome == "refused" for outcome, _ in found) > 50


def test_a_campaign_goes_on_and_tells_what_is_wrong(tmp_path, monkeypatch, capsys):
    played = []

    def play(numbers, folder):
        played.extend(numbers)
        return [("done", "7: wrong" if number == 7 else "") for number in numbers]

    monkeypatch.setattr("tests.cli.faults.__main__.plays", lambda _: {"views": (play, 1.0)})
    (tmp_path / "faults.md").write_text(f"above\n{BEGIN}\nold\n{END}\nbelow\n")
    for count in (5, 9):
        kept = str(tmp_path / "host.json")
        words = ["faults", "--count", str(count), "--docs", str(tmp_path), "--kept", kept]
        monkeypatch.setattr("sys.argv", words)
        assert main() == (count == 9)
    assert played == list(range(9))
    assert "7: wrong\nhost: 9 trials, 1 wrong\n" in capsys.readouterr().out
    text = (tmp_path / "faults.md").read_text()
    assert text.startswith("above\n")
    assert text.endswith("below\n")
    assert "| views | 9 | 9 |  |  | 1 |" in text
    assert "old" not in text


def test_a_page_has_what_came_of_each_kind(tmp_path):
    (tmp_path / "faults.md").write_text(f"{BEGIN}\n{END}")
    write_page(tmp_path, {"full disk": {"outcomes": {"done": 1200, "killed": 3}, "wrong": []}})
    assert "| full disk | 1,203 | 1,200 |  | 3 | 0 |" in (tmp_path / "faults.md").read_text()
    assert json.loads((tmp_path / "host_faults.json").read_text())["tools"]["numba"]
