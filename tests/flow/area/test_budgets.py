import pytest

from splatline.contract.presets import PRESETS
from splatline.contract.variants import SHAPED
from splatline.flow.area import budgets
from splatline.flow.area.synth import DEVICE, PAPER_TABLE_1
from splatline.flow.tops import TOPS
from tests.flow.area import counted
from tests.flow.area.counted import counts_of


def test_every_preset_has_a_budget():
    """``splatline synth --preset NAME --record`` gives it one."""
    tops = {budgets.budget_name("paper", top) for top in TOPS}
    assert set(budgets.read_budgets()) == {*PRESETS, *(config.name for config in SHAPED), *tops}


def test_24_bit_colour_takes_no_more_block_ram():
    """It fills what the lanes' memories leave empty, and so does the material table."""
    assert budgets.read_budgets()["rgb24"]["bram"] == PAPER_TABLE_1["bram"]


# The paper preset is synthesised in test_synth.py, with all there is to say of it.
@pytest.mark.parametrize("preset", sorted(set(PRESETS) - {"paper"}))
def test_a_preset_takes_exactly_its_budget(preset, record_property):
    """A change that needs more or less says so: ``splatline synth --preset NAME --record``."""
    counts = counts_of(PRESETS[preset], note=record_property)
    assert counts == budgets.read_budgets()[preset]


def test_the_paper_s_engine_on_its_pins_takes_no_more_than_the_paper_s(record_property):
    """Nor more than its budget."""
    counts = counts_of(PRESETS["paper"], "pins", record_property)
    assert budgets.over_budget(counts, PAPER_TABLE_1) == {}
    recorded = budgets.read_budgets()[budgets.budget_name("paper", "pins")]
    assert budgets.over_budget(counts, recorded) == {}


def test_the_engine_on_its_buses_keeps_to_its_budget_and_fits(record_property):
    counts = counts_of(PRESETS["paper"], "axi", record_property)
    recorded = budgets.read_budgets()[budgets.budget_name("paper", "axi")]
    assert budgets.over_budget(counts, recorded) == {}
    assert all(counts[kind] <= DEVICE[kind] for kind in counts)


def test_the_engine_with_a_frame_buffer_keeps_to_its_budget(record_property):
    counts = counts_of(PRESETS["paper"], "framebuffer", record_property)
    recorded = budgets.read_budgets()[budgets.budget_name("paper", "framebuffer")]
    assert budgets.over_budget(counts, recorded) == {}


def test_what_is_over_budget_is_told_by_how_much():
    counts = {"lut4": 105, "ff": 9, "bram": 2, "mult": 1}
    allowed = {"lut4": 100, "ff": 9, "bram": 3, "mult": 0}
    assert budgets.over_budget(counts, allowed) == {"lut4": 5, "mult": 1}
    assert budgets.over_budget(counts, None) == {}


def test_a_record_changes_one_preset_s_line(tmp_path, monkeypatch):
    book = tmp_path / "budgets.json"
    monkeypatch.setattr(budgets, "BUDGETS", book)
    assert budgets.read_budgets() == {}
    budgets.record("rgb24", {"lut4": 7})
    budgets.record("paper", {"lut4": 5})
    budgets.record("rgb24", {"lut4": 6})
    assert book.read_text() == '{\n  "paper": {"lut4": 5},\n  "rgb24": {"lut4": 6}\n}\n'
    assert budgets.read_budgets() == {"paper": {"lut4": 5}, "rgb24": {"lut4": 6}}


@pytest.mark.parametrize(("config", "more"), [(SHAPED[0], 4), (SHAPED[1], 27)])
def test_an_engine_with_its_rom_takes_exactly_its_budget(config, more, record_property):
    """The smaller ROM fits the paper's device."""
    counts = counts_of(config, note=record_property)
    assert counts == budgets.read_budgets()[config.name]
    assert counts["bram"] - budgets.read_budgets()["paper"]["bram"] == more
    over = budgets.over_budget(counts, {kind: DEVICE[kind] for kind in counts})
    assert bool(over) == (config is SHAPED[1])


def test_what_changed_is_counted_and_nothing_else(tmp_path, monkeypatch):
    """Another Verilog, another budget: Yosys is asked again."""
    config = PRESETS["rgb24"]
    budget = budgets.read_budgets()["rgb24"]
    book = tmp_path / "counted.json"
    monkeypatch.setattr(counted, "DIGESTS", book)
    monkeypatch.setattr(counted.synth, "count_engine", lambda *engine: engine)
    monkeypatch.setattr(counted, "verilog", lambda *_: "module one; endmodule")
    book.write_text(f'{{"rgb24": "{counted.digest(config, "engine", budget)}"}}')
    notes = []
    assert counts_of(config, note=lambda *note: notes.append(note)) == budget
    assert not notes
    swift = counts_of(PRESETS["swift"], note=lambda *note: notes.append(note))
    assert swift == (PRESETS["swift"], "engine")
    assert notes == [(counted.NOTE, "swift")]
    with monkeypatch.context() as patch:
        patch.setattr(counted, "verilog", lambda *_: "module another; endmodule")
        assert counts_of(config) == (config, "engine")
    monkeypatch.setattr(budgets, "read_budgets", lambda: {"rgb24": {**budget, "lut4": 9999}})
    assert counts_of(config) == (config, "engine")
