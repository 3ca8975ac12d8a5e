"""Texts as programs and people write them."""

import gzip

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.read_text import _names
from splatline.host.files.readers import read_cloud
from tests.host.files.kinds import (
    COLOURS,
    COUNT,
    SPHERE,
    assert_coloured,
    assert_sphere,
    read,
    text,
)

ROWS = text(SPHERE, form="%.5f").splitlines(keepends=True)


def test_a_line_with_the_count_is_skipped(tmp_path):
    intensity = np.arange(COUNT) - 2000
    counted = f"{COUNT}\n" + text(SPHERE, intensity, COLOURS)
    for name in ("a.pts", "a.txt", "a.xyz", "a.asc"):
        assert_coloured(read(tmp_path, name, counted))
    named = f"//X;Y;Z;Rf;Gf;Bf;Illuminance (PCV)\n{COUNT}\n"
    named += text(SPHERE, COLOURS / 255.0, np.full(COUNT, 0.5), delimiter=";")
    cloud = read(tmp_path, "a.txt", named)
    assert_coloured(cloud)
    assert cloud.ignored == ("Illuminance (PCV)",)


def test_a_second_scan_with_its_count_is_read_too(tmp_path):
    content = "20\n" + "".join(ROWS[:20]) + f"{COUNT - 20}\n" + "".join(ROWS[20:])
    assert_sphere(read(tmp_path, "a.pts", content))


def test_fewer_points_than_the_count_are_an_error(tmp_path):
    with pytest.raises(InputError, match="ends after 60 of its 61 points; it is truncated"):
        read(tmp_path, "a.pts", f"{COUNT + 1}\n" + "".join(ROWS))


@pytest.mark.parametrize("quote", ['"', "'"])
def test_quoted_values(tmp_path, quote):
    names = ",".join(f"{quote}{name}{quote}" for name in "XYZRGB")
    content = names + "\n" + text(SPHERE, COLOURS, delimiter=",", form=f"{quote}%.9g{quote}")
    assert_coloured(read(tmp_path, "a.csv", content))
    plain = text(SPHERE, form=f"{quote}%.9g{quote}", delimiter=",")
    assert_sphere(read(tmp_path, "a.csv", plain))


@pytest.mark.parametrize("names", ["x,y,z\n", "x,y,z,\n", ""])
@pytest.mark.parametrize("end", [",\n", ", \n", ",\r\n"])
def test_a_comma_at_the_end(tmp_path, names, end):
    assert_sphere(read(tmp_path, "a.csv", names + text(SPHERE, delimiter=",", end=end)))


@pytest.mark.parametrize("first", [0, 5])
def test_a_row_without_values_is_dropped_and_counted(tmp_path, first):
    rows = text(SPHERE, delimiter=",").splitlines(keepends=True)
    rows[first] = rows[40] = ",,\n"
    cloud = read(tmp_path, "a.csv", "x,y,z\n" + "".join(rows))
    assert cloud.dropped == {"non_finite": 2}
    assert_sphere(cloud, np.setdiff1d(np.arange(COUNT), [first, 40]))


NOTHING = ["nan", "-nan(ind)", "nan(snan)", "1.#QNAN", "-1.#IND", "1.#INF", "NULL", "N/A", "inf"]


@pytest.mark.parametrize("word", NOTHING)
def test_what_programs_write_where_there_is_no_number(tmp_path, word):
    rows = list(ROWS)
    rows[0] = rows[9] = f"{word} {word} {word}\n"
    kept = np.setdiff1d(np.arange(COUNT), [0, 9])
    body = "".join(rows)
    ply = f"ply\nformat ascii 1.0\nelement vertex {COUNT}\n"
    ply += "".join(f"property float {name}\n" for name in "xyz") + "end_header\n"
    pcd = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
    pcd += f"WIDTH {COUNT}\nHEIGHT 1\nPOINTS {COUNT}\nDATA ascii\n"
    for name, head in (("a.xyz", ""), ("a.txt", "x y z\n"), ("a.ply", ply), ("a.pcd", pcd)):
        cloud = read(tmp_path, name, head + body)
        assert cloud.dropped == {"non_finite": 2}
        assert_sphere(cloud, kept)


@pytest.mark.parametrize("mark", ["# p", "// p", "#", "# 1 2 3", "% p"])
def test_a_comment_behind_numbers(tmp_path, mark):
    assert_sphere(read(tmp_path, "a.xyz", text(SPHERE, end=f" {mark}\n")))


@pytest.mark.parametrize("title", ["Scan 1", "A scan of the town hall", "Title: hall", "Scan no 1"])
@pytest.mark.parametrize("names", ["x y z\n", ""])
def test_a_title(tmp_path, title, names):
    assert_sphere(read(tmp_path, "a.txt", f"{title}\n{names}" + "".join(ROWS)))


@pytest.mark.parametrize("delimiter", [";", "\t", " ", " ; "])
@pytest.mark.parametrize("names", [True, False])
def test_decimal_commas(tmp_path, delimiter, names):
    content = text(SPHERE, delimiter=delimiter, form="%.5f").replace(".", ",")
    head = delimiter.join("XYZ") + "\n" if names else ""
    assert_sphere(read(tmp_path, "a.csv", head + content))


def test_quoted_decimal_commas(tmp_path):
    content = text(SPHERE, delimiter="@", form='"%.5f"').replace(".", ",").replace("@", ",")
    assert_sphere(read(tmp_path, "a.csv", "x,y,z\n" + content))


def test_a_delimiter_inside_quotes_separates_nothing(tmp_path):
    rows = text(SPHERE, delimiter=",").splitlines()
    content = "class,x,y,z\n" + "".join(f'"tall, green ""tree""",{row}\n' for row in rows)
    assert_sphere(read(tmp_path, "a.csv", content))


@pytest.mark.parametrize(
    "names",
    ["px,py,pz", "Points:0,Points:1,Points:2", "Easting,Northing,Elevation", "pos_x,pos_y,pos_z"],
)
def test_other_names_of_positions(tmp_path, names):
    content = f"{names},red\n" + text(SPHERE, np.ones(COUNT), delimiter=",")
    cloud = read(tmp_path, "a.csv", content)
    assert_sphere(cloud)
    assert cloud.notes == ("not used: red",)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-8-sig", "latin-1"])
def test_encodings(tmp_path, encoding):
    content = "# Größe\n" + "".join(ROWS)
    assert_sphere(read(tmp_path, "a.txt", content.encode(encoding)))


@pytest.mark.parametrize(
    "names", ["x [m],y [m],z [m]", "X(m),Y(m),Z(m)", '"x [m]","y [m]","z [m]"']
)
def test_units_in_names(tmp_path, names):
    assert_sphere(read(tmp_path, "a.csv", names + "\n" + text(SPHERE, delimiter=",")))


def test_units_between_blanks(tmp_path):
    assert_sphere(read(tmp_path, "a.txt", "x [m] y [m] z [m]\n" + "".join(ROWS)))
    content = "//X Y Z R G B Illuminance (PCV)\n" + text(SPHERE, COLOURS, np.ones(COUNT))
    assert_coloured(read(tmp_path, "a.txt", content))


@pytest.mark.parametrize("suffix", [".xyz", ".csv", ".txt", ".pts"])
def test_compressed(tmp_path, suffix):
    delimiter = "," if suffix == ".csv" else " "
    content = text(SPHERE, COLOURS, delimiter=delimiter).encode()
    cloud = read(tmp_path, f"my.scan{suffix}.gz", gzip.compress(content))
    assert_coloured(cloud)
    assert cloud.name == "my.scan"


def test_compressed_without_saying_so(tmp_path):
    assert_sphere(read(tmp_path, "a.xyz", gzip.compress("".join(ROWS).encode())))


def test_an_error_names_the_line_and_the_cause(tmp_path):
    for line, cause in (("1 2", "has 2 of 3 columns"), ("1 two 3", "holds no numbers")):
        rows = list(ROWS)
        rows[9] = line + "\n"
        with pytest.raises(InputError, match=f"line 12 {cause}"):
            read(tmp_path, "a.xyz", "# one\n\n" + "".join(rows))


def test_a_text_with_few_zeros_is_none(tmp_path):
    """UTF-16 of a plain text has a zero in nearly every other byte."""
    whole = "1 2 3\n4 5 6\n7 8 9\n"
    (tmp_path / "a.xyz").write_bytes(whole.encode("utf-16-le"))
    assert len(read_cloud(tmp_path / "a.xyz")) == 3
    (tmp_path / "a.xyz").write_bytes(b"1\x00" * 9 + b"23")
    with pytest.raises(InputError, match="it is not text"):
        read_cloud(tmp_path / "a.xyz")


def test_a_delimiter_behind_the_last_name_is_no_name():
    assert _names("x,") == ["x"]
    assert _names("x,y,z,,") == ["x", "y", "z"]
    assert _names(",") == [""]
