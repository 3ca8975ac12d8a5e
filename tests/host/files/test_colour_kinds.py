"""Colours of the kinds that files have; right values are those that the file was made from."""

import io

import numpy as np
import pytest

from splatline.host.files.colours import colours_to_bytes
from tests.host.files.kinds import (
    CLAY,
    COLOURS,
    PACKED,
    RGB_PLY,
    SPHERE,
    XYZ_PCD,
    XYZ_PLY,
    assert_coloured,
    assert_sphere,
    pcd,
    ply,
    read,
    text,
)

FLOAT_RGB = ["float red", "float green", "float blue"]
PCD_RGB = [f"{name} F 4 1" for name in "rgb"]


def npz(**arrays):
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def every_format(folder, colours):
    """The sphere with these colours, in single precision where a format has it."""
    columns = [*SPHERE.T, *np.asarray(colours).T]
    yield read(folder, "a.ply", ply([*XYZ_PLY, *FLOAT_RGB], columns))
    yield read(folder, "t.ply", ply([*XYZ_PLY, *FLOAT_RGB], columns, kind="ascii"))
    yield read(folder, "a.pcd", pcd([*XYZ_PCD, *PCD_RGB], columns))
    yield read(folder, "t.pcd", pcd([*XYZ_PCD, *PCD_RGB], columns, form="ascii"))
    yield read(folder, "a.xyzrgb", text(*columns))
    yield read(folder, "a.csv", "x,y,z,r,g,b\n" + text(*columns, delimiter=","))
    yield read(folder, "a.npz", npz(points=SPHERE, colors=np.asarray(colours, np.float32)))


@pytest.mark.parametrize("over", [1.0000001, 1.02, 1.7, 300.0])
def test_a_value_over_1_is_clipped_and_the_rest_is_as_it_is(tmp_path, over):
    colours = COLOURS / 255.0
    colours[7, 1] = over
    right = COLOURS.copy()
    right[7, 1] = 255
    for cloud in every_format(tmp_path, colours):
        assert_coloured(cloud, right)


@pytest.mark.parametrize("over", [255.5, 256.0, 300.0, 40000.0])
def test_a_value_over_255_is_clipped_and_the_rest_is_as_it_is(tmp_path, over):
    colours = COLOURS.astype(float)
    colours[7, 1] = over
    right = COLOURS.copy()
    right[7, 1] = 255
    for cloud in every_format(tmp_path, colours):
        assert_coloured(cloud, right)


def test_colours_in_sixteen_bits_are_scaled(tmp_path):
    for cloud in every_format(tmp_path, COLOURS * 257.0):
        assert_coloured(cloud)


def test_label_colours_of_0_and_1_are_colours_if_the_suffix_says_so(tmp_path):
    labels = np.eye(3)[np.arange(len(SPHERE)) % 3]
    cloud = read(tmp_path, "a.xyzrgb", text(SPHERE, labels))
    assert_coloured(cloud, (255 * labels).astype(np.uint8))
    assert cloud.two_sided.all()


def test_labels_without_a_suffix_that_says_so_are_colours_too(tmp_path):
    labels = np.eye(3)[np.arange(len(SPHERE)) % 3]
    cloud = read(tmp_path, "a.xyz", text(SPHERE, labels))
    assert_coloured(cloud, (255 * labels).astype(np.uint8))


def test_a_plane_and_a_box_have_normals_along_the_axes(tmp_path):
    up = np.tile([0.0, 0.0, 1.0], (len(SPHERE), 1))
    for normals in (up, np.vstack([np.eye(3), -np.eye(3)])[np.arange(len(SPHERE)) % 6]):
        cloud = read(tmp_path, "a.xyz", text(SPHERE, normals))
        assert np.array_equal(cloud.normals, normals)


@pytest.mark.parametrize("form", ["ascii", "binary"])
def test_bytes_of_0_and_1_are_bytes_if_the_header_says_so(tmp_path, form):
    dark = (COLOURS > 100).astype(np.uint8)
    columns = [*SPHERE.T, *dark.T]
    kind = "ascii" if form == "ascii" else "binary_big_endian"
    assert_coloured(read(tmp_path, "a.ply", ply([*XYZ_PLY, *RGB_PLY], columns, kind=kind)), dark)
    fields = [*XYZ_PCD, "r U 1 1", "g U 1 1", "b U 1 1"]
    assert_coloured(read(tmp_path, "a.pcd", pcd(fields, columns, form=form)), dark)


def test_fractions_under_a_header_that_says_bytes_are_shares(tmp_path):
    content = ply([*XYZ_PLY, *RGB_PLY], [*SPHERE.T, *(COLOURS / 255.0).T], kind="ascii")
    assert_coloured(read(tmp_path, "a.ply", content))


def test_the_fourth_column_of_pts_is_the_intensity(tmp_path):
    cloud = read(tmp_path, "a.pts", text(SPHERE, np.arange(len(SPHERE)) - 2048))
    assert cloud.used["column 4"] == "intensity, as grey"
    assert cloud.colours[0].tolist() == [40, 40, 40]
    assert cloud.colours[-1].tolist() == [235, 235, 235]


@pytest.mark.parametrize(
    "names", ["Rf,Gf,Bf", "R,G,B", "Red,Green,Blue", "diffuse_red,diffuse_green,diffuse_blue"]
)
@pytest.mark.parametrize("mark", ["", "//", "# "])
def test_names_of_colours_in_text(tmp_path, names, mark):
    content = f"{mark}X,Y,Z,{names}\n" + text(SPHERE, COLOURS / 255.0, delimiter=",")
    assert_coloured(read(tmp_path, "a.txt", content))


def test_names_of_colours_elsewhere(tmp_path):
    columns = [*SPHERE.T, *(COLOURS / 255.0).T]
    names = [f"float {name}" for name in ("Rf", "Gf", "Bf")]
    assert_coloured(read(tmp_path, "a.ply", ply([*XYZ_PLY, *names], columns)))
    fields = [*XYZ_PCD, "Rf F 4 1", "Gf F 4 1", "Bf F 4 1"]
    assert_coloured(read(tmp_path, "a.pcd", pcd(fields, columns)))


@pytest.mark.parametrize("name", ["rgb", "rgba"])
def test_packed_colours(tmp_path, name):
    columns = [*SPHERE.T, PACKED]
    bits = [*SPHERE.T, PACKED.view(np.float32)]
    for kind in ("ascii", "binary_little_endian", "binary_big_endian"):
        content = ply([*XYZ_PLY, f"uint {name}"], columns, kind=kind)
        assert_coloured(read(tmp_path, "a.ply", content))
    assert_coloured(read(tmp_path, "a.ply", ply([*XYZ_PLY, f"float {name}"], bits)))
    assert_coloured(read(tmp_path, "a.pcd", pcd([*XYZ_PCD, f"{name} U 4 1"], columns)))
    assert_coloured(read(tmp_path, "a.pcd", pcd([*XYZ_PCD, f"{name} F 4 1"], bits)))
    for kind, values in (("U", columns), ("F", bits)):
        content = pcd([*XYZ_PCD, f"{name} {kind} 4 1"], values, form="ascii")
        assert_coloured(read(tmp_path, "a.pcd", content))
    assert_coloured(read(tmp_path, "a.csv", f"x,y,z,{name}\n" + text(*columns, delimiter=",")))
    assert_coloured(read(tmp_path, "a.npz", npz(points=SPHERE, **{name: PACKED})))


def test_vectors_of_three_values(tmp_path):
    cloud = read(tmp_path, "a.pcd", pcd([*XYZ_PCD, "rgb U 1 3"], [*SPHERE.T, COLOURS]))
    assert_coloured(cloud)
    fields = [*XYZ_PCD, "normal F 4 3"]
    cloud = read(tmp_path, "a.pcd", pcd(fields, [*SPHERE.T, SPHERE]))
    assert not cloud.two_sided.any()
    assert np.allclose(cloud.normals, SPHERE, atol=1e-4)
    rows = np.empty(len(SPHERE), [("xyz", "f4", 3), ("rgb", "u1", 3), ("normal", "f8", 3)])
    rows["xyz"], rows["rgb"], rows["normal"] = SPHERE, COLOURS, SPHERE
    np.save(tmp_path / "a.npy", rows)
    cloud = read(tmp_path, "b.npy", (tmp_path / "a.npy").read_bytes())
    assert_coloured(cloud)
    assert not cloud.two_sided.any()


def test_gaussian_splats_have_the_colour_of_their_constant_harmonic(tmp_path):
    names = ["nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "f_rest_0", "opacity"]
    harmonics = (COLOURS / 255.0 - 0.5) / 0.28209479
    columns = [*SPHERE.T, *np.zeros((3, len(SPHERE))), *harmonics.T, *np.ones((2, len(SPHERE)))]
    content = ply([*XYZ_PLY, *(f"float {name}" for name in names)], columns)
    cloud = read(tmp_path, "a.ply", content)
    assert_coloured(cloud)
    assert cloud.ignored == ("f_rest_0", "opacity")


@pytest.mark.parametrize("name", ["intensity", "scalar_Intensity", "Reflectance"])
def test_an_intensity_alone_is_drawn_as_grey(tmp_path, name):
    intensity = np.linspace(100.0, 900.0, len(SPHERE))
    columns = [*SPHERE.T, intensity]
    clouds = [
        read(tmp_path, "a.ply", ply([*XYZ_PLY, f"float {name}"], columns)),
        read(tmp_path, "a.pcd", pcd([*XYZ_PCD, f"{name} F 4 1"], columns)),
        read(tmp_path, "a.csv", f"x,y,z,{name}\n" + text(*columns, delimiter=",")),
        read(tmp_path, "a.npz", npz(points=SPHERE, **{name: intensity})),
    ]
    for cloud in clouds:
        assert_sphere(cloud)
        grey = cloud.colours.astype(int)
        assert np.ptp(grey, axis=1).max() == 0
        assert np.diff(grey[:, 0]).min() >= 0
        assert grey[0, 0] < 60
        assert grey[-1, 0] > 220
        assert cloud.used[name] == "intensity, as grey"


def test_an_intensity_beside_colours_is_said_to_be_unused(tmp_path):
    columns = [*SPHERE.T, *COLOURS.T, np.arange(len(SPHERE))]
    cloud = read(tmp_path, "a.ply", ply([*XYZ_PLY, *RGB_PLY, "float intensity"], columns))
    assert_coloured(cloud)
    assert cloud.ignored == ("intensity",)
    assert cloud.notes == ("not used: intensity",)


def test_another_scalar_is_said_to_be_unused(tmp_path):
    columns = [*SPHERE.T, np.arange(len(SPHERE))]
    cloud = read(tmp_path, "a.ply", ply([*XYZ_PLY, "float scalar_Height"], columns))
    assert cloud.notes == ("not used: scalar_Height",)
    assert (cloud.colours == CLAY).all()
    cloud = read(tmp_path, "a.xyz", text(*columns))
    assert cloud.notes == ("not used: column 4, which may be an intensity",)


def test_seven_columns_are_position_intensity_colour(tmp_path):
    intensity = np.arange(len(SPHERE)) * 7 - 2000
    for name in ("a.txt", "a.pts", "a.xyz", "a.asc"):
        assert_coloured(read(tmp_path, name, text(SPHERE, intensity, COLOURS)))
        assert_coloured(read(tmp_path, name, text(SPHERE, COLOURS, intensity)))


def test_signed_bytes_have_the_bits_of_bytes(tmp_path):
    columns = [*SPHERE.T, *COLOURS.view(np.int8).T]
    content = ply([*XYZ_PLY, "char red", "char green", "char blue"], columns)
    assert_coloured(read(tmp_path, "a.ply", content))


@pytest.mark.parametrize("largest", [1, 200, 256, 257, 300, 5000, 65535])
def test_colours_of_16_bits_are_what_they_are_in_wider_integers(largest):
    random = np.random.default_rng(largest)
    for count in (1, 10, 1000):
        colours = random.integers(0, largest + 1, (count, 3)).astype(np.uint16)
        colours[: count // 3] = random.integers(0, 65536, (count // 3, 3))
        assert np.array_equal(colours_to_bytes(colours), colours_to_bytes(colours.astype(np.int64)))
