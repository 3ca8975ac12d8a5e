import pytest

from splatline.flow.area.budgets import read_budgets
from splatline.flow.area.synth import DEVICE, PAPER_TABLE_1, group_instances
from tests.flow.area import counted


@pytest.fixture(scope="module")
def kept():
    """The report on ``paper``, and whether Yosys had to make it."""
    notes = []
    return counted.report_of_paper(lambda *note: notes.append(note)), notes


@pytest.fixture
def report(kept, record_property):
    report, notes = kept
    for note in notes:
        record_property(*note)
    return report


def test_the_paper_preset_fits_the_paper_s_device(report):
    assert report["fits"]
    for kind in ("lut4", "ff", "bram", "mult"):
        assert 0 < report[kind] <= DEVICE[kind]


def test_the_window_s_memory_is_block_ram_as_much_as_the_paper_s(report):
    assert report["bram"] == 17
    lanes = [counts for name, counts in report["modules"].items() if ".lane_" in name]
    assert [counts["bram"] for counts in lanes] == [1] * 16
    assert report["modules"]["colour.table"]["bram"] == 1


def test_the_paper_preset_keeps_to_its_budget(report):
    """A change that needs more says so: ``splatline synth --record``."""
    assert report["budget"] == read_budgets()["paper"]
    assert report["over_budget"] == {}


def test_the_difference_from_the_paper_is_that_of_its_table(report):
    assert report["difference"].keys() == PAPER_TABLE_1.keys()
    for kind, apart in report["difference"].items():
        assert report[kind] == PAPER_TABLE_1[kind] + apart["absolute"]
        assert report[kind] == pytest.approx(
            PAPER_TABLE_1[kind] * (1 + apart["percent"] / 100), 1e-3
        )


def test_the_longest_path_runs_between_signals_of_the_source(report):
    path = report["longest_path"]
    assert 5 <= path["levels"] <= path["luts"] + path["carries"] + path["multipliers"]
    ends = path["start"], path["end"]
    assert not any("$" in end for end in ends)
    assert any("." in end for end in ends), "neither lies in a part of the engine"


def test_the_modules_are_those_of_the_engine(report):
    names = set(report["modules"])
    parts = {"(top)", "tables", "sequencer", "colour", "tiler", "window"}
    assert parts <= names
    assert report["modules"]["colour"]["mult"] == report["mult"] == 6
    for kind in ("ff", "bram", "mult"):
        assert sum(counts[kind] for counts in report["modules"].values()) >= report[kind]


def test_the_groups_sum_up_what_the_instances_take(report):
    groups, modules = report["groups"], report["modules"]
    assert len(groups) < len(modules) == sum(group["instances"] for group in groups)
    for kind in ("lut4", "ff", "bram", "mult"):
        total = sum(counts[kind] for counts in modules.values())
        assert sum(group[kind] for group in groups) == total


def test_instances_of_one_name_share_a_row_and_others_do_not():
    one = {"lut4": 1, "ff": 2, "bram": 0, "mult": 0}
    names = ["bank_0.port_2", "bank_0.port_3", "bank_10.port_2", "lane_0_1", "lane_2_0", "part_4"]
    groups = group_instances(dict.fromkeys(names, one))
    assert [(group["name"], group["instances"], group["ff"]) for group in groups] == [
        ("bank_0..10.port_2..3", 3, 6), ("lane_0..2_0..1", 2, 4), ("part_4", 1, 2),
    ]  # fmt: skip


def test_a_report_of_other_verilog_is_made_again(monkeypatch):
    monkeypatch.setattr(counted.synth, "synthesise", lambda config: {"preset": config.name})
    monkeypatch.setattr(counted, "verilog", lambda *_: "module another; endmodule")
    notes = []
    made = counted.report_of_paper(lambda *note: notes.append(note))
    assert (made, notes) == ({"preset": "paper"}, [(counted.NOTE, "paper")])
