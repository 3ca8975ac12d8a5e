"""Simulators that are kept: damaged ones are built anew, and a folder for them is needed."""

import pytest

from splatline.contract.errors import InputError
from splatline.sim.cosim.simulator import available, build

SOURCES = {
    "top.v": "module top(input clk, output reg q);\nalways @(posedge clk) q <= !q;\nendmodule\n"
}


@pytest.fixture
def cache(tmp_path, monkeypatch):
    if not available("icarus"):
        pytest.skip("iverilog is not installed")
    monkeypatch.setenv("SPLATLINE_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_a_damaged_simulator_is_built_anew(cache):
    def built():
        return build(SOURCES, "top", simulator="icarus")

    first = built()
    program = first.folder / "sim.vvp"
    whole = program.read_bytes()
    assert (first.reused, built().reused) == (False, True)
    for damage in (b"", whole[:-9], b"x" + whole[1:]):
        program.write_bytes(damage)
        again = built()
        assert (again.folder, again.reused) == (first.folder, False)
        assert (program.read_bytes()[:1], program.read_bytes()[-9:]) == (whole[:1], whole[-9:])
    program.unlink()
    assert (built().reused, built().reused) == (False, True)
    assert [path.name for path in (cache / "cosim").iterdir()] == [first.folder.name]


def test_a_simulator_whose_mark_is_cut_is_built_anew(cache):
    first = build(SOURCES, "top", simulator="icarus")
    (first.folder / "done").write_text("")
    assert not build(SOURCES, "top", simulator="icarus").reused


def test_a_folder_that_cannot_be_made_is_one_line(cache):
    cache.write_text("a file")
    with pytest.raises(InputError, match=r"no simulator can be built in .*: Not a directory;"):
        build(SOURCES, "top", simulator="icarus")
