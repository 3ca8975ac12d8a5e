from types import SimpleNamespace

import pytest

from splatline.sim.cosim.player import play


def job(*words):
    """A job of a frame whose parts have so many code words."""
    return SimpleNamespace(parts=[[SimpleNamespace(codewords=range(count)) for count in words]])


def test_the_share_of_the_code_words_taken_is_told(tmp_path):
    taken = tmp_path / "taken"
    share = play._share(taken, [job(40, 100), job(100)])
    with pytest.raises(OSError, match="taken"):  # not there yet
        share()
    shares = []
    for text in ("50", "120", "200"):
        taken.write_text(text)
        shares.append(share())
    assert shares == pytest.approx([0.25, 0.6, 1.0])
    taken.write_text("")  # just being written
    with pytest.raises(ValueError, match="''"):
        share()
