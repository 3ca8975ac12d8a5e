"""Cloud files of every format."""

import subprocess
import sys

import numpy as np
import pytest
from plyfile import PlyData, PlyElement
from pypcd4 import Encoding, PointCloud

from splatline.contract.errors import InputError
from splatline.host.files import source
from splatline.host.files.colours import NEUTRAL, colours_to_bytes
from splatline.host.files.readers import read_cloud
from tests.host.files.cloud_files import (
    COLOURS,
    COUNT,
    FACES,
    NORMALS,
    POSITIONS,
    assert_is_the_cloud,
    places,
    vertices,
    write_pcd,
    write_ply,
    write_text,
)


class TestFormats:
    @pytest.mark.parametrize(
        "kind", [{"text": True}, {"byte_order": "<"}, {"byte_order": ">"}], ids=str
    )
    @pytest.mark.parametrize("faces", [None, "triangles", "mixed"])
    def test_ply(self, tmp_path, kind, faces):
        path = write_ply(tmp_path / "a.ply", faces=FACES.get(faces), **kind)
        assert_is_the_cloud(read_cloud(path))

    def test_ply_with_double_positions_and_extra_properties(self, tmp_path):
        rows = np.empty(COUNT, [("quality", "f4"), *[(name, "f8") for name in "xyz"]])
        for name, column in zip("xyz", POSITIONS.T, strict=True):
            rows[name] = column + 1e7
        rows["quality"] = np.nan
        cloud = read_cloud(write_ply(tmp_path / "a.ply", rows))
        assert places(cloud) == pytest.approx(POSITIONS + 1e7, abs=1e-8, rel=0)

    def test_ply_with_points_under_another_name(self, tmp_path):
        other = np.zeros(2, [("k", "i4")])
        points = PlyElement.describe(vertices(), "point")
        PlyData([PlyElement.describe(other, "camera"), points]).write(str(tmp_path / "a.ply"))
        assert_is_the_cloud(read_cloud(tmp_path / "a.ply"))

    @pytest.mark.parametrize("encoding", list(Encoding)[:3], ids=lambda encoding: encoding.value)
    def test_pcd(self, tmp_path, encoding):
        assert_is_the_cloud(read_cloud(write_pcd(tmp_path / "a.pcd", encoding)))

    def test_pcd_with_colours_in_the_bits_of_floats(self, tmp_path):
        packed = PointCloud.encode_rgb(COLOURS)
        columns = [*POSITIONS.T, packed]
        cloud = PointCloud.from_points(columns, ("x", "y", "z", "rgb"), (np.float32,) * 4)
        cloud.save(tmp_path / "a.pcd", Encoding.BINARY)
        assert np.array_equal(read_cloud(tmp_path / "a.pcd").colours, COLOURS)

    def test_pcd_of_a_single_point_as_text(self, tmp_path):
        cloud = PointCloud.from_points([[1.0], [2.0], [3.0]], ("x", "y", "z"), (np.float32,) * 3)
        cloud.save(tmp_path / "a.pcd", Encoding.ASCII)
        assert places(read_cloud(tmp_path / "a.pcd")).tolist() == [[1.0, 2.0, 3.0]]

    @pytest.mark.parametrize("colours", ["colours", "colors", "rgb"])
    @pytest.mark.parametrize("positions", ["positions", "points", "xyz"])
    def test_npz(self, tmp_path, positions, colours):
        arrays = {positions: POSITIONS, "normals": NORMALS, colours: COLOURS, "other": np.ones(3)}
        np.savez(tmp_path / "a.npz", **arrays)
        assert_is_the_cloud(read_cloud(tmp_path / "a.npz"))

    def test_npz_leaves_out_the_fourth_channel(self, tmp_path):
        colours = np.column_stack([COLOURS, np.full(COUNT, 255, np.uint8)])
        np.savez(tmp_path / "a.npz", points=POSITIONS, normals=NORMALS, colors=colours)
        assert_is_the_cloud(read_cloud(tmp_path / "a.npz"))

    def test_the_suffix_may_be_in_capitals(self, tmp_path):
        assert_is_the_cloud(read_cloud(write_ply(tmp_path / "SCAN.PLY")))

    def test_the_path_may_be_a_string_and_names_the_cloud(self, tmp_path):
        assert read_cloud(str(write_ply(tmp_path / "my.scan.ply"))).name == "my.scan"


class TestText:
    @pytest.mark.parametrize("suffix", [".xyz", ".xyzn", ".txt", ".csv", ".asc"])
    @pytest.mark.parametrize("delimiter", [" ", ",", ", ", ";", "\t", "   "])
    def test_nine_columns_are_position_normal_colour(self, tmp_path, suffix, delimiter):
        path = tmp_path / f"a{suffix}"
        write_text(path, POSITIONS, NORMALS, COLOURS, delimiter=delimiter)
        assert_is_the_cloud(read_cloud(path))

    def test_nine_columns_may_have_the_normal_last(self, tmp_path):
        path = write_text(tmp_path / "a.txt", POSITIONS, COLOURS, NORMALS)
        assert_is_the_cloud(read_cloud(path))

    def test_three_columns_are_a_position(self, tmp_path):
        cloud = read_cloud(write_text(tmp_path / "a.xyz", POSITIONS))
        assert places(cloud) == pytest.approx(POSITIONS.astype(float), abs=1e-6)
        assert cloud.two_sided.all()

    def test_a_fourth_column_is_left_alone(self, tmp_path):
        cloud = read_cloud(write_text(tmp_path / "a.xyz", POSITIONS, np.arange(COUNT)))
        assert (cloud.colours == NEUTRAL).all()
        assert places(cloud) == pytest.approx(POSITIONS.astype(float), abs=1e-6)

    def test_six_columns_with_unit_vectors_are_normals(self, tmp_path):
        cloud = read_cloud(write_text(tmp_path / "a.xyz", POSITIONS, NORMALS))
        assert cloud.normals == pytest.approx(NORMALS, abs=1e-6)
        assert (cloud.colours == NEUTRAL).all()

    @pytest.mark.parametrize("scale", [1, 1 / 255])
    def test_six_columns_with_others_are_colours(self, tmp_path, scale):
        cloud = read_cloud(write_text(tmp_path / "a.xyz", POSITIONS, COLOURS * scale))
        assert np.array_equal(cloud.colours, COLOURS)
        assert cloud.two_sided.all()

    def test_six_columns_of_xyzn_are_normals_of_any_length(self, tmp_path):
        cloud = read_cloud(write_text(tmp_path / "a.xyzn", POSITIONS, 100.0 * NORMALS))
        assert cloud.normals == pytest.approx(NORMALS, abs=1e-6)

    @pytest.mark.parametrize("mark", ["", "# ", "//"])
    @pytest.mark.parametrize("delimiter", [" ", ","])
    def test_a_header_says_what_the_columns_are(self, tmp_path, mark, delimiter):
        names = ["B", "time", "z", "x", "y", "R", "G", "nz", "nx", "ny"]
        columns = {**dict(zip("xyz", POSITIONS.T, strict=True)), "time": np.arange(COUNT)}
        columns |= zip(["nx", "ny", "nz"], NORMALS.T, strict=True)
        columns |= zip("RGB", COLOURS.T, strict=True)
        path = tmp_path / "a.csv"
        header = mark + delimiter.join(names)
        write_text(path, *(columns[name] for name in names), header=header, delimiter=delimiter)
        assert_is_the_cloud(read_cloud(path))

    def test_the_first_point_is_read_under_a_header_and_without_one(self, tmp_path):
        for text in ("1 2 3\n4 5 6\n", "x y z\n1 2 3\n4 5 6\n", "\n# by hand\n\n1 2 3\n4 5 6"):
            (tmp_path / "a.txt").write_text(text)
            assert places(read_cloud(tmp_path / "a.txt")).tolist() == [[1, 2, 3], [4, 5, 6]]

    def test_a_column_of_words_is_left_alone_under_a_header(self, tmp_path):
        (tmp_path / "a.csv").write_text('"class","x","y","z"\ntall tree,1,2,3\nroad,4,5,6\n')
        assert places(read_cloud(tmp_path / "a.csv")).tolist() == [[1, 2, 3], [4, 5, 6]]

    def test_a_line_of_words_under_a_header_is_an_error(self, tmp_path):
        (tmp_path / "a.csv").write_text("x,y,z\none,two,three\n")
        with pytest.raises(InputError, match="line 2 holds no numbers"):
            read_cloud(tmp_path / "a.csv")

    def test_a_spreadsheets_mark_and_line_ends_are_no_trouble(self, tmp_path):
        (tmp_path / "a.csv").write_bytes(b"\xef\xbb\xbfx,y,z\r\n1,2,3\r\n4,5,6\r\n")
        assert places(read_cloud(tmp_path / "a.csv")).tolist() == [[1, 2, 3], [4, 5, 6]]


class TestRepairs:
    def test_positions_are_relative_to_the_middle_of_the_bounding_box(self, tmp_path):
        (tmp_path / "a.xyz").write_text("0 0 0\n0 0 1\n0 2 0\n10 0 0\n")
        cloud = read_cloud(tmp_path / "a.xyz")
        assert cloud.origin.tolist() == [5.0, 1.0, 0.5]
        assert cloud.positions[0].tolist() == [-5.0, -1.0, -0.5]

    def test_map_coordinates_give_the_same_cloud_as_the_origin(self, tmp_path):
        offset = np.array([3.5e6, 5.4e6, 2e2])
        np.savez(tmp_path / "here.npz", points=POSITIONS.astype(float))
        np.savez(tmp_path / "there.npz", points=POSITIONS + offset)
        here, there = read_cloud(tmp_path / "here.npz"), read_cloud(tmp_path / "there.npz")
        assert there.positions == pytest.approx(here.positions, abs=1e-8, rel=0)
        assert there.origin - here.origin == pytest.approx(offset, rel=1e-12)
        assert np.abs(np.sum(here.normals * there.normals, axis=1)).min() > 0.9999

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    def test_points_without_a_finite_position_are_dropped_and_counted(self, tmp_path, bad):
        positions = POSITIONS.copy()
        positions[[3, 7], [0, 2]] = bad
        cloud = read_cloud(write_ply(tmp_path / "a.ply", vertices(positions)))
        kept = np.delete(np.arange(COUNT), [3, 7])
        assert cloud.dropped == {"non_finite": 2}
        assert places(cloud) == pytest.approx(POSITIONS[kept].astype(float), abs=1e-6)
        assert cloud.normals == pytest.approx(NORMALS[kept], abs=1e-6)
        assert np.array_equal(cloud.colours, COLOURS[kept])

    def test_normals_are_scaled_to_unit_length(self, tmp_path):
        lengths = np.geomspace(1e-30, 1e30, COUNT, dtype=np.float32)[:, None]
        rows = vertices(normals=NORMALS * lengths)
        cloud = read_cloud(write_ply(tmp_path / "a.ply", rows))
        assert cloud.normals == pytest.approx(NORMALS, abs=1e-5)
        assert not cloud.two_sided.any()

    def test_missing_normals_alone_are_estimated(self, tmp_path):
        rng = np.random.default_rng(3)
        plane = np.column_stack([rng.random((COUNT, 2)), np.zeros(COUNT)]).astype(np.float32)
        normals = np.tile(np.float32([0.6, 0.0, 0.8]), (COUNT, 1))
        normals[5], normals[6], normals[7] = 0.0, np.nan, np.inf
        cloud = read_cloud(write_ply(tmp_path / "a.ply", vertices(plane, normals)))
        assert np.flatnonzero(cloud.two_sided).tolist() == [5, 6, 7]
        assert np.abs(cloud.normals[5:8]) == pytest.approx(np.tile([0, 0, 1], (3, 1)), abs=1e-4)
        assert np.delete(cloud.normals, [5, 6, 7], axis=0) == pytest.approx(
            np.tile([0.6, 0.0, 0.8], (COUNT - 3, 1))
        )

    def test_without_normals_every_point_is_two_sided(self, tmp_path):
        cloud = read_cloud(write_ply(tmp_path / "a.ply", vertices(normals=None)))
        assert cloud.two_sided.all()
        assert np.linalg.norm(cloud.normals, axis=1) == pytest.approx(1.0, abs=1e-6)

    def test_without_colours_every_point_is_neutral(self, tmp_path):
        cloud = read_cloud(write_ply(tmp_path / "a.ply", vertices(colours=None)))
        assert (cloud.colours == NEUTRAL).all()


class TestColours:
    @pytest.mark.parametrize(
        "written",
        [
            COLOURS,
            COLOURS / 255.0,
            (COLOURS / 255.0).astype(np.float32),
            COLOURS.astype(np.float64),
            COLOURS.astype(np.uint16),
            COLOURS.astype(np.uint16) * 257,
            COLOURS * 257.0,
            COLOURS.astype(np.int32),
        ],
        ids=["bytes", "0..1", "single", "0..255", "short", "0..65535", "float short", "int"],
    )
    def test_every_usual_scale_gives_the_same_bytes(self, written):
        assert np.array_equal(colours_to_bytes(written), COLOURS)

    @pytest.mark.parametrize("kind", [np.uint16, np.int32, np.float32, np.float64])
    @pytest.mark.parametrize("largest", [900, 4095, 30_000, 65_535])
    def test_dark_colours_of_sixteen_bits_are_not_brightened(self, kind, largest):
        # Most values are below 256, as in a picture by night; the scale is that of the type.
        colours = np.full((1000, 3), 100)
        colours[:80] = np.linspace(300, largest, 80)[:, np.newaxis]
        right = np.rint(colours / 257.0)
        assert np.array_equal(colours_to_bytes(colours.astype(kind)), right)

    @pytest.mark.parametrize("kind", [np.uint16, np.int32, np.float64])
    @pytest.mark.parametrize("largest", [2, 60, 254, 255])
    def test_values_up_to_255_are_bytes_in_every_type(self, kind, largest):
        colours = np.arange(3 * (largest + 1)).reshape(-1, 3) % (largest + 1)
        assert np.array_equal(colours_to_bytes(colours.astype(kind)), colours)

    def test_integers_of_0_and_1_are_bytes(self):
        assert colours_to_bytes(np.array([[0, 1, 1]], np.uint16)).tolist() == [[0, 1, 1]]

    def test_colours_out_of_range_are_clipped(self):
        colours = np.array([[-0.5, 0.5, 1.0]])
        assert colours_to_bytes(colours).tolist() == [[0, 128, 255]]

    def test_colours_that_are_no_numbers_become_neutral(self):
        colours = np.array([[np.nan, 0.0, 0.0], [np.inf, 1.0, 1.0], [1.0, 0.0, 0.0]])
        assert colours_to_bytes(colours).tolist() == [list(NEUTRAL), list(NEUTRAL), [255, 0, 0]]


@pytest.mark.parametrize("name", ["a.xyz", "a.xyz.gz", "a.ply", "a.pcd"])
def test_the_share_of_a_text_that_is_read_rises_to_all(tmp_path, name):
    rows = vertices(np.random.default_rng(3).normal(size=(5000, 3)), None, None)
    path = tmp_path / name
    if name == "a.ply":
        write_ply(path, rows, text=True)
    elif name == "a.pcd":
        points = np.stack([rows[axis] for axis in "xyz"]).astype(np.float32)
        PointCloud.from_xyz_points(points.T).save(path, Encoding.ASCII)
    else:
        np.savetxt(path, np.stack([rows[axis] for axis in "xyz"], axis=1))
    told = []
    read = read_cloud(path, progress=lambda stage, share: told.append((stage, share)))
    assert np.array_equal(read.positions, read_cloud(path).positions)
    shares = [share for stage, share in told if stage == "read"]
    assert len(set(shares)) >= 5
    assert all(0.0 < share <= 1.0 for share in shares)
    assert shares[-1] == 1.0
    assert told[len(shares) :][0] == ("normals", 0.0)
    assert told[-1] == ("normals", 1.0)
    if name.endswith(".gz"):
        assert (shares[0], shares[1] > 0.5) == (0.5, True)  # unpacked at once, as it is small


def test_the_share_of_a_binary_file_that_is_read_rises_to_all(tmp_path, monkeypatch):
    rows = vertices(np.random.default_rng(3).normal(size=(5000, 3)), None, None)
    path = write_ply(tmp_path / "a.ply", rows)
    whole = read_cloud(path)
    monkeypatch.setattr(source, "LARGE_PIECE", 10_000)
    told = []

    def tell(stage, share):
        if stage == "read":
            told.append(share)

    read = read_cloud(path, progress=tell)
    assert np.array_equal(read.positions, whole.positions)
    assert told == sorted(told)
    assert len(set(told)) >= 5


def test_the_share_of_a_compressed_pcd_that_is_read_rises_to_all(tmp_path, monkeypatch):
    positions = np.random.default_rng(3).normal(size=(5000, 3)).astype(np.float32)
    path = tmp_path / "a.pcd"
    PointCloud.from_xyz_points(positions).save(path, Encoding.BINARY_COMPRESSED)
    whole = read_cloud(path)
    monkeypatch.setattr(source, "LARGE_PIECE", 10_000)
    told = []
    read = read_cloud(path, progress=lambda *what: told.append(what))
    assert np.array_equal(read.positions, whole.positions)
    shares = [share for stage, share in told if stage == "read"]
    assert shares == sorted(shares)
    assert len(set(shares)) >= 5
    assert shares[-1] == 1.0


@pytest.mark.parametrize("order", ["C", "F"])
def test_the_share_of_an_array_that_is_read_rises_to_all(tmp_path, monkeypatch, order):
    monkeypatch.setattr(source, "LARGE_PIECE", 10_000)
    positions = np.random.default_rng(3).normal(size=(50_000, 3))
    np.save(tmp_path / "a.npy", np.asarray(positions, order=order))
    told = []
    read = read_cloud(tmp_path / "a.npy", progress=lambda *what: told.append(what))
    assert np.allclose(read.positions + read.origin, positions)
    shares = [share for stage, share in told if stage == "read"]
    assert shares == sorted(shares)
    assert len(set(shares)) >= 5
    assert shares[-1] == 1.0


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_the_share_of_an_archive_that_is_read_rises_to_all(tmp_path, save):
    positions = np.random.default_rng(3).normal(size=(50_000, 3))
    save(tmp_path / "a.npz", positions=positions, normals=positions)
    told = []

    def tell(stage, share):
        if stage == "read":
            told.append(share)

    read = read_cloud(tmp_path / "a.npz", progress=tell)
    assert np.allclose(read.positions + read.origin, positions)
    assert told == sorted(told)
    assert len(set(told)) >= 8
    assert told[-1] == 1.0


def test_a_cloud_with_normals_has_no_stage_for_them(tmp_path):
    told = []
    read_cloud(write_ply(tmp_path / "a.ply"), progress=lambda *what: told.append(what))
    assert all(stage == "read" for stage, _ in told)


def test_libraries_of_single_formats_are_loaded_when_such_a_file_is_read(tmp_path):
    script = (
        "import sys; from splatline.host.files.readers import read_cloud;"
        f"read_cloud({str(write_ply(tmp_path / 'a.ply'))!r});"
        "print({'laspy', 'lazrs', 'trimesh', 'pye57'} & set(sys.modules))"
    )
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True)
    assert ran.stdout.strip() == b"set()"
