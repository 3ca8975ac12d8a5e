"""Verilog that is kept between runs."""

import pytest

from splatline.contract.presets import PAPER, RGB24
from splatline.sim.cosim import kept_verilog
from splatline.sim.cosim.kept_verilog import kept, parts_of_build


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("SPLATLINE_CACHE", str(tmp_path))
    return tmp_path / "verilog"


def texts(*answers):
    """Return a function that gives the next of some texts, and fails after the last."""
    rest = list(answers)
    return lambda: rest.pop(0)


def test_what_was_written_once_is_read_again(folder):
    write = texts("module a;\nendmodule\n")
    assert kept("engine", PAPER, write) == kept("engine", PAPER, write) == "module a;\nendmodule\n"
    assert [file.name.partition("-")[0] for file in folder.iterdir()] == ["engine"]


def test_each_kind_and_each_configuration_has_its_own(folder):
    write = texts("a", "b", "c")
    asked = [("engine", PAPER), ("engine", RGB24), ("axi", PAPER)]
    assert [kept(*key, write) for key in asked] == ["a", "b", "c"]
    assert [kept(*key, write) for key in asked] == ["a", "b", "c"]


@pytest.mark.parametrize("change", [lambda b: b[:-1], lambda b: b"", lambda b: b + b"\xff"])
def test_a_damaged_file_is_written_again(folder, change):
    write = texts("module a;", "module a;")
    kept("engine", PAPER, write)
    (file,) = folder.iterdir()
    whole = file.read_bytes()
    file.write_bytes(change(whole))
    assert kept("engine", PAPER, write) == "module a;"
    assert file.read_bytes() == whole


def test_other_sources_write_other_verilog(folder, monkeypatch):
    write = texts("old", "new")
    kept("engine", PAPER, write)
    monkeypatch.setattr(kept_verilog, "_digest_of_sources", lambda: "other")
    assert kept("engine", PAPER, write) == "new"


def test_each_source_counts(tmp_path, monkeypatch):
    """A file of a folder in a folder changes, then its name."""
    (tmp_path / "rtl" / "lib").mkdir(parents=True)
    file = tmp_path / "rtl" / "lib" / "mux.py"
    monkeypatch.setattr(kept_verilog.resources, "files", lambda package: tmp_path / "rtl")
    digests = []
    for text, name in [("a", "mux.py"), ("b", "mux.py"), ("b", "choose.py"), ("b", "mux.pyc")]:
        file.unlink(missing_ok=True)
        file = file.with_name(name)
        file.write_text(text)
        kept_verilog._digest_of_sources.cache_clear()
        digests.append(kept_verilog._digest_of_sources())
    kept_verilog._digest_of_sources.cache_clear()
    assert len(set(digests)) == 4


def test_where_nothing_can_be_kept_it_is_written_each_time(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SPLATLINE_CACHE", str(tmp_path / "file"))
    write = texts("a", "a")
    assert [kept("engine", PAPER, write) for _ in range(2)] == ["a", "a"]


def test_writing_and_building_share_one_progress():
    told = []
    writing, building = parts_of_build(told.append)
    writing(1.0), building(0.0), building(1.0)
    assert told == [pytest.approx(share) for share in (0.2, 0.2, 1.0)]
    assert parts_of_build(None) == (None, None)
