import pytest

from splatline.rtl.format import PAPER, PRESETS
from splatline.rtl.material_table import MaterialTable
from splatline.rtl.planar_bank import PlanarBank
from splatline.rtl.synth import DEVICE, count_component, synthesise


@pytest.fixture(scope="module")
def report():
    return synthesise(PAPER)


def test_the_paper_preset_fits_the_paper_s_device(report):
    assert report["fits"]
    for kind in ("lut4", "ff", "bram", "mult"):
        assert 0 < report[kind] <= DEVICE[kind]


def test_every_memory_is_block_ram_as_the_paper_lays_them_out(report):
    assert report["bram"] == 17
    assert report["cells"]["RAMB16_S36_S36"] == 17
    banks = [counts for name, counts in report["modules"].items() if ".bank_" in name]
    assert [counts["bram"] for counts in banks] == [2] * 8
    assert report["modules"]["colour.table"]["bram"] == 1


def test_a_preset_does_not_outgrow_its_budget(report):
    """Recorded in November 2026; a change that needs more has to say so here."""
    budget = {"lut4": 2520, "ff": 960, "bram": 17, "mult": 6}
    assert {kind: report[kind] for kind in budget if report[kind] > budget[kind]} == {}


def test_the_modules_are_those_of_the_engine(report):
    names = set(report["modules"])
    parts = {"(top)", "tables", "sequencer", "colour", "decoder", "window"}
    assert parts <= names
    assert report["modules"]["colour"]["mult"] == report["mult"] == 6
    for kind in ("ff", "bram", "mult"):
        assert sum(counts[kind] for counts in report["modules"].values()) >= report[kind]


@pytest.mark.parametrize("preset", ["rgb18", "rgb24"])
def test_more_colour_takes_no_more_block_ram(preset):
    """The planes fill what the banks' memories leave empty, and so does the material table."""
    config = PRESETS[preset]
    assert count_component(PlanarBank(config))["bram"] == 2
    assert count_component(MaterialTable(config))["bram"] == 1
