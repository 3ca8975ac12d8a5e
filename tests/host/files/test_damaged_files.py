"""Cloud files that are damaged, or none: an error in one line."""

import numpy as np
import pytest
from pypcd4 import Encoding, PointCloud

from splatline.contract.errors import InputError
from splatline.host.files.read_text import read_text
from splatline.host.files.readers import FORMATS, read_cloud
from tests.host.files.cloud_files import (
    FACES,
    NORMALS,
    POSITIONS,
    vertices,
    write_pcd,
    write_ply,
    write_text,
)
from tests.host.files.good_files import good_file

TEXTS = [suffix for suffix, read in FORMATS.items() if read is read_text] + [".npy", ".ptx", ".off"]


class TestErrors:
    def fails(self, path, message):
        with pytest.raises(InputError, match=message) as caught:
            read_cloud(path)
        text = str(caught.value)
        assert text.startswith(f"{path}: ")
        assert "\n" not in text
        assert len(text) < len(str(path)) + 300

    def test_missing(self, tmp_path):
        self.fails(tmp_path / "a.ply", "cannot be read: No such file or directory")

    def test_a_folder(self, tmp_path):
        (tmp_path / "a.ply").mkdir()
        self.fails(tmp_path / "a.ply", "is a folder")

    @pytest.mark.parametrize("name", ["a.foo", "a"])
    def test_unknown_format(self, tmp_path, name):
        (tmp_path / name).write_bytes(b"LASF")
        self.fails(tmp_path / name, r"unknown format .* one of \.ply .*\.npz")

    @pytest.mark.parametrize("suffix", FORMATS)
    def test_empty(self, tmp_path, suffix):
        (tmp_path / f"a{suffix}").touch()
        self.fails(tmp_path / f"a{suffix}", "the file is empty")

    @pytest.mark.parametrize("suffix", FORMATS)
    def test_noise(self, tmp_path, suffix):
        path = tmp_path / f"a{suffix}"
        path.write_bytes(np.random.default_rng(4).bytes(5000))
        self.fails(path, f"cannot be read as {suffix[1:].upper()}")

    @pytest.mark.parametrize("suffix", [name for name in FORMATS if name != ".obj"])  # no counts
    @pytest.mark.parametrize("share", [0.02, 0.5, 0.97])
    def test_truncated(self, tmp_path, suffix, share):
        path = good_file(tmp_path, suffix)
        whole = path.read_bytes()
        # A text is cut inside a number's neighbourhood: just before a blank.
        cut = int(len(whole) * share)
        if suffix in TEXTS:
            cut = min(whole.index(b"\n", cut) + 10, len(whole) - 8)
        path.write_bytes(whole[:cut])
        self.fails(path, ": ")

    @pytest.mark.parametrize("kind", [{"text": True}, {"byte_order": "<"}], ids=str)
    @pytest.mark.parametrize("faces", ["triangles", "mixed"])
    def test_a_mesh_truncated_among_its_faces(self, tmp_path, kind, faces):
        path = write_ply(tmp_path / "a.ply", faces=FACES[faces], **kind)
        path.write_bytes(path.read_bytes()[:-5])
        self.fails(path, "is it damaged")

    def test_a_pcd_truncated_between_two_points(self, tmp_path):
        path = write_pcd(tmp_path / "a.pcd", Encoding.BINARY)
        path.write_bytes(path.read_bytes()[: -28 * 5])
        self.fails(path, "ends after 55 of its 60 points")

    def test_a_ply_that_claims_to_be_huge(self, tmp_path):
        text = "ply\nformat {} 1.0\nelement vertex 99999999999999\nproperty double x\nend_header\n1"
        for kind in ("ascii", "binary_little_endian"):
            (tmp_path / "a.ply").write_text(text.format(kind))
            self.fails(tmp_path / "a.ply", "damaged")

    def test_a_ply_without_z(self, tmp_path):
        rows = np.zeros(5, [("x", "f4"), ("y", "f4")])
        self.fails(write_ply(tmp_path / "a.ply", rows), "no vertices with properties x, y and z")

    def test_a_pcd_without_z(self, tmp_path):
        cloud = PointCloud.from_points([[1.0], [2.0]], ("x", "y"), (np.float32,) * 2)
        cloud.save(tmp_path / "a.pcd")
        self.fails(tmp_path / "a.pcd", "no fields x, y and z")

    def test_a_csv_without_z(self, tmp_path):
        (tmp_path / "a.csv").write_text("x,y,height\n1,2,3\n")
        self.fails(tmp_path / "a.csv", "x, y, height: there is no x, y and z")

    @pytest.mark.parametrize("columns", [1, 2, 5, 8, 10])
    def test_a_number_of_columns_that_means_nothing(self, tmp_path, columns):
        write_text(tmp_path / "a.xyz", np.ones((4, columns)))
        self.fails(tmp_path / "a.xyz", f"has {columns} columns without names")

    def test_a_header_and_no_points(self, tmp_path):
        (tmp_path / "a.csv").write_text("x,y,z\n")
        self.fails(tmp_path / "a.csv", "has no points")

    def test_a_header_of_another_length(self, tmp_path):
        (tmp_path / "a.csv").write_text("x,y,z,r\n1,2,3\n")
        self.fails(tmp_path / "a.csv", "names 4 columns, but has 3")

    @pytest.mark.parametrize("line", ["1 2", "1 2 3 4", "1 two 3"])
    def test_a_line_that_does_not_fit(self, tmp_path, line):
        (tmp_path / "a.xyz").write_text(f"1 2 3\n4 5 6\n{line}\n7 8 9\n")
        self.fails(tmp_path / "a.xyz", "is it damaged")

    def test_no_points(self, tmp_path):
        self.fails(write_ply(tmp_path / "a.ply", vertices()[:0], text=True), "has no points")
        self.fails(write_ply(tmp_path / "a.ply", vertices()[:0]), "points|damaged")
        np.savez(tmp_path / "a.npz", points=np.zeros((0, 3)))
        self.fails(tmp_path / "a.npz", "has no points")

    def test_no_finite_point(self, tmp_path):
        rows = vertices(np.full_like(POSITIONS, np.nan))
        self.fails(write_ply(tmp_path / "a.ply", rows), "none of its 60 points has a finite")

    def test_an_npz_without_positions(self, tmp_path):
        np.savez(tmp_path / "a.npz", elevation=POSITIONS)
        self.fails(tmp_path / "a.npz", "has no array named positions, points")

    @pytest.mark.parametrize("bad", [np.ones(3), np.ones((5, 2)), np.full((5, 3), "a")])
    def test_an_npz_of_another_shape_or_type(self, tmp_path, bad):
        np.savez(tmp_path / "a.npz", points=bad)
        self.fails(tmp_path / "a.npz", r"its array points has shape .* \(n, 3\)")

    def test_an_npz_of_unequal_lengths(self, tmp_path):
        np.savez(tmp_path / "a.npz", points=POSITIONS, normals=NORMALS[1:])
        self.fails(tmp_path / "a.npz", "has 60 positions but 59 normals")

    def test_an_npz_with_objects_is_not_executed(self, tmp_path):
        np.savez(tmp_path / "a.npz", points=np.array([{}, {}], object))
        self.fails(tmp_path / "a.npz", "its array points has shape .* type object")

    def test_an_npy_with_objects_is_not_executed(self, tmp_path):
        rows = np.zeros(3, [("x", "f4"), ("y", "f4"), ("z", "f4"), ("name", object)])
        np.save(tmp_path / "a.npy", rows)
        self.fails(tmp_path / "a.npy", "holds Python objects")

    def test_one_array_under_the_name_of_an_archive(self, tmp_path):
        with (tmp_path / "a.npz").open("wb") as stream:
            np.save(stream, POSITIONS)
        self.fails(tmp_path / "a.npz", "is one array")
