"""LAS and LAZ files: by hand from the standard, packed by LASzip; chunks that differ by lazrs."""

import io
import struct

import laspy
import lazrs
import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.las_header import read_las_header
from splatline.host.files.read_las import las_sample, las_tables
from splatline.host.files.readers import read_cloud
from splatline.host.files.source import open_source
from tests.host.files.cloud_files import COLOURS, COUNT, NORMALS, places
from tests.host.files.las_files import GEO, OFFSETS, las, las_with_normals, laz, places_of

WITH_COLOURS = (2, 3, 5, 7, 8, 10)


def read(folder, data, name="a.las", **options):
    path = folder / name
    path.write_bytes(data)
    return read_cloud(path, **options)


def packed(data):
    """The file as LAZ with chunks of different sizes, as COPC has them."""
    (start,) = struct.unpack_from("<I", data, 96)
    form, length = struct.unpack_from("<BH", data, 104)
    vlr = lazrs.LazVlr.new_for_compression(form, 0, True)
    record = bytes(vlr.record_data())
    entry = struct.pack("<2x16sHH32x", b"laszip encoded", 22204, len(record)) + record
    head = bytearray(data[:start])
    struct.pack_into("<II", head, 96, start + len(entry), 1)
    head[104] |= 0x80
    stream = io.BytesIO()
    stream.write(bytes(head) + entry)
    compressor = lazrs.LasZipCompressor(stream, vlr)
    for piece in (slice(0, 7), slice(7, 40), slice(40, 60)):
        points = np.frombuffer(data[start:], np.uint8).reshape(-1, length)[piece]
        compressor.compress_many(points.tobytes())
        compressor.finish_current_chunk() if piece.stop < COUNT else compressor.done()
    return stream.getvalue()


@pytest.mark.parametrize("pack", [bytes, laz], ids=["las", "laz"])
@pytest.mark.parametrize("form", range(11))
def test_every_point_format(tmp_path, form, pack):
    cloud = read(tmp_path, pack(las(form)), "a.laz")
    assert places(cloud) == pytest.approx(places_of(), abs=1e-9, rel=0)
    if form in WITH_COLOURS:
        assert np.array_equal(cloud.colours, COLOURS)
    else:
        assert cloud.used["intensity"] == "intensity, as grey"
        assert len(np.unique(cloud.colours[:, 0])) > COUNT // 2


@pytest.mark.parametrize(
    ("minor", "form"), [(0, 0), (0, 1), (1, 1), (2, 3), (3, 3), (4, 0), (4, 7)]
)
def test_every_version(tmp_path, minor, form):
    cloud = read(tmp_path, las(form, minor))
    assert places(cloud) == pytest.approx(places_of(), abs=1e-9, rel=0)


def test_laspy_reads_the_same_of_the_files_by_hand():
    points = laspy.read(io.BytesIO(las(7)))
    assert np.array_equal(points.xyz, places_of())
    assert np.array_equal(points.red, COLOURS[:, 0].astype(int) * 257)


def test_map_coordinates_are_exact_to_the_millimetre(tmp_path):
    cloud = read(tmp_path, las(7))
    millimetres = np.rint((places(cloud) - OFFSETS) * 1000.0)
    assert np.array_equal(millimetres, GEO)
    steps = np.rint((cloud.positions - cloud.positions[0]) * 1000.0)
    assert np.array_equal(steps, GEO - GEO[0])
    assert np.abs(steps / 1000.0 - (cloud.positions - cloud.positions[0])).max() < 1e-8


def test_colours_may_be_bytes_in_fields_of_16_bits(tmp_path):
    cloud = read(tmp_path, las(3, colours=COLOURS))
    assert np.array_equal(cloud.colours, COLOURS)


def test_where_all_colours_are_black_the_intensity_is_drawn(tmp_path):
    for pack in (bytes, laz):
        cloud = read(tmp_path, pack(las(7, colours=np.zeros((COUNT, 3), int))), "a.laz")
        assert len(np.unique(cloud.colours[:, 0])) > COUNT // 2
        assert "all colours are black, so the intensity is drawn" in cloud.notes


@pytest.mark.parametrize("pack", [bytes, laz], ids=["las", "laz"])
@pytest.mark.parametrize("form", [1, 7])
def test_withheld_points_and_noise_are_left_out_and_counted(tmp_path, form, pack):
    flags, classes = np.zeros(COUNT, int), np.full(COUNT, 2)
    flags[:5] = 4
    flags[5:10] = 1  # synthetic
    classes[3:8] = 7
    classes[20:24] = 18
    cloud = read(tmp_path, pack(las(form, classes=classes, flags=flags)), "a.laz")
    kept = np.ones(COUNT, bool)
    kept[:8] = False
    kept[20:24] = form < 6  # its class 18 is no noise
    assert places(cloud) == pytest.approx(places_of()[kept], abs=1e-9, rel=0)
    noise = 3 if form < 6 else 7
    assert cloud.dropped == {"non_finite": 0, "withheld": 5, "noise": noise}


@pytest.mark.parametrize("pack", [bytes, laz], ids=["las", "laz"])
@pytest.mark.parametrize(
    ("keep", "dropped"),
    [({"noise"}, {"withheld": 5}), ({"withheld"}, {"noise": 9}), ({"noise", "withheld"}, {})],
)
def test_withheld_points_and_noise_are_drawn_if_they_are_kept(tmp_path, pack, keep, dropped):
    flags, classes = np.zeros(COUNT, int), np.full(COUNT, 2)
    flags[:5] = 4
    classes[3:8] = 7
    classes[20:24] = 18
    data = pack(las(7, classes=classes, flags=flags))
    cloud = read(tmp_path, data, "a.laz", keep=frozenset(keep))
    assert cloud.dropped == {"non_finite": 0, **dropped}
    assert len(cloud) == COUNT - sum(dropped.values())


def test_a_file_of_noise_alone_is_drawn_if_noise_is_kept(tmp_path):
    cloud = read(tmp_path, las(6, classes=np.full(COUNT, 18)), keep=frozenset({"noise"}))
    assert len(cloud) == COUNT


def test_the_first_version_has_no_flags(tmp_path):
    cloud = read(tmp_path, las(0, 0, classes=np.full(COUNT, 7), flags=np.full(COUNT, 4)))
    assert len(cloud) == COUNT


def test_a_file_of_noise_alone_says_so(tmp_path):
    with pytest.raises(
        InputError, match="has no points but 60 that are withheld or noise; see --keep"
    ):
        read(tmp_path, las(6, classes=np.full(COUNT, 18)))


@pytest.mark.parametrize("pack", [bytes, laz], ids=["las", "laz"])
@pytest.mark.parametrize("form", [3, 7])
def test_normals_from_extra_bytes(tmp_path, form, pack):
    cloud = read(tmp_path, pack(las_with_normals(form)), "a.laz")
    assert cloud.normals == pytest.approx(NORMALS, abs=1e-6)
    assert not cloud.two_sided.any()
    assert cloud.used["NormalX"] == "normal"


def test_extra_bytes_without_a_description_are_passed_over(tmp_path):
    cloud = read(tmp_path, laz(las(7, record_extra=b"abcde")), "a.laz")
    assert np.array_equal(cloud.colours, COLOURS)


@pytest.mark.parametrize("form", [3, 6, 8])
def test_chunks_of_different_sizes(tmp_path, form):
    cloud = read(tmp_path, packed(las(form)), "a.copc.laz")
    assert places(cloud) == pytest.approx(places_of(), abs=1e-9, rel=0)


@pytest.mark.parametrize("pack", [bytes, laz, packed], ids=["las", "laz", "variable"])
@pytest.mark.parametrize("points", [1, 7, 59, 60, 1000])
def test_chunk_by_chunk_the_points_are_those_of_the_whole(tmp_path, points, pack):
    path = tmp_path / "a.laz"
    path.write_bytes(pack(las(7)))
    with open_source(path) as source:
        names = ("x", "y", "z", "red", "green", "blue")
        tables = [table for table, _ in las_tables(source, read_las_header(source), names, points)]
    assert max(len(table["x"]) for table in tables) == min(points, COUNT)
    found = np.vstack([np.stack([table[name] for name in names], axis=1) for table in tables])
    assert np.array_equal(found[:, :3], places_of())
    assert np.array_equal(found[:, 3:], COLOURS.astype(int) * 257)


def test_any_field_can_be_asked_for(tmp_path):
    path = tmp_path / "a.laz"
    path.write_bytes(laz(las(7, classes=np.arange(COUNT) % 5)))
    with open_source(path) as source:
        names = ("classification", "gps_time", "number_of_returns", "scan_angle")
        ((table, dropped),) = las_tables(source, read_las_header(source), names, COUNT)
    assert np.array_equal(table["classification"], np.arange(COUNT) % 5)
    assert np.array_equal(table["gps_time"], 0.25 * np.arange(COUNT))
    assert (table["number_of_returns"] == 1).all()
    assert (table["scan_angle"] == -500).all()
    assert dropped == {}


@pytest.mark.parametrize(
    ("place", "form", "value", "message"),
    [
        (25, "<B", 9, "is LAS 1.9; 1.0 to 1.4 are read"),
        (104, "<B", 11, "has points of format 11; 0 to 10 are read"),
        (105, "<H", 30, "has points of 30 bytes; format 7 needs 36"),
        (131, "<d", 0.0, "scales and offsets"),
        (155, "<d", float("nan"), "scales and offsets"),
        (247, "<Q", 61, "ends after 60 of its 61 points"),
        (247, "<Q", 1 << 60, "ends after 60 of its"),
        (247, "<Q", 0, "has no points"),
        (96, "<I", 1 << 31, "does not fit the file's size"),
        (100, "<I", 1 << 31, "does not fit the file's size"),
    ],
)
def test_a_header_that_is_wrong(tmp_path, place, form, value, message):
    data = bytearray(las(7))
    struct.pack_into(form, data, place, value)
    with pytest.raises(InputError, match=message):
        read(tmp_path, bytes(data))


def test_what_a_laz_promises_is_checked_before_memory_is_taken(tmp_path):
    data = laz(las(7))
    (start,) = struct.unpack_from("<I", data, 96)
    (table,) = struct.unpack_from("<q", data, start)
    record = data.index(b"laszip encoded") - 2 + 54
    for place, form, value, message in (
        (247, "<Q", 1 << 40, "promises 1,099,511,627,776 points, more than"),
        (247, "<Q", 50_001, "promises 50,001 points, but its chunks hold 50,000"),
        (table + 4, "<I", 1 << 30, "promises 1,073,741,824 chunks, more than the file holds"),
        (start + 8 + 36 + 4, "<I", 1 << 31, "chunks that are shorter than their layers"),
        (start, "<q", 1 << 40, "no table of its chunks"),
        (record + 34, "<H", 77, "a record of compression that does not fit its points"),
    ):
        wrong = bytearray(data)
        struct.pack_into(form, wrong, place, value)
        with pytest.raises(InputError, match=message):
            read(tmp_path, bytes(wrong), "a.laz")


def test_one_chunk_said_to_be_large_takes_no_more_than_the_points(tmp_path):
    data = bytearray(laz(las(7)))
    struct.pack_into("<I", data, data.index(b"laszip encoded") - 2 + 54 + 12, 0xFFFFFFFE)
    assert len(read(tmp_path, bytes(data), "a.laz")) == COUNT


@pytest.mark.parametrize(("places", "points"), [(1, 7), (3, 5), (4, 10), (COUNT, 9)])
def test_a_sample_is_of_evenly_spaced_places_and_reaches_the_last_point(tmp_path, places, points):
    (tmp_path / "a.las").write_bytes(las(0))
    with open_source(tmp_path / "a.las") as source:
        header = read_las_header(source)
        whole = las_sample(source, header, ("X",), 1, COUNT)["X"]
        found = las_sample(source, header, ("X",), places, points)["X"]
    if places * points >= COUNT:
        places, points = 1, COUNT
    firsts = [n * (COUNT - points) // max(places - 1, 1) for n in range(places)]
    expected = np.concatenate([whole[first : first + points] for first in firsts])
    assert len(whole) == COUNT
    assert np.array_equal(found, expected)
