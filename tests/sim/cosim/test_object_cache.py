"""Verilator's run-time library is compiled once, and a design's own files always."""

from pathlib import Path

import pytest

from splatline.sim.cosim import object_cache
from splatline.sim.cosim.object_cache import main

COMPILER = """#!/bin/sh
echo "$*" >> {runs}
for word; do last=$word; done
grep -q broken "$last" && exit 3
while [ "$1" != -o ]; do shift; done
cat "$last" > "$2"
"""


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """Return a call ``(source, *flags)`` that gives exit code, object and runs of the compiler."""
    runs = tmp_path / "runs"
    compiler = tmp_path / "c++"
    compiler.write_text(COMPILER.format(runs=runs))
    compiler.chmod(0o755)
    (tmp_path / "include").mkdir()
    (tmp_path / "include" / "verilated.mk").write_text("")
    monkeypatch.chdir(tmp_path)

    def call(source, *flags):
        target = tmp_path / "out.o"
        target.unlink(missing_ok=True)
        command = [str(compiler), *flags, "-c", "-o", str(target), str(source)]
        status = main(tmp_path / "kept", command)
        text = target.read_text() if target.exists() else None
        return status, text, len(runs.read_text().splitlines())

    return call


def test_a_file_of_the_library_is_compiled_once_for_each_text_and_flags(bench, tmp_path):
    source = tmp_path / "include" / "verilated.cpp"
    source.write_text("one")
    assert bench(source) == (0, "one", 1)
    assert bench(source) == (0, "one", 1)
    assert bench(source, "-O0") == (0, "one", 2)
    source.write_text("two")
    assert bench(source) == (0, "two", 3)
    assert bench(source, "-O0") == (0, "two", 4)


def test_a_damaged_object_is_compiled_anew(bench, tmp_path):
    source = tmp_path / "include" / "verilated.cpp"
    source.write_text("one")
    bench(source)
    (kept,) = (tmp_path / "kept").iterdir()
    for runs, damage in enumerate((b"", kept.read_bytes()[:-1], kept.read_bytes() + b"e"), 2):
        kept.write_bytes(damage)
        assert bench(source) == (0, "one", runs)
        assert bench(source) == (0, "one", runs)


def test_a_file_of_the_design_is_compiled_each_time(bench, tmp_path):
    source = tmp_path / "Vtop.cpp"
    source.write_text("top")
    assert bench(source) == (0, "top", 1)
    assert bench(source) == (0, "top", 2)


def test_headers_are_compiled_once_for_designs_without_optimisation(bench, tmp_path):
    source = tmp_path / "Vtop.cpp"
    source.write_text("top")
    assert bench(source, "-O0", "-I.") == (0, "top", 2)
    assert bench(source, "-I.", "-O0") == (0, "top", 3)
    *_, last = (tmp_path / "runs").read_text().splitlines()
    header = last.split()[1]
    assert last.startswith(f"-include {tmp_path}/kept/")
    assert "verilated.h" in Path(header).read_text()
    assert Path(f"{header}.gch").read_text() == Path(header).read_text()


def test_headers_that_do_not_compile_are_left_out(bench, tmp_path, monkeypatch):
    monkeypatch.setattr(object_cache, "HEADERS", "broken")
    source = tmp_path / "Vtop.cpp"
    source.write_text("top")
    assert bench(source, "-O0") == (0, "top", 2)
    assert "-include" not in (tmp_path / "runs").read_text()


def test_what_does_not_compile_is_not_kept(bench, tmp_path):
    source = tmp_path / "include" / "verilated.cpp"
    source.write_text("broken")
    assert bench(source) == (3, None, 1)
    assert bench(source) == (3, None, 2)
    assert not (tmp_path / "kept").exists()
