"""E57 files written by hand from the standard (ASTM E2807)."""

import struct

import numpy as np

PAGE, CHECKSUM = 1024, 4


def _table():
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
        table.append(value)
    return table


TABLE = _table()


def crc32c(data):
    value = 0xFFFFFFFF
    for byte in data:
        value = TABLE[(value ^ byte) & 255] ^ value >> 8
    return value ^ 0xFFFFFFFF


def paged(logical):
    """The bytes in pages, each with its checksum, which is big endian."""
    step = PAGE - CHECKSUM
    logical += bytes(-len(logical) % step)
    pages = [logical[i : i + step] for i in range(0, len(logical), step)]
    return b"".join(page + struct.pack(">I", crc32c(page)) for page in pages)


def physical(at):
    return at // (PAGE - CHECKSUM) * PAGE + at % (PAGE - CHECKSUM)


def field(name, kind):
    """A field's XML: single or double precision, 8 or 16 bits, or millimetres in 32 bits."""
    if kind == "S":
        return (
            f'<{name} type="ScaledInteger" minimum="{-(1 << 31)}" maximum="{(1 << 31) - 1}"'
            ' scale="0.001"/>'
        )
    if kind in "fd":
        precision = {"f": "single", "d": "double"}[kind]
        return f'<{name} type="Float" precision="{precision}"/>'
    return f'<{name} type="Integer" minimum="0" maximum="{ {"B": 255, "H": 65535}[kind] }"/>'


def stream(kind, values):
    """A field's bytes; integers are counted from their minimum."""
    if kind == "S":
        counted = np.rint(np.asarray(values) * 1000.0).astype(np.int64) + (1 << 31)
        return counted.astype("<u4").tobytes()
    types = {"B": "u1", "H": "<u2", "f": "<f4", "d": "<f8"}
    return np.asarray(values).astype(types[kind]).tobytes()


def pose(rotation, translation):
    def node(name, values, letters):
        inner = "".join(
            f'<{letter} type="Float">{value!r}</{letter}>'
            for letter, value in zip(letters, values, strict=True)
        )
        return f'<{name} type="Structure">{inner}</{name}>'

    inner = node("rotation", rotation, "wxyz") + node("translation", translation, "xyz")
    return f'<pose type="Structure">{inner}</pose>'


def scan(**columns):
    """A scan: a kind and values by field; ``pose`` is XML. Two underscores are a colon."""
    return columns


def e57(*scans, count=None, namespace=""):
    """Bytes of a file with some scans. Fields of a byte or more are whole bytes in its streams."""
    body = b""
    children = ""
    for number, columns in enumerate(scans):
        placed = columns.pop("pose", "")
        body += bytes(-len(body) % 4)
        start = 48 + len(body)
        streams = [stream(kind, values) for kind, values in columns.values()]
        packet = struct.pack(f"<{len(streams)}H", *map(len, streams)) + b"".join(streams)
        packet += bytes(-(len(packet) + 6) % 4)
        data = struct.pack("<BBHH", 1, 0, len(packet) + 5, len(streams)) + packet
        body += struct.pack("<B7xQQQ", 1, 32 + len(data), physical(start + 32), 0) + data
        rows = len(next(iter(columns.values()))[1]) if count is None else count
        fields = "".join(field(name.replace("__", ":"), k) for name, (k, _) in columns.items())
        children += (
            f'<vectorChild type="Structure"><guid type="String">{{{number}}}</guid>{placed}'
            f'<points type="CompressedVector" fileOffset="{physical(start)}" recordCount="{rows}">'
            f'<prototype type="Structure">{fields}</prototype>'
            '<codecs type="Vector" allowHeterogeneousChildren="1"/></points></vectorChild>'
        )
    xml = (
        '<?xml version="1.0" encoding="UTF-8"?><e57Root type="Structure"'
        f' xmlns="http://www.astm.org/COMMIT/E57/2010-e57-v1.0"{namespace}>'
        '<formatName type="String">ASTM E57 3D Imaging Data File</formatName>'
        '<guid type="String">{0}</guid><versionMajor type="Integer">1</versionMajor>'
        '<versionMinor type="Integer">0</versionMinor>'
        f'<data3D type="Vector" allowHeterogeneousChildren="1">{children}</data3D>'
        '<images2D type="Vector" allowHeterogeneousChildren="1"/></e57Root>'
    ).encode()
    at = 48 + len(body)
    pages = -(-(at + len(xml)) // (PAGE - CHECKSUM))
    head = struct.pack("<8sIIQQQQ", b"ASTM-E57", 1, 0, pages * PAGE, physical(at), len(xml), PAGE)
    return paged(head + body + xml)


def coordinates(rows, kind="d", names=("cartesianX", "cartesianY", "cartesianZ")):
    return {name: (kind, column) for name, column in zip(names, rows.T, strict=True)}


def colours(rows, kind="B"):
    return coordinates(rows, kind, ("colorRed", "colorGreen", "colorBlue"))


def unpaged(data):
    """The bytes of a file without the checksums of its pages."""
    return b"".join(data[i : i + PAGE - CHECKSUM] for i in range(0, len(data), PAGE))
