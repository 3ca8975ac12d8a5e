import json
import os
from pathlib import Path

import pytest

from splatline.cli.options.outputs import check_files, check_folder, require_suffix, write_json
from splatline.contract.errors import InputError


def test_files_in_a_folder_that_is_there_are_fine(tmp_path):
    (tmp_path / "old.png").write_bytes(b"old")
    check_files(
        (tmp_path / "old.png", None, tmp_path / "new.json"), inputs=[tmp_path / "a.ply", None]
    )


@pytest.mark.parametrize(
    ("outputs", "message"),
    [
        (["absent/a.png"], "there is no folder absent"),
        (["taken"], "is a folder"),
        (["file/a.png"], "there is no folder file"),
        (["a.png", "b.png", "./a.png"], "two outputs"),
        (["cloud.ply"], "over the input"),
        (["link.ply"], "over the input"),
    ],
)
def test_a_file_that_cannot_be_written_is_refused(tmp_path, monkeypatch, outputs, message):
    monkeypatch.chdir(tmp_path)
    Path("taken").mkdir()
    Path("file").write_text("")
    Path("cloud.ply").write_text("")
    Path("link.ply").symlink_to("cloud.ply")
    with pytest.raises(InputError, match=message):
        check_files(map(Path, outputs), inputs=[Path("cloud.ply")])


def test_a_folder_that_is_read_only_is_refused(tmp_path, monkeypatch):
    # As root every folder is writable, so the system's answer is given here.
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(InputError, match="not writable"):
        check_files([tmp_path / "a.png"])
    with pytest.raises(InputError, match="not writable"):
        check_folder(tmp_path / "new")


def test_a_folder_may_be_new_and_is_not_created_by_the_check(tmp_path):
    check_folder(tmp_path / "a" / "b")
    check_folder(tmp_path)
    check_folder(None)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["file", "file/below"])
def test_a_folder_cannot_take_the_place_of_a_file(tmp_path, name):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="a file"):
        check_folder(tmp_path / name)


def test_the_name_must_promise_what_is_written():
    require_suffix(None, ".png")
    require_suffix(Path("a.PNG"), ".png")
    with pytest.raises(InputError, match=r"a\.jpg: the name must end in \.png"):
        require_suffix(Path("a.jpg"), ".png")


def test_json_is_written_whole_or_not_at_all(tmp_path):
    path = tmp_path / "a.json"
    write_json(path, {"one": 1})
    assert json.loads(path.read_text()) == {"one": 1}
    with pytest.raises(ValueError, match="JSON compliant"):
        write_json(path, {"bad": float("nan")})
    assert json.loads(path.read_text()) == {"one": 1}
    assert list(tmp_path.iterdir()) == [path]
