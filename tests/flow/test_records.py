"""Recorded figures: a row is replaced, and a file that cannot be written is as it was."""

import json

import pytest

from splatline.contract.errors import InputError
from splatline.flow.records import read_records, record_row


def test_a_row_is_replaced_and_rows_are_lines_in_order(tmp_path):
    file = tmp_path / "a.json"
    assert read_records(file) == {}
    for name, value in (("b", 1), ("a", 2), ("b", 3)):
        record_row(file, name, {"n": value})
    assert file.read_text() == '{\n  "a": {"n": 2},\n  "b": {"n": 3}\n}\n'
    assert read_records(file) == json.loads(file.read_text())


def test_a_full_disk_leaves_the_file_as_it_was(tmp_path, monkeypatch):
    file = tmp_path / "a.json"
    record_row(file, "a", {"n": 1})
    before = file.read_bytes()

    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(InputError, match="No space left"):
        record_row(file, "b", {"n": 2})
    assert file.read_bytes() == before
    assert list(tmp_path.iterdir()) == [file]
