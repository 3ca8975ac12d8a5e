"""Meshes written by hand from the formats' specifications: a box with a face in two triangles."""

import json
import struct

import numpy as np

CORNERS = np.array([[x, y, z] for x in (0, 2) for y in (0, 1) for z in (0, 3)], float)
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
"""Seen from outside, each goes round to the left."""
FACES = np.array([f for a, b, c, d in SIDES for f in ((a, b, c), (a, c, d))])
COLOURS = np.arange(24).reshape(8, 3) * 9 + 20


def obj(colours=None, normals=None, head=""):
    rows = CORNERS if colours is None else np.hstack([CORNERS, colours / 255.0])
    lines = [head, *("v " + " ".join(f"{v:.9g}" for v in row) for row in rows)]
    if normals is not None:
        lines += ["vn " + " ".join(f"{v:.9g}" for v in row) for row in normals]
    form = "{0}" if normals is None else "{0}//{0}"
    lines += ["f " + " ".join(form.format(i + 1) for i in face) for face in FACES]
    return ("\n".join(lines) + "\n").encode()


def textured_obj():
    """A square with a texture whose left half is red and whose right half is blue."""
    return (
        b"mtllib a.mtl\nusemtl paint\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
        b"vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
    )


def stl():
    data = bytes(80) + struct.pack("<I", len(FACES))
    return data + b"".join(
        struct.pack("<12fH", 0, 0, 0, *CORNERS[face].ravel(), 0) for face in FACES
    )


def text_stl():
    lines = ["solid box"]
    for face in FACES:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {x:g} {y:g} {z:g}" for x, y, z in CORNERS[face]]
        lines += ["endloop", "endfacet"]
    return ("\n".join([*lines, "endsolid box"]) + "\n").encode()


def off():
    lines = ["OFF", f"{len(CORNERS)} {len(SIDES)} 0"]
    lines += [f"{x:g} {y:g} {z:g}" for x, y, z in CORNERS]
    lines += ["4 " + " ".join(map(str, side)) for side in SIDES]
    return ("\n".join(lines) + "\n").encode()


def glb(*, colours=None, normals=None, nodes=None, count=None, extensions=(), material=None):
    arrays = [
        (CORNERS.astype("<f4"), 5126, "VEC3"),
        (FACES.astype("<u2").ravel(), 5123, "SCALAR"),
    ]
    attributes = {"POSITION": 0}
    if normals is not None:
        attributes["NORMAL"] = len(arrays)
        arrays.append((normals.astype("<f4"), 5126, "VEC3"))
    if colours is not None:
        attributes["COLOR_0"] = len(arrays)
        rows = np.hstack([colours, np.full((8, 1), 255)]).astype("u1")
        arrays.append((rows, 5121, "VEC4"))
    binary = b""
    views, accessors = [], []
    for array, kind, shape in arrays:
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": array.nbytes})
        accessor = {"bufferView": len(views) - 1, "componentType": kind, "type": shape}
        accessors.append({**accessor, "count": len(array)})
        binary += array.tobytes() + bytes(-array.nbytes % 4)
    accessors[0] |= {"min": [0, 0, 0], "max": [2, 1, 3]}
    if count is not None:
        accessors[0]["count"] = count
    primitive = {"attributes": attributes, "indices": 1}
    if material is not None:
        primitive["material"] = 0
    nodes = [{"mesh": 0}] if nodes is None else nodes
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": [{"primitives": [primitive]}],
        "buffers": [{"byteLength": len(binary)}],
        "bufferViews": views,
        "accessors": accessors,
        "extensionsRequired": list(extensions),
    }
    if material is not None:
        tree["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": material}}]
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(binary)
    head = struct.pack("<4sIIII", b"glTF", 2, size, len(text), 0x4E4F534A)
    return head + text + struct.pack("<II", len(binary), 0x004E4942) + binary
