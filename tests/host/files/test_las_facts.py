"""Coordinate systems of LAS files, as programs write them; names are by hand from the standards."""

import struct

import numpy as np
import pytest

from splatline.host.files.las_facts import las_extent, las_facts
from splatline.host.files.las_header import LasHeader, read_las_header
from splatline.host.files.source import open_source
from tests.host.files.las_files import las

WKT1 = (
    'PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",DATUM["x",SPHEROID["GRS 1980",6378137,298.25]'
    ',AUTHORITY["EPSG","6258"]],AUTHORITY["EPSG","4258"]],UNIT["metre",1],AUTHORITY["EPSG","25832"]]'
)
WKT2 = (
    'PROJCRS["NAD83(2011) / UTM zone 10N",BASEGEOGCRS["NAD83(2011)",ID["EPSG",6318]]'
    ',ID["EPSG",6339]]'
)
COMPOUND = (
    f'COMPD_CS["UTM 32N + DHHN2016",{WKT1},VERT_CS["DHHN2016 height",AUTHORITY["EPSG","7837"]]]'
)


def header(records=(), *, low=(1, 2, 3), high=(9, 8, 7)):
    head = struct.pack("<4sHH16xBB32s32sHH", b"LASF", 0, 0, 1, 4, b"ALS\0x", b"PDAL 2.6", 33, 2024)
    return LasHeader(
        minor=4,
        form=6,
        length=30,
        count=1,
        start=375,
        scales=np.full(3, 0.01),
        offsets=np.zeros(3),
        low=np.array(low, float),
        high=np.array(high, float),
        extras=(),
        laszip=b"",
        head=head,
        records={("LASF_Projection", number): data for number, data in records},
    )


def geo_keys(*keys):
    return np.array([(1, 1, 0, len(keys)), *keys], "<u2").tobytes()


def test_the_header_has_programs_day_and_extent():
    facts = las_facts(header())
    assert facts == {
        "system": "ALS",
        "software": "PDAL 2.6",
        "created": "2024, day 33",
        "scale": "0.01, 0.01, 0.01",
    }
    assert las_extent(header()) == ((1.0, 2.0, 3.0), (9.0, 8.0, 7.0))


@pytest.mark.parametrize("high", [(0, 8, 7), (np.nan, 8, 7), (np.inf, 8, 7)])
def test_an_extent_that_is_none_is_not_told(high):
    assert las_extent(header(high=high)) is None


@pytest.mark.parametrize(
    ("record", "name"),
    [
        ((2112, WKT1.encode() + b"\0"), "ETRS89 / UTM zone 32N (EPSG:25832)"),
        ((2112, WKT2.encode()), "NAD83(2011) / UTM zone 10N (EPSG:6339)"),
        ((2112, COMPOUND.encode()), "UTM 32N + DHHN2016"),
        ((2112, b'LOCAL_CS["site"]\0\0'), "site"),
        ((34735, geo_keys((1024, 0, 1, 1), (3072, 0, 1, 25832))), "EPSG:25832"),
        ((34735, geo_keys((1024, 0, 1, 2), (2048, 0, 1, 4326))), "EPSG:4326"),
        ((34735, geo_keys((2048, 0, 1, 4258), (3072, 0, 1, 25832))), "EPSG:25832"),
        (
            (34735, geo_keys((3072, 0, 1, 25832), (4096, 0, 1, 7837))),
            "EPSG:25832, height EPSG:7837",
        ),
    ],
)
def test_coordinate_systems(record, name):
    assert las_facts(header([record]))["coordinate system"] == name


@pytest.mark.parametrize(
    "record",
    [
        (2112, b""),
        (2112, b"\0\0"),
        (2112, b"no text of a system"),
        (34735, b""),
        (34735, b"\1\2\3"),
        (34735, geo_keys((3072, 0, 1, 32767), (2048, 0, 1, 0))),
        (34735, geo_keys((3072, 34737, 9, 0))),
    ],
)
def test_what_names_no_system_is_not_told(record):
    assert "coordinate system" not in las_facts(header([record]))


def test_the_text_goes_before_the_keys():
    records = [(34735, geo_keys((3072, 0, 1, 4326))), (2112, WKT1.encode())]
    assert "25832" in las_facts(header(records))["coordinate system"]


def extended(user, number, data, promised=None):
    length = len(data) if promised is None else promised
    return struct.pack("<2x16sHQ32x", user, number, length) + data


def with_extended(*records, count=None, at=None):
    """Bytes of a file with extended records behind the points."""
    data = bytearray(las(7))
    count = len(records) if count is None else count
    struct.pack_into("<QI", data, 235, len(data) if at is None else at, count)
    return bytes(data) + b"".join(records)


OTHER = extended(b"somebody", 2112, b'LOCAL_CS["other"]')
SITE = extended(b"LASF_Projection", 2112, b'LOCAL_CS["site"]')


def facts_of(folder, data):
    path = folder / "a.las"
    path.write_bytes(data)
    with open_source(path, None) as source:
        return las_facts(read_las_header(source))


@pytest.mark.parametrize("records", [[SITE], [OTHER, SITE], [SITE, OTHER]])
def test_the_system_of_an_extended_record(tmp_path, records):
    assert facts_of(tmp_path, with_extended(*records))["coordinate system"] == "site"


@pytest.mark.parametrize(
    "data",
    [
        with_extended(OTHER),
        with_extended(SITE, count=0),
        with_extended(SITE[:-1]),
        with_extended(SITE[:30]),
        with_extended(at=2**64 - 1, count=3),
        with_extended(count=2**32 - 1),
        with_extended(extended(b"x", 1, b"", promised=2**64 - 1), SITE),
    ],
)
def test_extended_records_that_do_not_fit_are_passed_over(tmp_path, data):
    assert "coordinate system" not in facts_of(tmp_path, data)


def test_of_two_records_the_first_counts(tmp_path):
    data = bytearray(with_extended(extended(b"LASF_Projection", 2112, WKT2.encode()), SITE))
    assert "6339" in facts_of(tmp_path, bytes(data))["coordinate system"]
