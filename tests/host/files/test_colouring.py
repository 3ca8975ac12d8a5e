"""Values as colours: right ones are matplotlib's own, or computed by hand."""

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import Normalize

from splatline import host
from splatline.contract.errors import InputError
from splatline.host.files.asprs import CLASSES, class_colours
from splatline.host.files.colouring import check_map, colour_values, heights
from splatline.host.files.colours import NEUTRAL
from splatline.host.files.wanted import ColourBy

VALUES = np.random.default_rng(4).normal(50.0, 20.0, 5000)


def by_matplotlib(values, name, low, high):
    return mpl.colormaps[name](Normalize(low, high, clip=True)(values), bytes=True)[:, :3]


@pytest.mark.parametrize("name", ["viridis", "turbo", "gray_r", "tab10"])
@pytest.mark.parametrize("kind", [np.float64, np.float32, np.uint16, np.int8])
def test_a_map_is_matplotlibs(name, kind):
    values = np.clip(VALUES, 0, 120).astype(kind)
    coloured = colour_values(values, ColourBy("quality", name, (10.0, 90.0)))
    right = by_matplotlib(values.astype(float), name, 10.0, 90.0)
    assert np.array_equal(coloured.colours, right)
    assert coloured.key == {
        "by": "quality",
        "map": name,
        "range": [10.0, 90.0],
        "without_value": 0,
    }


@pytest.mark.parametrize("field", ["quality", "intensity"])
def test_the_range_of_a_field_is_that_of_98_percent(field):
    values = np.arange(101.0)
    values[[0, 100]] = -1e6, 1e6
    coloured = colour_values(values, ColourBy(field, "viridis"))
    assert coloured.key["range"] == [1.0, 99.0]
    assert np.array_equal(coloured.colours, by_matplotlib(values, "viridis", 1.0, 99.0))
    # By hand: the ends of viridis are #440154 and #fde725.
    assert coloured.colours[[0, 1, 99, 100]].tolist() == 2 * [[68, 1, 84]] + 2 * [[253, 231, 36]]


def test_a_field_of_two_values_that_are_rare_has_the_range_of_both():
    values = np.zeros(1000)
    values[3] = 7.0
    assert colour_values(values, ColourBy("flag")).key["range"] == [0.0, 7.0]


def test_the_range_of_heights_is_that_of_the_usual_points():
    values = np.array([5.0, 1.0, 900.0, 3.0])
    usual = np.array([True, True, False, True])
    coloured = colour_values(values, ColourBy("height"), usual)
    assert coloured.key["range"] == [1.0, 5.0]
    assert np.array_equal(coloured.colours, by_matplotlib(values, "viridis", 1.0, 5.0))


def test_an_intensity_without_a_map_is_grey():
    values = np.linspace(0.0, 100.0, 5)
    coloured = colour_values(values, ColourBy("intensity", range=(0.0, 50.0)))
    assert coloured.colours[:, 0].tolist() == [40, 138, 235, 235, 235]
    assert coloured.key["map"] == "grey"


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e300])
@pytest.mark.parametrize("field", ["quality", "intensity", "classification", "height"])
def test_a_value_that_is_none_is_neutral_and_counted(bad, field):
    values = np.array([1.0, bad, 2.0, 3.0])
    coloured = colour_values(values, ColourBy(field))
    assert coloured.colours[1].tolist() == list(NEUTRAL)
    assert coloured.key["without_value"] == 1
    rest = colour_values(values[[0, 2, 3]], ColourBy(field))
    assert np.array_equal(coloured.colours[[0, 2, 3]], rest.colours)


@pytest.mark.parametrize("field", ["quality", "intensity", "height"])
def test_without_any_value_every_point_is_neutral(field):
    coloured = colour_values(np.full(3, np.nan), ColourBy(field))
    assert (coloured.colours == NEUTRAL).all()
    assert coloured.key["range"] is None
    assert coloured.key["without_value"] == 3


@pytest.mark.parametrize("field", ["quality", "height"])
def test_a_constant_field_has_the_middle_of_the_map(field):
    coloured = colour_values(np.full(3, 8), ColourBy(field, "gray"))
    assert coloured.colours.tolist() == [[128, 128, 128]] * 3
    assert coloured.key["range"] == [8.0, 8.0]


def test_a_constant_intensity_is_neutral_as_without_the_option():
    assert (colour_values(np.full(3, 8), ColourBy("intensity")).colours == NEUTRAL).all()


def test_classes_have_their_colours_and_a_key():
    values = np.array([2, 6, 2, 200, 9, 2.5, 2], float)
    coloured = colour_values(values, ColourBy("Classification"))
    ground, building, water = (CLASSES[number][1] for number in (2, 6, 9))
    colours = [tuple(row) for row in coloured.colours.tolist()]
    assert [colours[i] for i in (0, 1, 2, 4, 6)] == [ground, building, ground, water, ground]
    assert colours[5] == NEUTRAL
    key = coloured.key
    assert key["by"] == "classification"
    assert key["without_value"] == 1
    assert [item["class"] for item in key["classes"]] == [2, 6, 9, 200]
    assert [item["points"] for item in key["classes"]] == [3, 1, 1, 1]
    assert key["classes"][0] | {"colour": ""} == {
        "class": 2, "name": "ground", "points": 3, "colour": ""
    }  # fmt: skip
    assert key["classes"][0]["colour"] == "#{:02x}{:02x}{:02x}".format(*ground)
    assert key["classes"][3]["name"] == ""


def test_all_classes_of_a_byte_differ():
    colours = class_colours(np.arange(256)).astype(int)
    far = np.abs(colours[:, None] - colours[None]).sum(axis=2)
    assert (far[~np.eye(256, dtype=bool)] > 0).all()
    assert far[:23, :23][~np.eye(23, dtype=bool)].min() > 30  # those of the standard, clearly
    follow = np.abs(np.diff(colours[23:], axis=0)).sum(axis=1)
    assert follow.min() > 100


def test_usual_colours_are_what_their_names_say():
    red, green, blue = class_colours(np.array([6, 4, 9])).astype(int)
    assert red.argmax() == 0
    assert green.argmax() == 1
    assert blue.argmax() == 2
    ground = class_colours(np.array([2]))[0].astype(int)
    assert ground[0] > ground[1] > ground[2]  # brown


def test_many_classes_are_listed_by_their_points():
    values = np.concatenate([np.arange(1000), np.full(5, 999)])
    key = colour_values(values, ColourBy("classification")).key
    assert key["classes"][0]["class"] == 999
    assert (len(key["classes"]), key["other_classes"]) == (256, 744)


@pytest.mark.parametrize(("up", "right"), [("z", [13.0, 10.0]), ("-y", [-22.0, -25.0])])
def test_heights_are_in_the_files_coordinates(up, right):
    positions = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 0.0]])
    origin = np.array([0.0, 20.0, 10.0])
    assert heights(positions, origin, up).tolist() == right
    with pytest.raises(InputError, match="must be x, y, z"):
        heights(positions, origin, "up")


@pytest.mark.parametrize("name", ["viridi", "Turbo2", ""])
def test_a_map_that_does_not_exist_gets_a_few_names(name):
    with pytest.raises(InputError, match="there is no colour map") as caught:
        check_map(ColourBy("height", name))
    assert "viridis" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_maps_name_may_be_in_any_case():
    check_map(ColourBy("height", "VIRIDIS"))
    check_map(ColourBy("height", "brbg"))


def test_a_request_that_makes_no_sense_is_refused():
    for field in ("rgb", "classification"):
        with pytest.raises(InputError, match=f"colours by {field} need no map"):
            ColourBy(field, "viridis")
        with pytest.raises(InputError, match=f"colours by {field} need no range"):
            ColourBy(field, range=(0.0, 1.0))
    for ends in ((1.0, 1.0), (2.0, 1.0), (np.nan, 1.0), (0.0, np.inf)):
        with pytest.raises(InputError, match="the lower first"):
            ColourBy("height", range=ends)


def test_a_scene_has_heights_and_its_own_colours_alone():
    from splatline.host.files.colouring import colour_scene

    cloud = host.load_scene("knot").cloud
    assert colour_scene(cloud, ColourBy("rgb")) is cloud
    coloured = colour_scene(cloud, ColourBy("height", "turbo", up="y"))
    height = cloud.positions[:, 1] + cloud.origin[1]
    low, high = height.min(), height.max()
    assert np.array_equal(coloured.colours, by_matplotlib(height, "turbo", low, high))
    assert coloured.colour_key["range"] == [low, high]
    with pytest.raises(InputError, match="the scene knot has no field 'intensity'; it has rgb"):
        colour_scene(cloud, ColourBy("intensity"))
