import json

import pytest

from splatline.sim.cosim.faults import __main__ as command
from splatline.sim.cosim.faults.page import write_page
from splatline.sim.cosim.faults.tally import Tally, from_json, to_json

TALLY = Tally(trials=5, frames=9, words=1234, cycles=5, silence=7, nearest=0.255)
UPSETS = Tally(trials=3)
UPSETS.outcomes.update({("tiler", "register", "right"): 2, ("tiler", "memory", "not cleared"): 1})


def test_tallies_survive_json():
    for tally in (TALLY, UPSETS):
        assert from_json(json.loads(json.dumps(to_json(tally)))) == tally


def test_a_page_keeps_its_text_and_the_other_presets(tmp_path):
    page = tmp_path / "faults.md"
    page.write_text("above\n<!-- tables -->\nold\n<!-- end of tables -->\nbelow\n")
    write_page(tmp_path, "swift", {"stalls": TALLY, "upsets": UPSETS}, seed=4)
    write_page(tmp_path, "paper", {"stalls": TALLY}, seed=5)
    text = page.read_text()
    assert text.startswith("above\n")
    assert text.endswith("below\n")
    assert "old" not in text
    assert "| swift | stalls | 5 | 9 | 1,234 | 5 | 7 | 0.26 | 0 |" in text
    assert "|  | `tiler` | 2 | 2 |" in text
    assert "Seeds: paper: 5, swift: 4." in text


class Counted:
    """A campaign that counts what it plays."""

    class model:  # noqa: N801
        name = "player"

    def __init__(self, config, seed, *, top):
        self.seed, self.top = seed, top

    def play(self, kind, numbers, total):
        PLAYED.append(len(numbers))
        if len(PLAYED) == 5:
            raise KeyboardInterrupt
        wrong = ["streams 7: wrong"] if kind == "streams" and 7 in numbers else []
        return Tally(trials=len(numbers), wrong=wrong)


PLAYED: list[int] = []


def test_a_campaign_that_was_stopped_goes_on_and_tells_what_is_wrong(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(command, "Campaign", Counted)
    folders = ["--kept", str(tmp_path), "--docs", str(tmp_path)]
    monkeypatch.setattr("sys.argv", ["faults", "--count", "3000", *folders])
    with pytest.raises(KeyboardInterrupt):
        command.main()
    assert command.main() == 1
    assert sum(PLAYED) - PLAYED[4] == 3000
    assert "streams 7: wrong\npaper: 3000 trials, 1 wrong" in capsys.readouterr().out


def test_bad_options_are_one_line(monkeypatch):
    monkeypatch.setattr("sys.argv", ["faults", "--preset", "papr"])
    with pytest.raises(command.InputError, match="no preset named 'papr'"):
        command.main()
