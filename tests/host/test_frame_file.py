import dataclasses
import json

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.frame_file import describe_frame, load_frame, save_frame, sidecar_path
from splatline.host.pipeline import make_frame
from splatline.host.visibility.view import fit_view
from tests.support.clouds import sphere


@pytest.fixture
def frame():
    cloud = sphere(300)
    return make_frame(cloud, fit_view(cloud, size=(40, 30)), radii=np.full(300, 0.1))


@pytest.fixture
def saved(frame, tmp_path):
    path = tmp_path / "frame.words"
    save_frame(frame, path)
    return path


def test_a_frame_comes_back_as_it_was(frame, saved):
    back = load_frame(saved)
    assert (back.codewords == frame.codewords).all()
    assert (back.width, back.height, back.config) == (40, 30, frame.config)
    for name in ("ambient", "diffuse", "specular"):
        assert (getattr(back.tables, name) == getattr(frame.tables, name)).all()
    assert back.counts["elements"] == frame.counts["elements"]


def test_the_view_is_told_beside_the_words(frame, tmp_path):
    view = fit_view(sphere(300), size=(40, 30))
    moved = dataclasses.replace(view, shift=(np.float32(0.25), -1))
    save_frame(frame, tmp_path / "a.words", view=moved)
    found = json.loads(sidecar_path(tmp_path / "a.words").read_text())["view"]
    assert found["shift"] == [0.25, -1.0]
    assert found["eye"] == view.eye.tolist()
    assert (found["focal"], found["width"], found["height"]) == (view.focal, 40, 30)


def test_the_words_on_disk_are_little_endian(frame, saved):
    assert np.array_equal(np.fromfile(saved, "<u8"), frame.codewords)


def test_a_frame_s_description_counts_its_words(frame):
    found = describe_frame(frame)
    kinds = ("control_words", "symmetric_words", "fraction_words")
    assert sum(found[kind] for kind in kinds) == found["codewords"] == len(frame.codewords)
    assert found["materials"] == 3
    assert 0 <= found["x_range"][0] <= found["x_range"][1] < 40


def edit(path, **changes):
    beside = sidecar_path(path)
    beside.write_text(json.dumps({**json.loads(beside.read_text()), **changes}))


def flip(path):
    data = path.read_bytes()
    path.write_bytes(bytes([data[0] ^ 1]) + data[1:])


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda path: path.unlink(), "cannot read"),
        (lambda path: sidecar_path(path).unlink(), "which tells what frame.words needs"),
        (lambda path: path.write_bytes(path.read_bytes()[:-3]), "not whole 64-bit words"),
        (lambda path: path.write_bytes(path.read_bytes()[:-8]), "end-of-frame"),
        (lambda path: path.write_bytes(b""), "end-of-frame"),
        (lambda path: flip(path), "frame.words is not what .*json describes; encode the frame"),
        (lambda path: sidecar_path(path).write_text("{"), "not valid JSON"),
        (lambda path: sidecar_path(path).write_text("[]"), "does not describe a frame"),
        (lambda path: edit(path, version=1), "version 1; this Splatline reads 2; encode the frame"),
        (lambda path: edit(path, version=99), "version 99"),
        (lambda path: edit(path, width=0), "a width of 0"),
        (lambda path: edit(path, height="tall"), "a height of 'tall'"),
        (lambda path: edit(path, config={"depth_bits": 99}), "depth_bits"),
        (lambda path: edit(path, config={"lanes": True, "banks": 8}), "'lanes'.*encode the frame"),
        (lambda path: edit(path, tables={}), "damaged"),
        (lambda path: edit(path, counts=[1]), "the counts"),
        (
            lambda path: edit(
                path,
                tables={
                    "ambient": [0, 0, 1 << 18],
                    "diffuse": [[0] * 3] * 128,
                    "specular": [[0] * 3] * 128,
                },
            ),
            "the table 'ambient' has values",
        ),
    ],
)
def test_damage_is_named_in_one_line(saved, damage, message):
    damage(saved)
    with pytest.raises(InputError, match=message) as caught:
        load_frame(saved)
    assert "\n" not in str(caught.value)


def test_a_sidecar_of_an_older_splatline_has_no_checksum(saved):
    beside = sidecar_path(saved)
    described = json.loads(beside.read_text())
    whole = load_frame(saved)
    del described["crc32"]
    beside.write_text(json.dumps(described))
    assert (load_frame(saved).codewords == whole.codewords).all()
