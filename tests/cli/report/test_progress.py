import time

import pytest

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
