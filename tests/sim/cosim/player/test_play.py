import time
from types import SimpleNamespace

import pytest

from splatline.sim.cosim.player import play


def job(*words):
    """A job of a frame whose parts have so many code words."""
    return SimpleNamespace(parts=[[SimpleNamespace(codewords=range(count)) for count in words]])


def test_the_share_of_the_code_words_taken_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr(play, "LOOK", 0.001)
    told = []
    taken = tmp_path / "taken"
    with play._watched(taken, [job(40, 100), job(100)], told.append):
        for text in ("", "50", "120", "250"):
            taken.write_text(text)
            deadline = time.monotonic() + 5.0
            while text and min(1.0, int(text) / 200) not in told and time.monotonic() < deadline:
                time.sleep(0.001)
    count = len(told)
    assert list(dict.fromkeys(told)) == pytest.approx([0.25, 0.6, 1.0])
    time.sleep(0.02)
    assert len(told) == count


def test_a_failed_simulation_is_watched_no_more(tmp_path):
    with pytest.raises(OSError, match="no"), play._watched(tmp_path / "a", [job(1)], print):
        raise OSError("no")
