import struct
from pathlib import Path

import laspy
import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.copc import copc_sample, copc_tables, read_octree
from splatline.host.files.las_header import read_las_header
from splatline.host.files.readers import open_cloud_file, parser_errors, read_cloud
from tests.support.copc_files import INFO_AT, info_of, make_hills, pages_of

COUNT = 40_000
NAMES = ("x", "y", "z", "gps_time", "red")


@pytest.fixture(scope="module")
def hills(tmp_path_factory):
    classes = np.full(COUNT, 2)
    classes[:700] = 7  # noise
    return make_hills(tmp_path_factory.mktemp("copc"), COUNT, leaf=300, classification=classes)


def read(path: Path, points=5000, chosen=slice(None)):
    """The octree, and the tables of some of its nodes."""
    with open_cloud_file(path) as source, parser_errors(source):
        header = read_las_header(source)
        octree = read_octree(source, header)
        if octree is None:
            return None, []
        return octree, list(copc_tables(source, header, octree.nodes[chosen], NAMES, points))


def test_the_nodes_are_those_that_laspy_finds(hills):
    octree, _ = read(hills[1])
    with laspy.CopcReader.open(hills[1]) as reader:
        info = reader.copc_info
        assert np.allclose(octree.corner, info.center - info.halfsize)
        assert (octree.side, octree.spacing) == (2 * info.halfsize, info.spacing)
        for level in range(octree.nodes["level"].max() + 1):
            counts = octree.nodes["count"][octree.nodes["level"] == level]
            assert counts.sum() == len(reader.level_query(level)) > 0
    assert len(np.unique(octree.nodes["level"])) >= 3
    assert pages_of(hills[1].read_bytes())["count"].min() == -1  # there are several pages


@pytest.mark.parametrize("points", [1, 5000, 1 << 20])
def test_all_nodes_together_are_the_points_of_the_file(hills, points):
    octree, found = read(hills[1], points)
    table = {name: np.concatenate([table[name] for table, _ in found]) for name in NAMES}
    order = np.argsort(table["gps_time"])
    las = laspy.read(hills[0])
    drawn = np.asarray(las.classification) != 7
    for name in NAMES:
        assert np.array_equal(table[name][order], np.asarray(las[name])[drawn])
    assert sum(dropped.get("noise", 0) for _, dropped in found) == 700
    assert (len(found) == len(octree.nodes)) == (points == 1)


def test_read_as_plain_laz_it_has_the_same_points(hills):
    plain, octree = (laspy.read(path).points.array for path in hills)
    assert np.array_equal(np.sort(octree, order="gps_time"), plain)
    assert len(read_cloud(hills[1]).positions) == COUNT - 700


def test_points_lie_in_the_cubes_of_their_nodes_one_a_cell(hills):
    octree, found = read(hills[1], 1)
    corners, sides = octree.cubes()
    leaves = 0
    for (table, _), corner, side in zip(found, corners, sides, strict=True):
        places = (np.stack([table[axis] for axis in "xyz"], axis=1) - corner) / side
        assert places.min() > -1e-6
        assert places.max() < 1 + 1e-6
        cells = np.floor(places * 128).astype(int)
        several = len(np.unique(cells, axis=0)) < len(cells)
        assert not several or len(cells) <= 300
        leaves += several
    assert leaves


def test_a_sample_is_the_coarsest_levels(hills):
    with open_cloud_file(hills[1]) as source:
        header = read_las_header(source)
        octree = read_octree(source, header)
        levels = octree.nodes["level"]
        few = int(octree.nodes["count"][levels < 2].sum())
        sample = copc_sample(source, header, octree, ("x", "intensity"), few)
        assert few - 700 <= len(sample["x"]) <= few
        least = copc_sample(source, header, octree, ("x", "intensity"), 50)
        assert 0 < len(least["x"]) <= 50
        assert sample["intensity"].dtype == np.uint16


def test_other_files_have_no_octree(hills):
    assert read(hills[0])[0] is None


def entry(which, field, value):
    def edit(data):
        entries = pages_of(data)
        entries[field][np.flatnonzero(which(entries))[0]] = value(entries, info_of(data))

    return edit


def info(at, form, *values):
    return lambda data: struct.pack_into(form, data, INFO_AT + at, *values)


def node(entries):
    return entries["count"] > 0


def page(entries):
    return entries["count"] == -1


def layers(data):
    nodes = pages_of(data)
    struct.pack_into("<I", data, int(nodes["offset"][0]) + 36 + 4, 0xFFFFFFF0)


def twins(data):
    entries = pages_of(data)
    one, two = np.flatnonzero(node(entries) & (entries["level"] == 1))[:2]
    for axis in "xyz":
        entries[axis][one] = entries[axis][two]


NO_NODE = "has nodes that no octree has"
OVERLAP = "has nodes that overlap, or end outside"
DAMAGED = {
    "no finite centre": (info(8, "<d", np.nan), "has an octree without a size"),
    "no size": (info(24, "<d", 0.0), "has an octree without a size"),
    "no spacing": (info(32, "<d", -1.0), "has an octree without a size"),
    "moved": (info(0, "<d", 0.0), "has an octree that does not hold its bounds"),
    "root far away": (info(40, "<Q", 1 << 63), "has a page of its octree outside"),
    "large root": (info(48, "<Q", 1 << 62), "has a page of its octree outside"),
    "empty root": (info(48, "<Q", 0), "has a page of its octree outside"),
    "odd root": (info(48, "<Q", 33), "has a page of its octree outside"),
    "page far away": (
        entry(page, "offset", lambda *_: (1 << 64) - 32), "has a page of its octree outside",
    ),
    "negative page": (entry(page, "size", lambda *_: -32), "has a page of its octree outside"),
    "loop": (entry(page, "offset", lambda _, info: info[3]), "has pages .* that hold one another"),
    "one page twice": (
        entry(page, "offset", lambda entries, _: entries["offset"][page(entries)][1]),
        "has pages .* that hold one another",
    ),
    "negative level": (entry(node, "level", lambda *_: -1), NO_NODE),
    "deep level": (entry(node, "level", lambda *_: 31), NO_NODE),
    "beside the root": (entry(node, "x", lambda *_: 1), NO_NODE),
    "negative count": (entry(node, "count", lambda *_: -2), NO_NODE),
    "more points": (
        entry(node, "count", lambda *_: 2**31 - 1), "promises 40,000 points, but its octree holds",
    ),
    "fewer points": (
        entry(node, "count", lambda *_: 1), "promises 40,000 points, but its octree holds",
    ),
    "chunk far away": (entry(node, "offset", lambda *_: 1 << 63), "has nodes outside of the file"),
    "chunk in the header": (entry(node, "offset", lambda *_: 8), "has nodes outside of the file"),
    "long chunk": (entry(node, "size", lambda *_: 2**31 - 1), OVERLAP),
    "short chunk": (entry(node, "size", lambda *_: 36), OVERLAP),
    "negative chunk": (entry(node, "size", lambda *_: -1), OVERLAP),
    "twins": (twins, "has two nodes at one place"),
    "long layers": (layers, "has chunks that are shorter than their layers"),
}  # fmt: skip


@pytest.mark.parametrize("case", DAMAGED)
def test_a_damaged_octree_is_one_line(hills, tmp_path, case):
    edit, message = DAMAGED[case]
    data = bytearray(hills[1].read_bytes())
    edit(data)
    path = tmp_path / "damaged.copc.laz"
    path.write_bytes(data)
    with pytest.raises(InputError, match=rf"damaged\.copc\.laz: {message}") as caught:
        read(path)
    assert "\n" not in str(caught.value)


def test_a_truncated_file_is_one_line(hills, tmp_path):
    data = hills[1].read_bytes()
    path = tmp_path / "cut.copc.laz"
    for share in (0.1, 0.5, 0.9, 0.999):
        path.write_bytes(data[: int(share * len(data))])
        with pytest.raises(InputError, match=r"cut\.copc\.laz: has a page of its octree outside"):
            read(path)


def test_damaged_bytes_are_an_error_or_other_points(hills, tmp_path):
    good = hills[1].read_bytes()
    rng = np.random.default_rng(5)
    path = tmp_path / "damaged.copc.laz"
    for _ in range(60):
        data = bytearray(good)
        at = int(rng.choice([rng.integers(375, 1000), rng.integers(1000, len(data))]))
        data[at] ^= 1 << int(rng.integers(8))
        path.write_bytes(data)
        try:
            octree, found = read(path)
        except InputError as error:
            assert "\n" not in str(error)
        else:
            total = sum(len(table["x"]) + sum(dropped.values()) for table, dropped in found)
            assert octree is None or total == COUNT
