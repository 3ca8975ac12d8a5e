"""Returns that found nothing, at exactly 0, 0, 0, in every format and in files read in parts."""

import functools
import io

import laspy
import numpy as np
import plyfile
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.empty_returns import EMPTY_NOTE
from splatline.host.files.readers import read_cloud
from splatline.host.files.survey import survey
from splatline.host.large import pieces
from splatline.host.large.draw_parts import Drawing, draw_parts
from splatline.host.large.plan import make_plan
from splatline.host.visibility.view import fit_view
from tests.host.files.e57_files import coordinates, e57, pose
from tests.host.files.kinds import COLOURS, COUNT, RGB_PLY, SPHERE, XYZ_PCD, XYZ_PLY, pcd, ply, ptx
from tests.host.files.kinds import text as rows_of
from tests.host.large.test_draw_parts import hills, write_las
from tests.host.large.test_ply_pieces import faces

ZEROS = 500
ORDER = np.random.default_rng(3).permutation(COUNT + ZEROS)
POINTS = np.vstack([SPHERE, np.zeros((ZEROS, 3))])[ORDER]
RGB = np.vstack([COLOURS, np.zeros((ZEROS, 3), np.uint8)])[ORDER]
GREY = np.append(np.arange(COUNT) + 100.0, np.zeros(ZEROS))[ORDER]
SEEN = ORDER < COUNT


def npz(**arrays):
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def named(points, grey):
    return "x,y,z,intensity\n" + rows_of(points, grey, delimiter=",")


PCD_RGB = [f"{name} F 4 1" for name in "rgb"]

FORMATS = {
    "a.npz": lambda p, g, c: npz(points=p, colors=c),
    "b.npz": lambda p, g, c: npz(x=p[:, 0], y=p[:, 1], z=p[:, 2], intensity=g),
    "a.npy": lambda p, g, c: npy(np.hstack([p, c])),
    "a.xyz": lambda p, g, c: rows_of(p, c),
    "a.pts": lambda p, g, c: rows_of(p, g),
    "a.csv": lambda p, g, c: named(p, g),
    "a.ply": lambda p, g, c: ply([*XYZ_PLY, *RGB_PLY], [*p.T, *c.T]),
    "b.ply": lambda p, g, c: ply([*XYZ_PLY, "float intensity"], [*p.T, g]),
    "c.ply": lambda p, g, c: ply([*XYZ_PLY, *RGB_PLY], [*p.T, *c.T], kind="ascii"),
    "a.e57": lambda p, g, c: e57(coordinates(p)),
}


def read(folder, name, content, **options):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_cloud(path, **options)


@pytest.mark.parametrize("name", FORMATS)
def test_they_are_left_out_and_counted_and_the_rest_is_as_without_them(tmp_path, name):
    cloud = read(tmp_path, name, FORMATS[name](POINTS, GREY, RGB))
    other = read(tmp_path, name, FORMATS[name](POINTS[SEEN], GREY[SEEN], RGB[SEEN]))
    assert len(cloud) == len(other) == COUNT
    assert cloud.dropped == {"non_finite": 0, "empty": ZEROS}
    assert other.dropped == {"non_finite": 0}
    assert EMPTY_NOTE in cloud.notes
    assert EMPTY_NOTE not in other.notes
    for array in ("positions", "normals", "colours", "origin"):
        assert np.array_equal(getattr(cloud, array), getattr(other, array)), array


@pytest.mark.parametrize("name", FORMATS)
def test_they_are_drawn_if_they_are_kept(tmp_path, name):
    content = FORMATS[name](POINTS, GREY, RGB)
    cloud = read(tmp_path, name, content, keep=frozenset({"empty"}))
    assert len(cloud) == COUNT + ZEROS
    assert cloud.dropped == {"non_finite": 0}
    assert EMPTY_NOTE not in cloud.notes


def test_one_point_at_the_origin_is_a_point(tmp_path):
    one = np.vstack([SPHERE, np.zeros((1, 3))])
    assert len(read(tmp_path, "a.npz", npz(points=one))) == COUNT + 1


def test_other_points_at_one_position_stay(tmp_path):
    many = np.vstack([SPHERE, np.tile([0.0, 0.0, 1e-30], (ZEROS, 1))])
    assert len(read(tmp_path, "a.npz", npz(points=many))) == COUNT + ZEROS


def test_of_a_pcd_too(tmp_path):
    points = SPHERE.copy()
    points[5:9] = 0.0
    cloud = read(tmp_path, "a.pcd", pcd([*XYZ_PCD, *PCD_RGB], [*points.T, *COLOURS.T / 255.0]))
    assert cloud.dropped["empty"] == 4


def test_scans_are_looked_at_before_their_poses(tmp_path):
    moved = pose((1.0, 0.0, 0.0, 0.0), (-SPHERE[0]).tolist())  # a point comes to lie at 0, 0, 0
    twice = e57(*2 * [coordinates(POINTS) | {"pose": moved}])
    cloud = read(tmp_path, "a.e57", twice)
    assert len(cloud) == 2 * COUNT
    assert cloud.dropped == {"non_finite": 0, "empty": 2 * ZEROS}
    points = SPHERE.copy()
    points[3:9] = 0.0
    kept = read(tmp_path, "a.ptx", ptx(points, COLOURS[:, 0] / 255), keep=frozenset({"empty"}))
    assert len(kept) == COUNT


def test_vertices_of_a_mesh_are_no_returns(tmp_path):
    corner = "".join(f"v {'0 0 0' if i % 4 == 0 else f'{i} {i % 3} 1'}\n" for i in range(12))
    mesh = corner + "".join(f"f {i + 1} {i + 2} {i + 3}\n" for i in range(10))
    assert len(read(tmp_path, "a.obj", mesh)) == 12


def test_nothing_but_empty_returns_is_an_error(tmp_path):
    with pytest.raises(InputError, match="has no points but 60 at exactly 0, 0, 0; see --keep"):
        read(tmp_path, "a.npz", npz(points=np.zeros((60, 3))))
    with pytest.raises(InputError, match="has no points but 60 at exactly"):
        read(tmp_path, "a.xyz", rows_of(np.zeros((60, 3))))


def test_info_counts_them_and_its_ranges_are_of_the_others(tmp_path):
    (tmp_path / "a.ply").write_bytes(FORMATS["b.ply"](POINTS, GREY, RGB))
    facts = survey(tmp_path / "a.ply")
    assert facts["dropped"] == {"non_finite": 0, "empty": ZEROS}
    assert facts["notes"] == [EMPTY_NOTE]
    assert facts["fields"][3]["low"] == 100.0


SCAN = 30_000


def with_zeros(folder, name, zeros):
    """Hills about the origin, in a file that can be read in parts, with returns at 0, 0, 0."""
    positions, colours = hills(SCAN, 3)
    positions = positions - positions.mean(axis=0) + [0.0, 0.0, 3.0]
    positions[::10][:zeros] = 0.0
    if name.endswith(".ply"):
        content = ply([*XYZ_PLY, *RGB_PLY], [*positions.T, *(colours.T >> 8)])
        (folder / name).write_bytes(content)
        return folder / name
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales, header.offsets = [0.001] * 3, [0.0] * 3
    las = laspy.LasData(header)
    las.x, las.y, las.z = positions.T
    las.red, las.green, las.blue = colours.T
    las.write(folder / name)
    return folder / name


@pytest.mark.parametrize("name", ["a.ply", "a.las", "a.laz"])
@pytest.mark.parametrize("zeros", [0, 3000])
def test_parts_leave_them_out_as_the_whole_does(tmp_path, monkeypatch, name, zeros):
    monkeypatch.setattr(pieces, "PIECE", 7_000)
    path = with_zeros(tmp_path, name, zeros)
    whole = read_cloud(path, estimate=False)
    assert whole.dropped == {"non_finite": 0, **({"empty": zeros} if zeros else {})}
    fit = functools.partial(fit_view, size=(96, 80), up="z")
    for keep, found in ((frozenset(), zeros), (frozenset({"empty"}), 0)):
        joined = draw_parts(make_plan([path], None, fit, 64, keep=keep), Drawing())
        assert joined.dropped.get("empty", 0) == found
        assert (EMPTY_NOTE in joined.notes) == (found > 0)


def test_las_integers_of_zero_at_an_offset_are_points(tmp_path):
    positions, colours = hills(SCAN, 3)
    positions[::10] = 5e5, 5e6, 0.0  # the offsets
    path = write_las(tmp_path / "a.laz", positions, colours)
    assert read_cloud(path, estimate=False).dropped == {"non_finite": 0}


def test_vertices_of_a_mesh_in_parts_are_no_returns(tmp_path):
    rows = np.zeros(COUNT, [(name, "f4") for name in "xyz"])
    rows["x"][::3] = 1.0
    vertices = plyfile.PlyElement.describe(rows, "vertex")
    plyfile.PlyData([vertices, faces()]).write(str(tmp_path / "a.ply"))
    file = pieces.PieceFile(tmp_path / "a.ply", None)
    assert len(file.sample().columns.positions) == COUNT
    assert sum(len(piece.positions) for piece in file.pieces()) == COUNT
    assert len(read_cloud(tmp_path / "a.ply", estimate=False)) == COUNT
