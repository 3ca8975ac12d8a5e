"""LAS files written by hand from the standard, and packed by LASzip, which is not our reader's."""

import io
import struct

import laszip
import numpy as np

from tests.host.files.cloud_files import COLOURS, COUNT, NORMALS, POSITIONS

SCALE = 0.001
OFFSETS = (654321.0, 5212345.5, -17.25)
GEO = np.rint(POSITIONS.astype(float) * 1000.0).astype(np.int32)
"""Integers of the coordinates: millimetres."""

SHORT = {0: "", 1: "d", 2: "HHH", 3: "dHHH", 4: "dBQIffff", 5: "dHHHBQIffff"}
LONG = {6: "", 7: "HHH", 8: "HHHH", 9: "BQIffff", 10: "HHHHBQIffff"}

MINOR = {0: 1, 1: 1, 2: 2, 3: 2, 4: 3, 5: 3}
"""A version that has a format; others need 1.4."""


def places_of(geo=GEO):
    return geo * SCALE + np.array(OFFSETS)


def point_bytes(form, i, *, rgb, intensity, class_and_flags, extra):
    """One point, its fields in the order of the standard's tables."""
    kind, flags = class_and_flags
    tail = {"d": 0.25 * i, "H": 0, "B": 0, "Q": 0, "I": 0, "f": 0.0}
    letters = SHORT[form] if form < 6 else LONG[form]
    values = [tail[letter] for letter in letters]
    if "HHH" in letters:
        at = letters.index("HHH")
        values[at : at + 3] = [int(value) for value in rgb]
    if form < 6:
        head = struct.pack("<3iHBBbBH", *GEO[i], intensity, 0o11, kind | flags << 5, -3, 7, 99)
    else:
        head = struct.pack(
            "<3iHBBBBhHd", *GEO[i], intensity, 0x11, flags, kind, 7, -500, 99, 0.25 * i
        )
    return head + struct.pack("<" + letters, *values) + extra


def las(
    form,
    minor=None,
    *,
    colours=None,
    classes=None,
    flags=None,
    normals=None,
    count=None,
    intensity=None,
    record_extra=b"",
):
    """Bytes of a LAS file of the test's cloud."""
    if minor is None:
        minor = MINOR.get(form, 4)
    colours = COLOURS.astype(int) * 257 if colours is None else colours
    records = []
    extras = [record_extra] * COUNT
    if normals is not None:
        fields = [
            struct.pack("<2xBB32s", 9, 0, f"{name}".encode()).ljust(192, b"\0")
            for name in ("NormalX", "NormalY", "NormalZ")
        ]
        records.append((b"LASF_Spec", 4, b"".join(fields)))
        extras = [row.astype("<f4").tobytes() for row in normals]
    points = [
        point_bytes(
            form,
            i,
            rgb=colours[i],
            intensity=i * 100 if intensity is None else intensity,
            class_and_flags=(
                2 if classes is None else int(classes[i]),
                0 if flags is None else int(flags[i]),
            ),
            extra=extras[i],
        )
        for i in range(COUNT)
    ]
    body = b"".join(
        struct.pack("<2x16sHH32x", user, number, len(data)) + data for user, number, data in records
    )
    size = {3: 235, 4: 375}.get(minor, 227)
    count = COUNT if count is None else count
    head = struct.pack("<4sHH16xBB32s32sHH", b"LASF", 0, 0, 1, minor, b"hand", b"hand", 1, 2026)
    short = 0 if minor == 4 else count
    head += struct.pack(
        "<HIIBHI", size, size + len(body), len(records), form, len(points[0]), short
    )
    low, high = places_of().min(axis=0), places_of().max(axis=0)
    limits = [value for pair in zip(high, low, strict=True) for value in pair]
    head += struct.pack("<5I3d3d6d", short, 0, 0, 0, 0, *[SCALE] * 3, *OFFSETS, *limits)
    head = head.ljust(235, b"\0") + struct.pack("<QIQ", 0, 0, count)
    return head.ljust(375, b"\0")[:size] + body + b"".join(points)


def laz(data):
    """The same file, packed by LASzip."""
    (start,) = struct.unpack_from("<I", data, 96)
    stream = io.BytesIO()
    zipper = laszip.LasZipper(stream, data[:start])
    zipper.compress(np.frombuffer(data[start:], np.uint8))
    zipper.done()
    return stream.getvalue()


def las_with_normals(form=7):
    return las(form, normals=NORMALS)
