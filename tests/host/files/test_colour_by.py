"""What colours a point, in every format: the sphere with an intensity, classes and a field."""

import io
import subprocess
import sys

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import Normalize

from splatline import host
from splatline.contract.errors import InputError
from splatline.host.files import las_drawn, read_las
from splatline.host.files.asprs import CLASSES
from splatline.host.files.wanted import ColourBy
from tests.host.files.cloud_files import POSITIONS
from tests.host.files.kinds import (
    CLAY,
    COLOURS,
    SPHERE,
    XYZ_PCD,
    XYZ_PLY,
    assert_sphere,
    pcd,
    ply,
    text,
)
from tests.host.files.las_files import las, laz, places_of

COUNT = len(SPHERE)
CLASS = np.array([2, 5, 6], float)[np.arange(COUNT) % 3]
INTENSITY = np.linspace(100.0, 900.0, COUNT)
QUALITY = np.round(np.cos(np.arange(COUNT)), 4)
NAMES = ("Intensity", "classification", "Quality")
VALUES = (INTENSITY, CLASS, QUALITY)
RGB = ("red", "green", "blue")


def files(colours=True):
    """The sphere with all of this in every format: name and content."""
    names = [*NAMES, *(RGB if colours else ())]
    columns = [*SPHERE.T, *VALUES, *(COLOURS.T.astype(float) if colours else ())]
    head = [*XYZ_PLY, *(f"float {name}" for name in names)]
    yield "a.ply", ply(head, columns)
    yield "big.ply", ply(head, columns, kind="binary_big_endian")
    yield "t.ply", ply(head, columns, kind="ascii")
    fields = [*XYZ_PCD, *(f"{name} F 4 1" for name in names)]
    yield "a.pcd", pcd(fields, columns)
    yield "t.pcd", pcd(fields, columns, form="ascii")
    yield "a.csv", ",".join(["x", "y", "z", *names]) + "\n" + text(*columns, delimiter=",")
    yield "a.txt", "// X Y Z " + " ".join(names) + "\n" + text(*columns)
    stream = io.BytesIO()
    values = dict(zip(names, columns[3:], strict=True))
    np.savez(stream, points=SPHERE, **values)
    yield "a.npz", stream.getvalue()
    rows = np.empty(COUNT, [(name, "f8") for name in ("x", "y", "z", *names)])
    for name, column in zip(rows.dtype.names, columns, strict=True):
        rows[name] = column
    stream = io.BytesIO()
    np.save(stream, rows)
    yield "a.npy", stream.getvalue()


FORMATS = [name for name, _ in files()]


@pytest.fixture(params=FORMATS)
def path(request, tmp_path):
    content = dict(files())[request.param]
    place = tmp_path / request.param
    place.write_bytes(content if isinstance(content, bytes) else content.encode())
    return place


@pytest.fixture(params=FORMATS)
def bare(request, tmp_path):
    """The same without colours."""
    content = dict(files(colours=False))[request.param]
    place = tmp_path / request.param
    place.write_bytes(content if isinstance(content, bytes) else content.encode())
    return place


def by_map(values, name, low, high):
    return mpl.colormaps[name](Normalize(low, high, clip=True)(values), bytes=True)[:, :3]


def assert_near(colours, right):
    """At most one step of the map apart, since some formats hold single precision."""
    assert np.abs(colours.astype(int) - right.astype(int)).max() <= 8
    assert np.count_nonzero((colours != right).any(axis=1)) <= 0.1 * len(right)


def test_rgb_is_what_the_file_has(path):
    cloud = host.read_cloud(path, colour="rgb")
    assert_sphere(cloud)
    assert np.array_equal(cloud.colours, COLOURS)
    assert cloud.colour_key == {}


def test_height_is_a_coordinate(path):
    cloud = host.read_cloud(path, colour=ColourBy("height", up="z"))
    low, high = SPHERE[:, 2].min(), SPHERE[:, 2].max()
    assert_near(cloud.colours, by_map(SPHERE[:, 2], "viridis", low, high))
    assert cloud.colour_key["range"] == pytest.approx([low, high], abs=1e-6)
    assert cloud.colour_key["up"] == "z"
    assert not any("colour" in meaning for meaning in cloud.used.values())


def test_intensity_is_grey_as_it_is_without_colours(path):
    cloud = host.read_cloud(path, colour="intensity")
    low, high = np.percentile(INTENSITY, (1, 99))
    grey = 40 + 195 * np.clip((INTENSITY - low) / (high - low), 0, 1)
    assert np.abs(cloud.colours - grey[:, np.newaxis]).max() <= 0.51
    assert cloud.used["Intensity"] == "intensity, as grey"
    assert set(RGB) <= set(cloud.ignored)
    assert cloud.notes == ()


def test_intensity_along_a_map(path):
    cloud = host.read_cloud(path, colour=ColourBy("intensity", "magma", (200.0, 800.0)))
    assert_near(cloud.colours, by_map(INTENSITY, "magma", 200.0, 800.0))
    assert cloud.used["Intensity"] == "intensity, as colour"


def test_classes(path):
    cloud = host.read_cloud(path, colour="classification")
    right = np.array([CLASSES[int(number)][1] for number in CLASS], np.uint8)
    assert np.array_equal(cloud.colours, right)
    assert [item["points"] for item in cloud.colour_key["classes"]] == [20, 20, 20]
    assert cloud.used["classification"] == "class, as colour"


@pytest.mark.parametrize("name", ["quality", "QUALITY", " Quality "])
def test_a_column_by_its_name(path, name):
    cloud = host.read_cloud(path, colour=ColourBy(name, range=(-1.0, 1.0)))
    assert_near(cloud.colours, by_map(QUALITY, "viridis", -1.0, 1.0))
    assert cloud.used["Quality"] == "value, as colour"
    assert {"Intensity", "classification"} <= set(cloud.ignored)


def test_the_file_lacks_the_field(path):
    with pytest.raises(InputError, match="has no field 'return_number'; its fields are ") as caught:
        host.read_cloud(path, colour="return_number")
    for name in (*NAMES, *RGB):
        assert name in str(caught.value)


def test_the_file_lacks_colours(bare):
    with pytest.raises(InputError, match="has no colours; its fields are ") as caught:
        host.read_cloud(bare, colour="rgb")
    assert "Quality" in str(caught.value)


@pytest.mark.parametrize("kind", ["intensity", "classification"])
def test_the_file_lacks_what_is_known_by_name(tmp_path, kind):
    place = tmp_path / "a.ply"
    place.write_bytes(ply(XYZ_PLY, SPHERE.T))
    with pytest.raises(InputError, match=f"has no {kind}; its fields are x, y, z"):
        host.read_cloud(place, colour=kind)


def test_without_the_option_colours_come_first(path):
    assert np.array_equal(host.read_cloud(path).colours, COLOURS)


def test_without_the_option_and_colours_an_intensity_is_grey(bare):
    without = host.read_cloud(bare)
    assert without.used["Intensity"] == "intensity, as grey"
    assert np.array_equal(without.colours, host.read_cloud(bare, colour="intensity").colours)


def test_a_coordinate_and_a_normal_may_colour_too(tmp_path):
    place = tmp_path / "a.csv"
    place.write_text("x,y,z,nx,ny,nz\n" + text(SPHERE, SPHERE, delimiter=","))
    for name, column in (("Y", 1), ("nz", 2)):
        cloud = host.read_cloud(place, colour=ColourBy(name, range=(-1.0, 1.0)))
        assert_sphere(cloud)
        assert np.array_equal(cloud.colours, by_map(SPHERE[:, column], "viridis", -1.0, 1.0))
        assert not cloud.two_sided.any()
    assert cloud.used["nz"] == "normal; value, as colour"


def test_cloudcompares_prefix_may_be_left_out(tmp_path):
    place = tmp_path / "a.ply"
    place.write_bytes(ply([*XYZ_PLY, "float scalar_Quality"], [*SPHERE.T, QUALITY]))
    cloud = host.read_cloud(place, colour="quality")
    assert cloud.used["scalar_Quality"] == "value, as colour"
    assert cloud.colour_key["by"] == "quality"


@pytest.mark.parametrize("kind", ["intensity", "column 4", "Column_4"])
@pytest.mark.parametrize("suffix", [".xyz", ".pts", ".txt"])
def test_columns_without_names_are_numbered(tmp_path, kind, suffix):
    place = tmp_path / f"a{suffix}"
    place.write_text(text(SPHERE, INTENSITY))
    cloud = host.read_cloud(place, colour=ColourBy(kind, "viridis", (0.0, 1000.0)))
    assert np.array_equal(cloud.colours, by_map(INTENSITY, "viridis", 0.0, 1000.0))
    assert cloud.notes == ()
    assert "as colour" in cloud.used["column 4"]
    np.save(tmp_path / "a.npy", np.column_stack([SPHERE, INTENSITY]))
    other = host.read_cloud(tmp_path / "a.npy", colour=ColourBy(kind, "viridis", (0.0, 1000.0)))
    assert np.array_equal(other.colours, cloud.colours)


def test_seven_columns_without_names_have_an_intensity(tmp_path):
    place = tmp_path / "a.txt"
    for columns in ((INTENSITY, COLOURS), (COLOURS, INTENSITY)):
        place.write_text(text(SPHERE, *columns))
        grey = host.read_cloud(place, colour="intensity")
        assert (grey.colours[:, :1] == grey.colours).all()
        assert (np.diff(grey.colours[:, 0].astype(int)) >= 0).all()
        assert np.array_equal(host.read_cloud(place, colour="rgb").colours, COLOURS)
        high = host.read_cloud(place, colour=ColourBy("height", up="z"))
        assert high.colour_key["by"] == "height"


@pytest.mark.parametrize("kind", ["rgb", "intensity", "classification", "column 9", "time"])
def test_columns_without_names_may_lack_it(tmp_path, kind):
    place = tmp_path / "a.xyz"
    place.write_text(text(SPHERE))
    with pytest.raises(InputError, match="its fields are column 1, column 2, column 3"):
        host.read_cloud(place, colour=kind)


def test_a_column_of_words_is_no_field(tmp_path):
    place = tmp_path / "a.csv"
    place.write_text("x,y,z,kind,time\n" + "".join(f"{i},1,2,tree,{i}\n" for i in range(9)))
    assert host.read_cloud(place, colour="time").used["time"] == "value, as colour"
    with pytest.raises(InputError, match="no field 'kind'; its fields are x, y, z, time"):
        host.read_cloud(place, colour="kind")


def test_a_value_that_is_missing_in_a_text_is_neutral(tmp_path):
    place = tmp_path / "a.csv"
    lines = [f"{i},0,{i % 3},{'' if i == 4 else i}\n" for i in range(9)]
    place.write_text("x,y,z,time\n" + "".join(lines))
    cloud = host.read_cloud(place, colour="time")
    assert cloud.colours[4].tolist() == list(CLAY)
    assert cloud.colour_key["without_value"] == 1


def test_points_that_are_dropped_count_for_nothing(tmp_path):
    place = tmp_path / "a.csv"
    place.write_text("x,y,z,time,class\n0,0,0,1,2\nnan,0,0,1e6,6\n1,0,0,2,2\n0,1,0,3,9\n")
    cloud = host.read_cloud(place, colour="time")
    assert cloud.colour_key["range"] == pytest.approx([1.0, 3.0], abs=0.05)
    classes = host.read_cloud(place, colour="classification").colour_key["classes"]
    assert {item["class"]: item["points"] for item in classes} == {2: 2, 9: 1}


def test_a_stray_does_not_stretch_the_heights(tmp_path):
    place = tmp_path / "a.xyz"
    place.write_text(text(SPHERE) + "0 0 1e6\n")
    cloud = host.read_cloud(place, colour=ColourBy("height", up="z"))
    assert cloud.colour_key["range"] == pytest.approx([-1.0, 1.0], abs=0.02)


def test_an_array_of_another_length_is_no_field(tmp_path):
    np.savez(tmp_path / "a.npz", points=SPHERE, other=np.ones(3), flat=np.ones(COUNT, bool))
    with pytest.raises(InputError, match="no field 'other'; its fields are"):
        host.read_cloud(tmp_path / "a.npz", colour="other")


def test_a_map_that_does_not_exist_is_told_before_the_file_is_read():
    with pytest.raises(InputError, match="no colour map 'virid'"):
        host.read_cloud("absent.ply", colour=ColourBy("height", "virid"))


def test_matplotlib_is_imported_for_a_map_alone(tmp_path):
    place = tmp_path / "a.csv"
    place.write_text(dict(files())["a.csv"])
    script = (
        "import sys; from splatline import host\n"
        "for kind in (None, 'rgb', 'intensity', 'classification'):\n"
        "    host.read_cloud(sys.argv[1], colour=kind)\n"
        "assert 'matplotlib' not in sys.modules\n"
        "host.read_cloud(sys.argv[1], colour='height')\n"
        "assert 'matplotlib' in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", script, str(place)], check=True)


@pytest.mark.parametrize("pack", [bytes, laz])
@pytest.mark.parametrize("form", [3, 7])
def test_las_has_the_same_by_the_names_of_its_fields(tmp_path, pack, form):
    count = len(POSITIONS)
    classes = np.array([2, 5, 6])[np.arange(count) % 3]
    place = tmp_path / ("a.laz" if pack is laz else "a.las")
    place.write_bytes(pack(las(form, classes=classes)))
    grey = host.read_cloud(place, colour="intensity")
    assert (np.diff(grey.colours[:, 0].astype(int)) >= 0).all()  # it rises from point to point
    cloud = host.read_cloud(place, colour="classification")
    right = np.array([CLASSES[number][1] for number in classes], np.uint8)
    assert np.array_equal(cloud.colours, right)
    time = 0.25 * np.arange(count)
    cloud = host.read_cloud(place, colour=ColourBy("GPS_time", "turbo", (0.0, 15.0)))
    assert np.array_equal(cloud.colours, by_map(time, "turbo", 0.0, 15.0))
    high = host.read_cloud(place, colour=ColourBy("height", up="z"))
    lowest, highest = places_of()[:, 2].min(), places_of()[:, 2].max()
    assert high.colour_key["range"] == pytest.approx([lowest, highest], abs=1e-6)
    with pytest.raises(InputError, match="no field 'speed'; its fields are x, y, z, intensity"):
        host.read_cloud(place, colour="speed")
    with pytest.raises(InputError, match="has no colours; its fields are x, y, z"):
        place.write_bytes(pack(las(6)))
        host.read_cloud(place, colour="rgb")


def test_black_colours_of_las_are_drawn_if_they_are_asked_for(tmp_path):
    place = tmp_path / "a.las"
    place.write_bytes(las(2, colours=np.zeros((len(POSITIONS), 3), int)))
    assert host.read_cloud(place).used["intensity"] == "intensity, as grey"
    assert not host.read_cloud(place, colour="rgb").colours.any()


def test_las_decodes_what_is_asked_alone(tmp_path, monkeypatch):
    place = tmp_path / "a.las"
    place.write_bytes(las(7))
    asked = []
    real = read_las.Fields
    for module in (read_las, las_drawn):
        monkeypatch.setattr(
            module, "Fields", lambda header, names: asked.extend(names) or real(header, names)
        )
    host.read_cloud(place, colour="gps_time")
    assert set(asked) == {"x", "y", "z", "gps_time", "withheld", "classification"}
