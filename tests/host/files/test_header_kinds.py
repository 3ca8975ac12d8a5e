"""Headers as programs write them, and those that promise too much."""

import gzip

import numpy as np
import pytest

from splatline.contract.errors import InputError
from tests.host.files.kinds import (
    COLOURS,
    COUNT,
    PACKED,
    RGB_PLY,
    SPHERE,
    XYZ_PCD,
    XYZ_PLY,
    assert_coloured,
    assert_sphere,
    compressed_pcd,
    pcd,
    ply,
    ply_of,
    read,
    text,
)

BRACKETS = ["Illuminance_(PCV)", "Roughness_(0.1)", "Distance(m)", "a[1]", "ünïcode", "a+b/c"]


class TestPcd:
    @pytest.mark.parametrize("name", BRACKETS)
    @pytest.mark.parametrize("place", [0, 2, 3, 4])
    @pytest.mark.parametrize("form", ["ascii", "binary"])
    def test_a_field_with_brackets_is_left_alone(self, tmp_path, name, place, form):
        fields, columns = [*XYZ_PCD, "rgb U 4 1"], [*SPHERE.T, PACKED]
        fields.insert(place, f"{name} F 4 1")
        columns.insert(place, np.full(COUNT, 0.5))
        cloud = read(tmp_path, "a.pcd", pcd(fields, columns, form=form))
        assert_coloured(cloud)
        assert len(cloud.ignored) == 1

    def test_a_name_with_a_blank(self, tmp_path):
        content = pcd([*XYZ_PCD, "Illuminance F 4 1"], [*SPHERE.T, np.ones(COUNT)])
        content = content.replace(b"Illuminance", b"Illuminance (PCV)")
        assert_sphere(read(tmp_path, "a.pcd", content))

    def test_padding_with_and_without_values(self, tmp_path):
        fields = [*XYZ_PCD, "_ U 1 4", "intensity F 4 1", "_ U 1 0", "noise U 1 1", "_ U 1 15"]
        columns = [*SPHERE.T, np.zeros((COUNT, 4)), np.arange(COUNT), np.zeros(COUNT)]
        cloud = read(tmp_path, "a.pcd", pcd(fields, [*columns, np.zeros((COUNT, 15))]))
        assert_sphere(cloud)
        assert cloud.ignored == ("noise",)
        assert not cloud.notes

    @pytest.mark.parametrize(
        "missing", [["COUNT"], ["VERSION"], ["VIEWPOINT"], ["POINTS"], ["HEIGHT"]]
    )
    @pytest.mark.parametrize("form", ["ascii", "binary"])
    def test_a_missing_line(self, tmp_path, missing, form):
        content = pcd(XYZ_PCD, SPHERE.T, form=form, leave_out=missing)
        assert_sphere(read(tmp_path, "a.pcd", content))

    @pytest.mark.parametrize(
        "extra",
        ["TIMESTAMP 12\n", "# Maßstab, Größe\n", "\n", "# DATA binary\n", "SENSOR a b\n" * 20],
    )
    @pytest.mark.parametrize("form", ["ascii", "binary"])
    def test_a_further_line(self, tmp_path, extra, form):
        content = pcd(XYZ_PCD, SPHERE.T, form=form, extra=extra)
        assert_sphere(read(tmp_path, "a.pcd", content))

    def test_points_whose_bytes_spell_words(self, tmp_path):
        shifted = SPHERE + np.array([13.0, 0.0, 0.0])
        content = pcd(XYZ_PCD, shifted.T, extra="TIMESTAMP 12\n")
        cloud = read(tmp_path, "a.pcd", content)
        assert np.allclose(cloud.positions + cloud.origin, shifted, atol=1e-5)

    @pytest.mark.parametrize("form", ["{} \n", "{}\t\r\n", "  {}\n"])
    @pytest.mark.parametrize("delimiter", [" ", "\t", "   "])
    def test_blanks_in_ascii(self, tmp_path, form, delimiter):
        head, body = pcd(XYZ_PCD, SPHERE.T, form="ascii").decode().split("ascii\n")
        lines = [form.format(line.replace(" ", delimiter)) for line in body.splitlines()]
        assert_sphere(read(tmp_path, "a.pcd", f"{head}ascii\n{''.join(lines)}"))

    def test_a_header_with_the_line_ends_of_windows(self, tmp_path):
        head, body = pcd(XYZ_PCD, SPHERE.T).split(b"binary\n", 1)
        content = head.replace(b"\n", b"\r\n") + b"binary\r\n" + body
        assert_sphere(read(tmp_path, "a.pcd", content))

    def test_compressed_fields(self, tmp_path):
        content = compressed_pcd()
        cloud = read(tmp_path, "a.pcd", content)
        assert_coloured(cloud)
        assert cloud.ignored == ("pair",)
        for damaged in (content[:-3], content.replace(b"POINTS 60", b"POINTS 61")):
            with pytest.raises(InputError, match=r"is it damaged|is truncated"):
                read(tmp_path, "a.pcd", damaged)


class TestPly:
    COLUMNS = (*SPHERE.T, *COLOURS.T)

    @pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
    @pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
    def test_a_comment_in_any_encoding(self, tmp_path, kind, encoding):
        content = ply([*XYZ_PLY, *RGB_PLY], self.COLUMNS, kind=kind, comment="@")
        content = content.replace(b"@", "Größe in m".encode(encoding), 1)
        assert_coloured(read(tmp_path, "a.ply", content))

    @pytest.mark.parametrize("after", ["\n", "\ufeff", "  \n\n", "\r\n"])
    def test_a_blank_line_or_a_mark_behind_the_header(self, tmp_path, after):
        content = ply([*XYZ_PLY, *RGB_PLY], self.COLUMNS, kind="ascii", after=after)
        assert_coloured(read(tmp_path, "a.ply", content))

    @pytest.mark.parametrize("kind", ["ascii", "binary_little_endian"])
    def test_a_mark_before_the_header(self, tmp_path, kind):
        content = ply([*XYZ_PLY, *RGB_PLY], self.COLUMNS, kind=kind)
        assert_coloured(read(tmp_path, "a.ply", b"\xef\xbb\xbf" + content))

    @pytest.mark.parametrize("line_end", [b"\r\n", b"\r"])
    def test_line_ends(self, tmp_path, line_end):
        head, body = ply([*XYZ_PLY, *RGB_PLY], self.COLUMNS).split(b"end_header\n", 1)
        content = head.replace(b"\n", line_end) + b"end_header" + line_end + body
        assert_coloured(read(tmp_path, "a.ply", content))

    @pytest.mark.parametrize("kind", ["ascii", "binary_little_endian"])
    def test_a_property_twice(self, tmp_path, kind):
        names = [*XYZ_PLY, "float x", *RGB_PLY, "float quality", "float quality"]
        columns = [*SPHERE.T, np.full(COUNT, 9.0), *COLOURS.T, *np.ones((2, COUNT))]
        cloud = read(tmp_path, "a.ply", ply(names, columns, kind=kind))
        assert_coloured(cloud)
        assert cloud.notes == (
            "x comes twice; the first counts",
            "quality comes twice; the first counts",
        )

    def test_a_signalling_nan_is_dropped_and_counted(self, tmp_path):
        rows = SPHERE.astype("<f4")
        rows.view("<u4")[3, 0] = 0x7F800001
        content = ply(XYZ_PLY, [np.zeros(COUNT)] * 3)[: -rows.nbytes] + rows.tobytes()
        cloud = read(tmp_path, "a.ply", content)
        assert cloud.dropped == {"non_finite": 1}
        assert_sphere(cloud, np.delete(np.arange(COUNT), 3))

    def test_a_signalling_nan_elsewhere(self, tmp_path):
        rows = SPHERE.astype("<f4")
        rows.view("<u4")[3, 0] = 0x7F800001
        np.savez(tmp_path / "b.npz", points=rows, normals=rows, colors=rows)
        np.save(tmp_path / "b.npy", rows)
        content = pcd(XYZ_PCD, [np.zeros(COUNT)] * 3)[: -rows.nbytes] + rows.tobytes()
        for name, data in (
            ("a.pcd", content),
            ("a.npz", (tmp_path / "b.npz").read_bytes()),
            ("a.npy", (tmp_path / "b.npy").read_bytes()),
        ):
            cloud = read(tmp_path, name, data)
            assert cloud.dropped == {"non_finite": 1}

    @pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
    def test_vertices_with_lists(self, tmp_path, kind):
        content = ply([*XYZ_PLY, *RGB_PLY], self.COLUMNS, kind=kind)
        content = content.replace(b"end_header", b"property list uchar int other\nend_header")
        head, body = content.split(b"end_header\n", 1)
        for uneven in (False, True):
            order = "big" if "big" in kind else "little"
            tails = [[i] * (1 + (uneven and i % 3)) for i in range(COUNT)]
            if kind == "ascii":
                lines = body.decode().splitlines()
                rows = [
                    f"{line} {len(tail)} {' '.join(map(str, tail))}\n".encode()
                    for line, tail in zip(lines, tails, strict=True)
                ]
            else:
                rows = [
                    body[15 * i : 15 * i + 15]
                    + bytes([len(tail)])
                    + b"".join(value.to_bytes(4, order) for value in tail)
                    for i, tail in enumerate(tails)
                ]
            whole = head + b"end_header\n" + b"".join(rows)
            cloud = read(tmp_path, "a.ply", whole)
            assert_coloured(cloud)
            assert cloud.ignored == ("other",)
            with pytest.raises(InputError, match="is it damaged"):
                read(tmp_path, "a.ply", whole[:-5])

    def test_compressed(self, tmp_path):
        content = gzip.compress(ply([*XYZ_PLY, *RGB_PLY], self.COLUMNS))
        assert_coloured(read(tmp_path, "scan.ply.gz", content))
        with pytest.raises(InputError, match="cannot be decompressed; is it damaged"):
            read(tmp_path, "scan.ply.gz", content[:-9])
        with pytest.raises(InputError, match="is not compressed"):
            read(tmp_path, "scan.ply.gz", b"ply\n")


class TestNpy:
    @pytest.mark.parametrize("kind", ["f4", "f8", ">f4", "i4"])
    def test_rows_without_names(self, tmp_path, kind):
        places = np.round(SPHERE * 1000).astype(kind)
        np.save(tmp_path / "a.npy", places)
        cloud = read(tmp_path, "b.npy", (tmp_path / "a.npy").read_bytes())
        assert np.allclose(cloud.positions + cloud.origin, np.round(SPHERE * 1000))

    def test_rows_with_colours(self, tmp_path):
        np.save(tmp_path / "a.npy", np.hstack([SPHERE, COLOURS]))
        assert_coloured(read(tmp_path, "b.npy", (tmp_path / "a.npy").read_bytes()))

    def test_columns_by_name(self, tmp_path):
        np.savez(tmp_path / "a.npz", **dict(zip("xyzrgb", [*SPHERE.T, *COLOURS.T], strict=True)))
        assert_coloured(read(tmp_path, "b.npz", (tmp_path / "a.npz").read_bytes()))


FACES = ["list uchar int vertex_indices"]
XYZ = ["float x", "float y", "float z"]


@pytest.mark.parametrize("name", ["a.ply", "a.pcd"])
def test_bytes_behind_the_last_point_are_said(tmp_path, name):
    content = ply(XYZ_PLY, SPHERE.T) if name == "a.ply" else pcd(XYZ_PCD, SPHERE.T)
    assert read(tmp_path, name, content + b"\r\n").notes == ()
    cloud = read(tmp_path, name, content + bytes(720))
    assert_sphere(cloud)
    assert cloud.notes == ("720 bytes behind the last point are not read; the header may be wrong",)


def test_a_count_of_rows_is_checked_against_the_bytes(tmp_path):
    content = text(SPHERE).encode()
    head = ply_of(COUNT, XYZ).split(b"1 2 3\n")[0]
    assert_sphere(read(tmp_path, "a.ply", head + content))
    with pytest.raises(InputError, match="ends after 60 of its 61 rows of element vertex"):
        read(tmp_path, "a.ply", ply_of(COUNT + 1, XYZ).split(b"1 2 3\n")[0] + content)


def test_the_rows_that_are_there_are_counted_behind_a_long_list(tmp_path):
    """A list of 41 bytes stands before the vertices, of which the last two are missing."""
    content = ply(XYZ_PLY, SPHERE.T)
    ahead = b"element mark 1\nproperty list uchar int n\nelement vertex"
    head, body = content.replace(b"element vertex", ahead).split(b"end_header\n", 1)
    whole = head + b"end_header\n\x0a" + bytes(40) + body
    assert_sphere(read(tmp_path, "a.ply", whole))
    told = f"ends after {COUNT - 2} of its {COUNT} rows of element vertex"
    with pytest.raises(InputError, match=told):
        read(tmp_path, "a.ply", whole[: -len(body) // COUNT * 2])


def test_a_word_among_rows_with_lists_is_told(tmp_path):
    content = ply(XYZ_PLY, SPHERE.T, kind="ascii")
    head, body = content.split(b"end_header\n", 1)
    head += b"property list uchar int other\nend_header\n"
    rows = [line + b" 1 7\n" for line in body.splitlines()]
    assert_sphere(read(tmp_path, "a.ply", head + b"".join(rows)))
    with pytest.raises(InputError, match="a vertex does not fit its properties"):
        read(tmp_path, "a.ply", head + b"".join([*rows[:-1], b"1 2 three 1 7\n"]))
