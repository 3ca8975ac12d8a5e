"""What ``survey`` says of files of every format."""

import gzip
import json

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.files import survey as module
from splatline.host.files.survey import survey
from tests.host.files.e57_files import colours, coordinates, e57, pose
from tests.host.files.kinds import (
    COLOURS,
    SPHERE,
    XYZ_PCD,
    XYZ_PLY,
    compressed_pcd,
    pcd,
    ply,
    ptx,
    text,
)
from tests.host.files.las_files import COUNT as LAS_COUNT
from tests.host.files.las_files import las, laz, places_of
from tests.host.files.test_colour_by import CLASS, FORMATS, INTENSITY, NAMES, QUALITY, RGB, files

COUNT = len(SPHERE)
VALUES = dict(zip(NAMES, (INTENSITY, CLASS, QUALITY), strict=True))
NORMALS_PLY = ["float nx", "float ny", "float nz"]


@pytest.fixture(params=FORMATS)
def path(request, tmp_path):
    content = dict(files())[request.param]
    place = tmp_path / request.param
    place.write_bytes(content if isinstance(content, bytes) else content.encode())
    return place


def put(folder, name, content):
    place = folder / name
    place.write_bytes(content if isinstance(content, bytes) else content.encode())
    return place


def by_name(facts):
    return {field["name"]: field for field in facts["fields"]}


def test_every_format_has_fields_with_ranges_and_an_extent(path):
    facts = survey(path)
    json.dumps(facts, allow_nan=False)
    assert facts["format"].startswith({".txt": "TXT"}.get(path.suffix, path.suffix[1:].upper()))
    assert facts["points"] == COUNT
    np.testing.assert_allclose(facts["low"], SPHERE.min(axis=0), atol=1e-6)
    np.testing.assert_allclose(facts["high"], SPHERE.max(axis=0), atol=1e-6)
    np.testing.assert_allclose(facts["extent"], np.ptp(SPHERE, axis=0), atol=1e-6)
    assert 0.1 < facts["splat_size"] < 1.0
    assert (facts["estimated_normals"], facts["far_from_the_rest"]) == (COUNT, 0)
    assert facts["colours"] == 3
    fields = by_name(facts)
    for name, column in VALUES.items():
        assert fields[name]["low"] == pytest.approx(column.min(), abs=1e-5)
        assert fields[name]["high"] == pytest.approx(column.max(), abs=1e-5)
        assert (fields[name]["not_finite"], fields[name]["used_as"]) == (0, None)
    assert facts["columns_ignored"] == list(NAMES)
    for name, column in zip(RGB, COLOURS.T, strict=True):
        assert (fields[name]["low"], fields[name]["high"]) == (column.min(), column.max())
        assert fields[name]["used_as"] == "colour"


def test_the_header_alone_tells_fields_and_what_they_are_taken_for(path):
    whole, header = survey(path, "full"), survey(path, "header")
    json.dumps(header, allow_nan=False)
    for key in ("format", "columns_used", "columns_ignored"):
        assert header[key] == whole[key]
    assert header.keys() == whole.keys()
    assert [(f["name"], f["type"], f["used_as"]) for f in header["fields"]] == [
        (f["name"], f["type"], f["used_as"]) for f in whole["fields"]
    ]
    assert all(f["low"] is None for f in header["fields"])
    assert header["splat_size"] is header["low"] is None
    assert header["points"] == COUNT + (path.suffix in (".csv", ".txt"))  # lines of a text
    assert "see --full" in header["notes"][0]


def test_a_large_file_is_read_on_request_alone(path, monkeypatch):
    monkeypatch.setattr(module, "_limit", lambda listing, suffix: 100)
    assert survey(path) == survey(path, "header")
    assert survey(path, "full")["splat_size"] is not None


def test_limits_follow_the_format(tmp_path):
    limits = {}
    for name, content in {**dict(files()), "a.laz": laz(las(6)), "a.las": las(6)}.items():
        place = put(tmp_path, name, content)
        with module.open_cloud_file(place) as source:
            limits[name] = module._limit(module._listing(source), source.suffix)
    assert limits["a.ply"] == limits["a.pcd"] == limits["a.las"] == 1 << 28
    assert limits["t.ply"] == limits["t.pcd"] == limits["a.csv"] == limits["a.laz"] == 1 << 24
    assert limits["a.npz"] == 1 << 26


def test_types_are_those_of_the_file(tmp_path):
    names = ["double x", "float y", "float z", "uchar red", "uchar green", "uchar blue"]
    facts = survey(put(tmp_path, "a.ply", ply(names, [*SPHERE.T, *COLOURS.T])))
    assert [field["type"] for field in facts["fields"]] == [
        "float64", "float32", "float32", "uint8", "uint8", "uint8",
    ]  # fmt: skip
    facts = survey(put(tmp_path, "a.pcd", compressed_pcd()))
    assert facts["format"] == "PCD, binary, compressed"
    assert by_name(facts)["pair"]["type"] == "2 x float32"
    assert (by_name(facts)["pair"]["low"], by_name(facts)["pair"]["high"]) == (1 - COUNT, COUNT - 1)
    np.savez(tmp_path / "a.npz", points=SPHERE, flags=np.ones(COUNT, bool), odd=np.ones((2, 3)))
    fields = by_name(survey(tmp_path / "a.npz"))
    assert fields["points"]["type"] == "float64, shape 60 x 3"
    assert fields["flags"]["type"] == "bool, shape 60"
    assert fields["odd"]["low"] is None


def test_values_that_are_not_finite_are_counted_and_left_out(tmp_path):
    values = QUALITY.copy()
    values[[3, 4, 5]] = np.nan, np.inf, -np.inf
    nothing = np.full(COUNT, np.nan)
    columns = [*SPHERE.T, values, nothing]
    facts = survey(put(tmp_path, "a.ply", ply([*XYZ_PLY, "float q", "float none"], columns)))
    field = by_name(facts)["q"]
    assert field["not_finite"] == 3
    kept = np.delete(QUALITY, [3, 4, 5]).astype(np.float32)
    assert (field["low"], field["high"]) == (kept.min(), kept.max())
    none = by_name(facts)["none"]
    assert (none["low"], none["high"], none["not_finite"]) == (None, None, COUNT)
    json.dumps(facts, allow_nan=False)


def test_positions_that_are_dropped_and_strays_are_counted(tmp_path):
    places = np.vstack([SPHERE, [[np.nan, 0, 0], [0, 1e6, 0]]])
    facts = survey(put(tmp_path, "a.xyz", text(places)))
    assert (facts["points"], facts["dropped"]) == (COUNT + 1, {"non_finite": 1})
    assert facts["far_from_the_rest"] == 1
    assert facts["high"][1] == 1e6


def test_columns_without_names_are_numbered(tmp_path):
    place = put(tmp_path, "a.xyz", text(SPHERE, INTENSITY))
    facts = survey(place)
    assert [field["name"] for field in facts["fields"]] == [f"column {i}" for i in (1, 2, 3, 4)]
    assert by_name(facts)["column 4"]["high"] == 900.0
    assert by_name(facts)["column 1"]["used_as"] == "position"
    header = survey(place, "header")
    assert header["points"] == COUNT
    assert [field["used_as"] for field in header["fields"]] == [None] * 4
    np.save(tmp_path / "a.npy", np.column_stack([SPHERE, INTENSITY]))
    assert by_name(survey(tmp_path / "a.npy"))["column 4"]["low"] == 100.0
    assert survey(tmp_path / "a.npy", "header")["points"] == COUNT


@pytest.mark.parametrize("end", ["", "\n"])
def test_a_last_line_without_an_end_counts(tmp_path, end):
    place = put(tmp_path, "a.xyz", text(SPHERE).rstrip("\n") + end)
    assert survey(place, "header")["points"] == COUNT


def test_the_count_of_a_pts_file_is_the_headers(tmp_path):
    place = put(tmp_path, "a.pts", f"{COUNT}\n" + text(SPHERE, INTENSITY, COLOURS))
    assert survey(place, "header")["points"] == survey(place)["points"] == COUNT


@pytest.mark.parametrize("row", [0, 5])
def test_words_in_a_column_that_is_not_used_are_no_error(tmp_path, row):
    lines = [f"{i},{i % 2},2,{'tree' if i == row else i}\n" for i in range(9)]
    facts = survey(put(tmp_path, "a.csv", "x,y,z,kind\n" + "".join(lines)))
    assert facts["points"] == 9
    assert by_name(facts)["kind"]["low"] is None
    assert by_name(facts)["kind"]["type"] == ("words" if row == 0 else "number")


def test_words_further_down_are_no_error_in_another_encoding(tmp_path):
    lines = [f"{i},{i % 2},2,{'tree' if i == 5 else i}\n" for i in range(9)]
    content = ("x,y,z,kind\n" + "".join(lines)).encode("utf-16")
    assert survey(put(tmp_path, "a.csv", content))["points"] == 9


def test_other_elements_of_a_mesh_are_told(tmp_path):
    content = ply(XYZ_PLY, SPHERE.T, kind="ascii").decode()
    content = content.replace("end_header", "element face 2\nproperty list uchar int i\nend_header")
    place = put(tmp_path, "a.ply", content + "3 0 1 2\n3 3 4 5\n")
    assert survey(place)["other_elements"] == "2 face"


def test_a_compressed_file_and_one_in_capitals(tmp_path):
    content = ply(XYZ_PLY, SPHERE.T)
    for name in ("a.ply.gz", "B.PLY"):
        data = gzip.compress(content) if name.endswith("gz") else content
        facts = survey(put(tmp_path, name, data))
        assert (facts["points"], facts["format"]) == (COUNT, "PLY, binary, little endian")


@pytest.mark.parametrize("pack", [bytes, laz])
def test_las_tells_its_extent_by_the_header(tmp_path, pack):
    place = put(tmp_path, "a.laz" if pack is laz else "a.las", pack(las(7)))
    header, whole = survey(place, "header"), survey(place)
    assert header["format"] == f"{'LAZ' if pack is laz else 'LAS'} 1.4, point format 7"
    assert header["points"] == whole["points"] == LAS_COUNT
    for facts in (header, whole):
        np.testing.assert_allclose(facts["low"], places_of().min(axis=0), atol=1e-6)
        np.testing.assert_allclose(facts["high"], places_of().max(axis=0), atol=1e-6)
        assert (facts["system"], facts["created"]) == ("hand", "2026, day 1")
    assert by_name(whole)["intensity"]["high"] == 100 * (LAS_COUNT - 1)
    assert by_name(whole)["gps_time"]["type"] == "float64"
    assert by_name(header)["red"]["used_as"] == "colour"


def test_a_format_without_a_header_of_its_own_is_read(tmp_path, monkeypatch):
    monkeypatch.delitem(module.HEADERS, ".ply")
    place = put(tmp_path, "a.ply", ply([*XYZ_PLY, "float q"], [*SPHERE.T, QUALITY]))
    for depth in ("quick", "header", "full"):
        facts = survey(place, depth)
        assert facts["points"] == COUNT
        assert facts["format"] == "PLY"
        assert [field["name"] for field in facts["fields"]] == ["x", "y", "z", "q"]
        assert by_name(facts)["q"]["high"] == pytest.approx(QUALITY.max())


@pytest.mark.parametrize("depth", ["quick", "header", "full"])
@pytest.mark.parametrize("name", ["a.ply", "a.pcd", "a.npz", "a.npy", "a.las", "a.laz", "a.xyz"])
def test_what_is_no_such_file_gets_one_line_with_its_name(tmp_path, name, depth):
    place = put(tmp_path, name, b"\x01\x02\x00junk" * 30)
    with pytest.raises(InputError, match=name) as caught:
        survey(place, depth)
    assert "\n" not in str(caught.value)


def test_the_progress_has_two_stages(tmp_path):
    told = []
    place = put(tmp_path, "a.pcd", pcd(XYZ_PCD, SPHERE.T))
    survey(place, progress=lambda stage, share: told.append(stage))
    assert list(dict.fromkeys(told)) == ["read", "spacing"]


def test_a_format_may_be_given(tmp_path):
    place = put(tmp_path, "scan.dat", text(SPHERE))
    assert survey(place, format="xyz")["points"] == COUNT
    assert survey(place, "header", format="xyz")["format"].startswith("XYZ, text")


def test_an_unknown_depth_is_refused():
    with pytest.raises(InputError, match="one of quick, header, full"):
        survey("a.ply", "deep")


QUARTER = pose((0.5**0.5, 0.0, 0.0, 0.5**0.5), (100.0, 0.0, 7.0))
"""A quarter of a turn about z, then a move."""

BOX = (
    '<cartesianBounds type="Structure">'
    + "".join(
        f'<{axis}{end} type="Float">{value}</{axis}{end}>'
        for end, values in (("Minimum", (-1, -2, -3)), ("Maximum", (4, 5, 6)))
        for axis, value in zip("xyz", values, strict=True)
    )
    + "</cartesianBounds>"
)


def test_the_header_of_an_e57_tells_scans_points_fields_and_boxes(tmp_path):
    rows = coordinates(SPHERE, "d") | colours(COLOURS)
    scans = [rows | {"pose": QUARTER + BOX}, coordinates(SPHERE, "S") | {"pose": BOX}]
    facts = survey(put(tmp_path, "a.e57", e57(*scans)), "header")
    assert (facts["format"], facts["points"], facts["scans"]) == ("E57", 2 * COUNT, "2")
    types = {field["name"]: field["type"] for field in facts["fields"]}
    assert types["cartesianX"] == "float64"
    assert types["colorRed"] == "integer"
    # The first box is turned: x' = 100 - y, y' = x.
    assert facts["low"] == pytest.approx([-1.0, -2.0, -3.0])
    assert facts["high"] == pytest.approx([102.0, 5.0, 13.0])
    assert "wider than their points" in facts["bounds"]
    bare = survey(put(tmp_path, "b.e57", e57(rows, scans[0])), "header")
    assert bare["low"] is None


def test_the_header_of_an_e57_does_not_read_its_points(tmp_path, monkeypatch):
    place = put(tmp_path, "a.e57", e57(coordinates(SPHERE, "d")))
    whole = survey(place)
    monkeypatch.setattr(module, "read_columns", None)
    header = survey(place, "header")
    assert header["points"] == whole["points"] == COUNT
    assert [f["name"] for f in header["fields"]] == [f["name"] for f in whole["fields"]]


def test_the_headers_of_a_ptx_tell_scans_and_points(tmp_path, monkeypatch):
    content = ptx(SPHERE, np.full(COUNT, 0.5), COLOURS) + ptx(SPHERE, np.full(COUNT, 0.5))
    place = put(tmp_path, "a.ptx", content)
    monkeypatch.setattr(module, "read_columns", None)
    facts = survey(place, "header")
    assert (facts["points"], facts["scans"]) == (2 * COUNT, "2")
    assert [f["name"] for f in facts["fields"]] == [
        "x", "y", "z", "intensity", "red", "green", "blue",
    ]  # fmt: skip
    cut = put(tmp_path, "b.ptx", content[: len(content) // 3])
    with pytest.raises(InputError, match=r"b\.ptx: ends after"):
        survey(cut, "header")
