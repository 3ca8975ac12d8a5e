"""What colours a point can be asked for in every format with columns of its own."""

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.readers import read_cloud
from tests.host.files.cloud_files import COLOURS, COUNT, POSITIONS
from tests.host.files.e57_files import colours, coordinates, e57
from tests.host.files.gaussian_files import gaussians, ply_bytes
from tests.host.files.kinds import ptx
from tests.host.files.las_files import las, laz
from tests.host.files.mesh_files import COLOURS as MESH_COLOURS
from tests.host.files.mesh_files import obj

VALUES = np.arange(COUNT)

FILES = {
    "a.e57": e57(coordinates(POSITIONS) | colours(COLOURS) | {"intensity": ("f", VALUES)}),
    "a.ptx": ptx(POSITIONS, VALUES, COLOURS).encode(),
    "a.laz": laz(las(7)),
    "a.ply": ply_bytes(gaussians(opacity=np.full(COUNT, 5.0))),
    "a.obj": obj(MESH_COLOURS),
}


def read(folder, name, colour):
    path = folder / name
    path.write_bytes(FILES[name])
    return read_cloud(path, colour=colour)


@pytest.mark.parametrize("name", FILES)
def test_height_and_any_column(tmp_path, name):
    for field, by in (("height", "height"), ("x", "x"), ("z", "z")):
        cloud = read(tmp_path, name, field)
        assert cloud.colour_key["by"] == by
        low, high = cloud.colour_key["range"]
        assert low < high
        assert len(np.unique(cloud.colours, axis=0)) > 1


@pytest.mark.parametrize("name", ["a.e57", "a.ptx", "a.laz"])
def test_the_intensity_though_there_are_colours(tmp_path, name):
    cloud = read(tmp_path, name, "intensity")
    assert (np.diff(cloud.colours[:, 0].astype(int)) >= 0).all()
    assert (cloud.colours[:, 0] == cloud.colours[:, 1]).all()


@pytest.mark.parametrize("name", FILES)
def test_a_field_that_is_missing_is_said(tmp_path, name):
    with pytest.raises(InputError, match="has no field 'nothing'; its fields are x, y, z"):
        read(tmp_path, name, "nothing")


def test_splats_keep_their_discs_whatever_colours_them(tmp_path):
    usual, by_field = (read(tmp_path, "a.ply", colour) for colour in (None, "f_rest_3"))
    assert np.array_equal(usual.radii, by_field.radii)
    assert np.array_equal(usual.normals, by_field.normals)
