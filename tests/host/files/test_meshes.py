"""Meshes, written by hand: their vertices as points, or their faces sampled."""

import struct

import numpy as np
import pytest
from PIL import Image

from splatline.contract.errors import InputError
from splatline.host.files.readers import read_cloud
from tests.host.files.cloud_files import places, write_ply
from tests.host.files.mesh_files import (
    COLOURS,
    CORNERS,
    FACES,
    glb,
    obj,
    off,
    stl,
    text_stl,
    textured_obj,
)

MIDDLE = CORNERS.mean(axis=0)
NORMALS = np.column_stack([np.ones(8), np.zeros(8), np.zeros(8)])
KINDS = [("a.obj", obj), ("a.stl", stl), ("b.stl", text_stl), ("a.off", off), ("a.glb", glb)]


def read(folder, name, data, **options):
    path = folder / name
    path.write_bytes(data)
    return read_cloud(path, **options)


def assert_are_corners(cloud, corners=CORNERS):
    rows = places(cloud)
    assert len(rows) == len(corners)
    order, wanted = np.lexsort(rows.T), np.lexsort(corners.T)
    assert rows[order] == pytest.approx(corners[wanted], abs=1e-6)


@pytest.mark.parametrize(("name", "make"), KINDS)
def test_vertices_are_points_whose_normals_point_out(tmp_path, name, make):
    cloud = read(tmp_path, name, make())
    assert_are_corners(cloud)
    assert (cloud.normals * (places(cloud) - MIDDLE) > 0.0).all()
    assert not cloud.two_sided.any()


@pytest.mark.parametrize(("name", "make"), KINDS)
def test_faces_are_sampled_evenly(tmp_path, name, make):
    cloud = read(tmp_path, name, make(), sample=2200)
    rows = places(cloud)
    assert len(cloud) == 2200
    # The box is 2 x 1 x 3, so its sides have areas of 3, 6 and 2 on either end: 22 in all.
    for axis, area in enumerate((3.0, 6.0, 2.0)):
        for end in (0.0, CORNERS[:, axis].max()):
            on = np.abs(rows[:, axis] - end) < 1e-6
            assert np.count_nonzero(on) == pytest.approx(100.0 * area, abs=2)
            outward = np.zeros(3)
            outward[axis] = 1.0 if end else -1.0
            flat = np.abs(cloud.normals[on] - outward).max(axis=1) < 1e-6
            assert np.count_nonzero(flat) > 0.98 * np.count_nonzero(on)
            inside = rows[on][:, [i for i in range(3) if i != axis]]
            sides = CORNERS.max(axis=0)[[i for i in range(3) if i != axis]]
            assert inside.mean(axis=0) == pytest.approx(0.5 * sides, abs=0.12 * sides.max())
    assert not cloud.two_sided.any()


def test_the_same_file_gives_the_same_points(tmp_path):
    first, second = (read(tmp_path, "a.off", off(), sample=500) for _ in range(2))
    assert np.array_equal(first.positions, second.positions)


@pytest.mark.parametrize(
    ("name", "data"), [("a.obj", obj(COLOURS)), ("a.glb", glb(colours=COLOURS))], ids=["obj", "glb"]
)
def test_colours_of_vertices(tmp_path, name, data):
    cloud = read(tmp_path, name, data)
    assert np.array_equal(places(cloud)[:, 2] > 0.0, np.arange(8) % 2 == 1)
    assert np.abs(cloud.colours.astype(int) - COLOURS).max() <= 1
    sampled = read(tmp_path, name, data, sample=3000)
    at_first = np.linalg.norm(places(sampled), axis=1) < 0.15
    assert np.abs(sampled.colours[at_first].astype(int) - COLOURS[0]).max() < 30
    # Each channel rises by 9 from the first corner to the last: linear in between.
    expected = 20 + 27 * (places(sampled) / CORNERS.max(axis=0)) @ [4, 2, 1]
    assert np.abs(sampled.colours[:, 0] - expected).max() < 1.5


def test_normals_of_the_file(tmp_path):
    for name, data in (("a.obj", obj(normals=NORMALS)), ("a.glb", glb(normals=NORMALS))):
        for options in ({}, {"sample": 50}):
            cloud = read(tmp_path, name, data, **options)
            assert cloud.normals == pytest.approx(np.tile([1.0, 0.0, 0.0], (len(cloud), 1)))
            assert not cloud.two_sided.any()


def test_an_open_mesh_is_two_sided(tmp_path):
    square = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"
    for options in ({}, {"sample": 50}):
        cloud = read(tmp_path, "a.obj", square, **options)
        assert cloud.two_sided.all()
        assert np.abs(cloud.normals[:, 2]) == pytest.approx(1.0)


def test_a_texture(tmp_path):
    picture = np.zeros((32, 32, 3), np.uint8)
    picture[:, :16], picture[:, 16:] = (255, 0, 0), (0, 0, 255)
    Image.fromarray(picture).save(tmp_path / "a.png")
    (tmp_path / "a.mtl").write_text("newmtl paint\nmap_Kd a.png\n")
    cloud = read(tmp_path, "a.obj", textured_obj(), sample=1000)
    x = places(cloud)[:, 0]
    assert (cloud.colours[x < 0.45] == (255, 0, 0)).all()
    assert (cloud.colours[x > 0.55] == (0, 0, 255)).all()
    assert len(read(tmp_path, "a.obj", textured_obj())) == 4


def test_the_colour_of_a_material(tmp_path):
    for options in ({}, {"sample": 50}):
        cloud = read(tmp_path, "a.glb", glb(material=[1.0, 0.0, 0.0, 1.0]), **options)
        assert (cloud.colours == (255, 0, 0)).all()


def test_every_place_of_a_mesh_in_a_scene(tmp_path):
    turn = [0.0, 0.0, float(np.sqrt(0.5)), float(np.sqrt(0.5))]
    nodes = [{"mesh": 0}, {"mesh": 0, "translation": [10, 0, 0], "rotation": turn}]
    other = np.column_stack([10.0 - CORNERS[:, 1], CORNERS[:, 0], CORNERS[:, 2]])
    cloud = read(tmp_path, "a.glb", glb(nodes=nodes))
    assert_are_corners(cloud, np.vstack([CORNERS, other]))
    sampled = read(tmp_path, "a.glb", glb(nodes=nodes), sample=1000)
    assert np.count_nonzero(places(sampled)[:, 0] > 5.0) == 500


def test_a_mirrored_mesh_still_points_out(tmp_path):
    nodes = [{"mesh": 0, "scale": [-1, 2, 1]}]
    middle = MIDDLE * (-1.0, 2.0, 1.0)
    for options in ({}, {"sample": 300}):
        cloud = read(tmp_path, "a.glb", glb(nodes=nodes), **options)
        assert (((places(cloud) - middle) * cloud.normals).sum(axis=1) > 0.0).all()


def test_the_faces_of_a_ply(tmp_path):
    rows = np.array([tuple(row) for row in CORNERS], [(name, "f4") for name in "xyz"])
    path = write_ply(tmp_path / "a.ply", rows, faces=FACES.tolist())
    assert len(read_cloud(path)) == 8
    cloud = read_cloud(path, sample=500)
    assert len(cloud) == 500
    ends = np.isclose(places(cloud), 0.0) | np.isclose(places(cloud), CORNERS.max(axis=0))
    assert ends.any(axis=1).all()


def test_points_of_an_obj_without_faces(tmp_path):
    cloud = read(tmp_path, "a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n")
    assert len(cloud) == 4
    with pytest.raises(InputError, match="has no faces to sample; leave --sample out"):
        read(tmp_path, "a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", sample=5)


def test_what_has_no_faces_cannot_be_sampled(tmp_path):
    with pytest.raises(InputError, match=r"no faces to sample; meshes are \.ply \.obj"):
        read(tmp_path, "a.xyz", b"1 2 3\n", sample=5)


def test_wrong_files(tmp_path):
    whole = glb()
    for name, data, message in (
        ("a.glb", glb(count=1 << 40), "promises arrays of 13,194,139,533,384 bytes, but has"),
        ("a.glb", glb(count=-1), "its JSON is damaged"),
        ("a.glb", glb(extensions=["KHR_draco_mesh_compression"]), "compressed by KHR_draco"),
        ("a.glb", whole[:12] + struct.pack("<I", 1 << 30) + whole[16:], "does not fit the file"),
        ("a.glb", whole[:4] + struct.pack("<I", 1) + whole[8:], "is glTF 1; 2 is read"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4000000000\n", "damaged"),
        ("a.stl", stl()[:-3], "ends after 11 of its 12 triangles"),
        ("a.stl", stl() + bytes(7), "has 7 bytes behind its 12 triangles"),
        ("a.stl", stl()[:70], "ends inside its header"),
        ("a.stl", b"solid box" + stl()[9:-60], "ends after 10 of its 12 triangles"),
        ("a.stl", b"solid box\nendsolid box\n", "it has no vertices"),
        ("a.off", off().replace(b"8 6 0", b"9 6 0"), "ends after 14 of its 15 vertices"),
        ("a.off", b"OFF\n0 0 0\n", "has no vertices"),
    ):
        with pytest.raises(InputError, match=message):
            read(tmp_path, name, data)
