"""Binary PLY files by rows; the files are written by plyfile."""

import dataclasses
import functools

import numpy as np
import plyfile
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.ply_rows import ply_rows
from splatline.host.files.source import open_source
from splatline.host.large import pieces, plan
from splatline.host.large.draw_parts import Drawing, draw_parts, frames_of
from splatline.host.large.plan import Part, make_plan
from splatline.host.visibility.view import fit_view
from tests.host.large.test_draw_parts import hills

COUNT = 30_000
FACES = np.array([([0, 1, 2],), ([3, 4, 5],)], [("vertex_indices", "i4", (3,))])


def write_ply(path, *, order="<", text=False, before=(), after=(), **columns):
    positions, colours = hills(COUNT, 3)
    positions = positions - positions.mean(axis=0)
    columns = {
        **dict(zip("xyz", positions.T.astype(np.float32), strict=True)),
        **(columns or dict(zip(("red", "green", "blue"), (colours.T >> 8).astype(np.uint8),
                               strict=True))),
    }  # fmt: skip
    rows = np.empty(COUNT, [(name, column.dtype) for name, column in columns.items()])
    for name, column in columns.items():
        rows[name] = column
    elements = [*before, plyfile.PlyElement.describe(rows, "vertex"), *after]
    plyfile.PlyData(elements, text=text, byte_order=order).write(str(path))
    return path


def faces(name="face"):
    return plyfile.PlyElement.describe(FACES, name)


def plan_of(path):
    return make_plan([path], None, functools.partial(fit_view, size=(96, 80), up="z"), 64)


def picture(settled):
    joined = draw_parts(settled, Drawing())
    (frame,) = frames_of(settled, Drawing(), joined)
    return frame, joined


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("kind", ["colours", "intensity", "nothing", "normals"])
def test_pieces_are_the_picture_of_the_whole_file(tmp_path, monkeypatch, order, kind):
    monkeypatch.setattr(pieces, "PIECE", 7_000)
    ramp = np.linspace(0, 1, COUNT, dtype=np.float32)
    columns = {
        "colours": {},
        "intensity": {"intensity": ramp},
        "nothing": {"other": ramp},
        "normals": {"nx": ramp, "ny": 1 - ramp, "nz": 1 + 0 * ramp},
    }[kind]
    # The whole is read as a text, whose values are the same.
    by_rows, whole = (
        plan_of(write_ply(tmp_path / f"a{text}.ply", order=order, text=text, **columns))
        for text in (False, True)
    )
    assert [part.stop for part in by_rows.parts] == [None]
    frame, joined = picture(by_rows)
    settled = dataclasses.replace(by_rows, files=whole.files)
    assert len(list(by_rows.files[0].pieces())) == 5
    assert len(list(settled.files[0].pieces())) == 1
    other, of_whole = picture(settled)
    assert joined.points == COUNT
    assert joined.elements > 1000
    if kind != "intensity":  # greys of a whole file are by its own range
        assert np.array_equal(frame.codewords, other.codewords)
    assert joined.dropped == of_whole.dropped
    assert set(joined.used) >= {"x", "y", "z"}


def test_parts_are_ranges_of_rows(tmp_path, monkeypatch):
    monkeypatch.setattr(plan, "PART_POINTS", 8_000)
    settled = plan_of(write_ply(tmp_path / "a.ply", after=[faces()]))
    assert len(settled.parts) == 4
    frame, joined = picture(settled)
    assert joined.points == COUNT
    whole, _ = picture(dataclasses.replace(settled, parts=(Part(0),)))
    assert len(frame.codewords) == pytest.approx(len(whole.codewords), rel=0.2)


@pytest.mark.parametrize(
    ("options", "by_rows"),
    [
        ({}, True),
        ({"after": [faces()]}, True),
        ({"before": [faces()]}, False),
        ({"text": True}, False),
        (
            {
                name: np.ones(COUNT, np.float32)
                for name in (
                    *(f"f_dc_{i}" for i in range(3)),
                    "opacity",
                    *(f"scale_{i}" for i in range(3)),
                    *(f"rot_{i}" for i in range(4)),
                )
            },
            False,
        ),
    ],
    ids=["plain", "faces behind", "faces before", "text", "gaussians"],
)
def test_which_files_have_rows_of_one_length(tmp_path, options, by_rows):
    with open_source(write_ply(tmp_path / "a.ply", **options)) as source:
        rows = ply_rows(source)
    assert (rows is not None) == by_rows
    assert rows is None or rows.points == COUNT


def test_a_file_cut_after_the_plan_is_one_line(tmp_path):
    path = write_ply(tmp_path / "a.ply")
    settled = plan_of(path)
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(InputError, match=r"a\.ply: (ends|promises|.*damaged)"):
        draw_parts(settled, Drawing())
