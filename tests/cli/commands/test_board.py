"""``splatline board``: what it says where a board, a tool or a file is missing."""

import json
import shutil

import pytest

from splatline.cli.main import main
from splatline.contract.presets import RGB24
from splatline.host.frame_file import save_frame
from tests.support.fake_bus import DESCRIPTION, FakeBus
from tests.support.random_frames import frame_of, word


def run(capsys, *words):
    with pytest.raises(SystemExit) as end:
        main(["board", *map(str, words)])
    return end.value.code or 0, capsys.readouterr()


@pytest.fixture
def frame(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "one.frame"
    save_frame(frame_of([word([(0, 3)] * 4, 5, 7, config=RGB24)], 64, 64, config=RGB24), path)
    return path


def describe(path, **more):
    path.write_text(json.dumps({**DESCRIPTION, "board": "ulx3s", "link": "serial", **more}))
    return path


def test_frames_go_to_the_board_and_play(capsys, frame, tmp_path, monkeypatch):
    bus = FakeBus()
    monkeypatch.setattr("splatline.boards.uart_link.open_serial", lambda port, baud: bus)
    monkeypatch.setattr("time.sleep", lambda seconds: None)
    describe(tmp_path / "splatline_ulx3s_rgb24.json")
    code, said = run(capsys, "play", frame, frame, "--port", "/dev/x", "--hold", 2)
    assert code == 0
    assert "2 frames, 32 bytes, sent" in said.out
    assert (bus.value("player_frames"), bus.value("player_hold")) == (2, 2)
    assert (bus.value("player_enable"), bus.value("player_loop")) == (1, 1)
    assert bus.value("scanout_background") == 23 | 26 << 8 | 31 << 16


def test_without_a_description_it_is_asked_for(capsys, frame):
    code, said = run(capsys, "play", frame, "--port", "/dev/x")
    assert code == 2
    assert said.err.splitlines()[-1].startswith("splatline: --system must name the description")


def test_a_file_that_describes_no_board_is_refused(capsys, frame, tmp_path):
    for text, said in (("{}", "does not describe"), ("{", "is not valid JSON")):
        (tmp_path / "some.json").write_text(text)
        code, printed = run(capsys, "play", frame, "--port", "/dev/x", "--system", "some.json")
        assert code == 2
        assert said in printed.err


def test_the_loader_is_asked_for_in_one_line(capsys, tmp_path, monkeypatch):
    describe(tmp_path / "some.json")
    code, said = run(capsys, "load", tmp_path / "some.bit")
    assert (code, said.err.count("\n")) == (2, 1)
    assert "make it: splatline board build ulx3s" in said.err
    (tmp_path / "some.bit").write_bytes(b"bits")
    monkeypatch.setattr(shutil, "which", lambda program: None)
    code, said = run(capsys, "load", tmp_path / "some.bit")
    assert (code, said.err.count("\n")) == (2, 1)
    assert "apt-get install openfpgaloader" in said.err


@pytest.mark.parametrize(("code", "expected"), [(0, 0), (3, 1)])
def test_the_loader_runs(capsys, tmp_path, monkeypatch, code, expected):
    describe(tmp_path / "some.json")
    (tmp_path / "some.bit").write_bytes(b"bits")
    program = tmp_path / "openFPGALoader"
    program.write_text(f"#!/bin/sh\necho no cable for $2\nexit {code}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    got, said = run(capsys, "load", tmp_path / "some.bit")
    assert got == expected
    assert ("openFPGALoader failed: no cable for ulx3s" in said.err) == bool(code)


def test_litex_is_asked_for_in_one_line(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    code, said = run(capsys, "build", "ulx3s")
    assert code == 2
    assert said.err.splitlines()[-1] == (
        "splatline: a board's system needs litex: pip install '.[board]' in Splatline's folder"
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--program", "a.bin"], "--program needs --cpu"),
        (["--program", "b.bin", "--cpu", "serv"], "cannot read b.bin"),
        (["--program", "a.bin", "--cpu", "serv"], "a.bin has 8196 bytes, and the ROM has 8192"),
        (["--program", "c.bin", "--cpu", "serv"], "c.bin has 0 bytes, and the ROM has 8192"),
    ],
)
def test_a_program_that_does_not_fit_is_said_in_one_line(
    capsys, tmp_path, monkeypatch, words, said
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.bin").write_bytes(bytes(8196))
    (tmp_path / "c.bin").write_bytes(b"")
    code, printed = run(capsys, "build", "ulx3s", *words)
    assert code == 2
    assert said in printed.err.splitlines()[-1]


def test_a_processor_that_is_not_installed_is_named(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: "pythondata" not in name or None)
    code, printed = run(capsys, "build", "ulx3s", "--cpu", "vexriscv")
    assert code == 2
    assert "needs pythondata_cpu_vexriscv: pip install '.[board-cpu]'" in printed.err
