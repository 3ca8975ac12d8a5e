"""A sphere in three colours, and short ways to write it as people's programs do."""

import lzf
import numpy as np

from splatline.host.files.readers import read_cloud

COUNT = 60
RED, BLUE, GREEN = (220, 40, 20), (20, 60, 210), (40, 200, 60)


def _sphere():
    height = 1.0 - 2.0 * (np.arange(COUNT) + 0.5) / COUNT
    turn = np.arange(COUNT) * 2.39996323
    ring = np.sqrt(1.0 - height**2)
    return np.column_stack([ring * np.cos(turn), ring * np.sin(turn), height])


SPHERE = np.round(_sphere(), 5)
COLOURS = np.array([RED, BLUE, GREEN], np.uint8)[np.arange(COUNT) % 3]
PACKED = COLOURS.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
CLAY = (214, 164, 124)


def read(folder, name, content):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_cloud(path)


def assert_sphere(cloud, kept=slice(None)):
    assert np.shape(cloud.positions) == SPHERE[kept].shape
    assert np.allclose(cloud.positions + cloud.origin, SPHERE[kept], atol=1e-6)


def assert_coloured(cloud, colours=COLOURS):
    assert_sphere(cloud)
    assert np.array_equal(cloud.colours, colours)


def text(*columns, delimiter=" ", form="%.9g", end="\n"):
    rows = np.column_stack(columns)
    return "".join(delimiter.join(form % value for value in row) + end for row in rows)


def ptx(*columns, matrix=None, sides=(6, 10)):
    """A scan as PTX: its size, the scanner's position and axes, a transform, and points."""
    head = f"{sides[0]}\n{sides[1]}\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    return head + text(np.eye(4) if matrix is None else matrix, form="%.17g") + text(*columns)


def ply(properties, columns, *, kind="binary_little_endian", comment="", after=""):
    """A PLY file of ``properties``, such as ``["float x", "uchar red"]``."""
    lines = [f"format {kind} 1.0", *([f"comment {comment}"] if comment else [])]
    lines += [f"element vertex {len(columns[0])}", *(f"property {item}" for item in properties)]
    head = "ply\n" + "\n".join(lines) + "\nend_header\n" + after
    if kind == "ascii":
        return (head + text(*columns)).encode()
    types = {"float": "f4", "double": "f8", "uchar": "u1", "char": "i1", "uint": "u4"}
    order = "<" if "little" in kind else ">"
    fields = [(f"f{i}", order + types[item.split()[0]]) for i, item in enumerate(properties)]
    rows = np.empty(len(columns[0]), fields)
    for i, column in enumerate(columns):
        rows[f"f{i}"] = column
    return head.encode() + rows.tobytes()


def pcd(fields, columns, *, form="binary", extra="", leave_out=()):
    """A PCD file of ``fields``: name, TYPE, SIZE and COUNT of each, such as ``"x F 4 1"``."""
    names, types, sizes, counts = zip(*(item.split() for item in fields), strict=True)
    lines = {
        "VERSION": "0.7",
        "FIELDS": " ".join(names),
        "SIZE": " ".join(sizes),
        "TYPE": " ".join(types),
        "COUNT": " ".join(counts),
        "WIDTH": str(COUNT),
        "HEIGHT": "1",
        "VIEWPOINT": "0 0 0 1 0 0 0",
        "POINTS": str(COUNT),
    }
    head = extra + "".join(f"{k} {v}\n" for k, v in lines.items() if k not in leave_out)
    head += f"DATA {form}\n"
    if form == "ascii":
        return (head + text(*[np.asarray(column, float) for column in columns])).encode()
    kinds = [f"<{t.lower()}{s}" for t, s in zip(types, sizes, strict=True)]
    rows = np.empty(
        COUNT,
        [(f"f{i}", kinds[i], (int(counts[i]),)) for i in range(len(kinds)) if counts[i] != "0"],
    )
    for name, column in zip(rows.dtype.names, columns, strict=True):
        rows[name] = np.asarray(column).reshape(rows[name].shape)
    return head.encode("latin-1") + rows.tobytes()


XYZ_PLY = ["float x", "float y", "float z"]
RGB_PLY = ["uchar red", "uchar green", "uchar blue"]
XYZ_PCD = ["x F 4 1", "y F 4 1", "z F 4 1"]


def compressed_pcd():
    """The coloured sphere as binary_compressed: fields one behind the other, packed by LZF.

    pypcd4 packs nothing that would not get shorter, so there is padding.
    """
    fields = [*XYZ_PCD, "rgb U 4 1", "_ F 4 4", "pair F 4 2"]
    pairs = np.column_stack([np.arange(COUNT), -np.arange(COUNT)]).astype("<f4")
    columns = [*SPHERE.T.astype("<f4"), PACKED.astype("<u4"), np.zeros((COUNT, 4), "<f4"), pairs]
    data = b"".join(column.tobytes() for column in columns)
    head = pcd(fields, columns).split(b"binary\n", 1)[0]
    packed = lzf.compress(data)
    sizes = np.array([len(packed), len(data)], "<u4").tobytes()
    return head + b"binary_compressed\n" + sizes + packed


def ply_of(count, properties, *, kind="ascii", element="vertex"):
    lines = "".join(f"property {item}\n" for item in properties)
    return f"ply\nformat {kind} 1.0\nelement {element} {count}\n{lines}end_header\n1 2 3\n".encode()
