"""Clouds are read as ``splatline render`` reads them, and recoloured quickly."""

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.presets import DEFAULT, PLANE
from splatline.host.files.wanted import ColourBy
from splatline.view.subject import Subject
from tests.view.views import write_ball


@pytest.fixture
def bare(tmp_path):
    """A ball without normals, with a point far away and a column."""
    whole = np.loadtxt(write_ball(tmp_path / "whole.csv"), delimiter=",", skiprows=1)
    rows = np.vstack([whole[:, [0, 1, 2, 9]], [1e4, 0.0, 0.0, 0.5]])
    path = tmp_path / "bare.csv"
    np.savetxt(path, rows, fmt="%.6f", delimiter=",", header="x,y,z,warmth", comments="")
    return path


@pytest.mark.parametrize("fit", ["bulk", "all"])
@pytest.mark.parametrize("colour", [ColourBy("warmth", "turbo"), ColourBy("height"), None])
def test_a_recoloured_cloud_is_the_one_that_is_read_anew(bare, fit, colour):
    subject = Subject(path=bare, name="bare", up="z", fit=fit)
    base = subject.read(ColourBy("warmth", "gray"))
    assert base.far_away == (1 if fit == "bulk" else 0)
    quick, anew = subject.read(colour, base=base), subject.read(colour)
    for name in ("positions", "normals", "colours", "two_sided", "origin"):
        assert np.array_equal(getattr(quick.cloud, name), getattr(anew.cloud, name))
    assert quick.cloud.colour_key == anew.cloud.colour_key
    assert np.array_equal(quick.discs.radii, anew.discs.radii)
    assert quick.far_away == anew.far_away
    assert quick.cloud.positions is base.cloud.positions


def test_a_file_that_changed_is_not_recoloured(bare):
    subject = Subject(path=bare, name="bare")
    base = subject.read(None)
    bare.write_text("".join(bare.read_text().splitlines(keepends=True)[:100]))
    with pytest.raises(InputError, match="other points"):
        subject.read(None, base=base)


def test_an_index_is_built_once_for_each_palette(bare):
    live = Subject(path=bare, name="bare").read(None)
    assert not live.has_index(DEFAULT)
    assert live.index(DEFAULT) is live.index(DEFAULT.replace(name="other"))
    assert live.has_index(DEFAULT)
    assert not live.has_index(PLANE)
    assert live.index(PLANE) is not live.index(DEFAULT)


def test_colours_are_the_file_s_columns_of_numbers(bare, tmp_path):
    assert [row["by"] for row in Subject(path=bare).colours()] == ["default", "height", "warmth"]
    assert [row["by"] for row in Subject().colours()] == ["default", "height"]
    gone = Subject(path=tmp_path / "gone.ply")
    assert [row["by"] for row in gone.colours()] == ["default", "height"]


@pytest.mark.parametrize("scene", ["terrain", "knot"])
def test_scenes_are_recoloured_by_height_alone(scene):
    subject = Subject(scene=scene, name=scene, up="z")
    plain, high = subject.read(None), subject.read(ColourBy("height", "magma"))
    assert not np.array_equal(plain.cloud.colours, high.cloud.colours)
    with pytest.raises(InputError, match="has no field"):
        subject.read(ColourBy("intensity"))


def test_a_target_is_looked_at_first(bare):
    subject = Subject(path=bare, target=(1.0, 2.0, 3.0), distance=4.0, orbit=(5.0, 6.0), fov=7.0)
    camera = subject.home(subject.read(None), (40, 30))
    assert (camera.target, camera.distance, camera.orbit) == ((1.0, 2.0, 3.0), 4.0, (5.0, 6.0))
    assert (camera.up, camera.fov) == ("y", 7.0)
