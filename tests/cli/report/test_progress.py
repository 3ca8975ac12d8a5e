import time

import pytest

from splatline.cli.report import progress
from splatline.cli.report.progress import Stages


def test_a_stage_is_timed_and_said_on_standard_error(capsys):
    stages = Stages()
    with stages.stage("nap", "Taking a [short] nap"):
        time.sleep(0.02)
    assert set(stages.seconds) == {"nap"}
    assert 0.02 <= stages.seconds["nap"] < 2.0
    assert capsys.readouterr() == ("", "Taking a [short] nap ...\n")


def test_a_stage_without_a_name_is_not_timed():
    stages = Stages()
    with stages.stage("", "Something that times itself"):
        pass
    assert stages.seconds == {}


def test_a_stage_that_fails_is_not_timed():
    stages = Stages()
    with pytest.raises(OSError, match="no"), stages.stage("nap", "Failing"):
        raise OSError("no")
    assert stages.seconds == {}


def test_a_terminal_gets_a_bar_that_leaves_no_trace_on_standard_output(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")  # rich takes it for a terminal
    with Stages().stage("nap", "Working"):
        pass
    said = capsys.readouterr()
    assert said.out == ""
    assert "Working" in said.err
    assert "..." not in said.err


@pytest.fixture
def clock(monkeypatch):
    """A clock that stands still until it is set, with a look at every tell."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "perf_counter", lambda: now[0])
    return now


def test_a_slow_stage_says_its_share_at_each_quarter_and_never_goes_back(capsys, clock):
    with Stages().stage("read", "Reading") as share:
        for second, done in enumerate((0.1, 0.3, 0.55, 0.2, 0.56, 0.8, 0.9, 1.0), 1):
            clock[0] = float(second)
            share(done)
    assert capsys.readouterr().err.splitlines() == [
        "Reading ...", " 55 %  Reading ...", " 80 %  Reading ..."
    ]  # fmt: skip


def test_a_quick_stage_says_no_share(capsys, clock):
    with Stages().stage("read", "Reading") as share:
        for step in range(100):
            clock[0] = 0.029 * step
            share(step / 100)
    assert capsys.readouterr().err == "Reading ...\n"


def test_stages_in_one_block_begin_when_they_are_told(capsys, clock):
    stages = Stages()
    with stages.stages({"read": "Reading", "normals": "Estimating"}) as tell:
        clock[0] = 2.0
        tell("read", 0.9)
        clock[0] = 3.0
        tell("normals", 0.0)
        clock[0] = 7.0
        tell("normals", 0.5)
        clock[0] = 8.0
    assert stages.seconds == {"read": 3.0, "normals": 5.0}
    assert capsys.readouterr().err.splitlines() == [
        "Reading ...", "Estimating ...", " 50 %  Estimating ..."
    ]  # fmt: skip


def test_a_stage_that_is_never_told_has_no_time():
    stages = Stages()
    with stages.stages({"read": "Reading", "normals": "Estimating"}):
        pass
    assert set(stages.seconds) == {"read"}
    with pytest.raises(OSError, match="no"), stages.stages({"other": "Failing"}):
        raise OSError("no")
    assert set(stages.seconds) == {"read"}


def test_a_terminal_s_bar_has_the_share(capsys, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setattr(progress, "EVERY", 0.0)
    with Stages().stage("nap", "Working") as share:
        share(0.37)
    assert "37%" in capsys.readouterr().err
