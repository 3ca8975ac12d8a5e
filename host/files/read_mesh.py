"""Meshes: OBJ, STL, OFF, GLB, and PLY for its faces. Vertices are points, or faces are sampled."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from splatline.contract.errors import InputError

from .columns import Columns, find_meaning, gather
from .empty_returns import Empty
from .glb_header import check_glb
from .mesh_parts import Part, join, sample_parts
from .obj_indices import check_obj
from .off_header import check_off
from .ply_header import read_header
from .source import Source, unpacked_limit
from .stl_header import check_stl

__all__ = ["read_mesh"]

CHECKS: dict[str, Callable[[Source], object]] = {
    ".obj": check_obj,
    ".off": check_off,
    ".glb": check_glb,
    ".stl": check_stl,
    ".ply": read_header,
}
"""Checks of a file before trimesh reads it."""

NAMES = (("x", "y", "z"), ("nx", "ny", "nz"), ("red", "green", "blue"))
"""Names of a mesh's columns, as in other formats."""

VERTEX = 24
"""Bytes of a vertex, by which the number of those that are drawn is checked."""


def read_mesh(source: Source) -> Columns:
    """Return the vertices of a mesh as points, or points on its faces.

    Every place of a mesh in a scene is read, under its transform. Colours are those of vertices,
    faces, textures or materials. Normals are the file's. Without them those of the faces are taken;
    their sign means something if the mesh is closed and its faces turn one way.

    Parameters
    ----------
    source
        The file: OBJ, STL, OFF, GLB or PLY. It is wanted for points that are spread evenly over
        the area of the faces, or for the vertices.

    Raises
    ------
    InputError
        If there are no vertices, or no faces to sample.
    Exception
        Of several types, from trimesh, if the file is damaged.
    """
    if source.suffix in CHECKS:
        CHECKS[source.suffix](source)
    parts = _load(source)
    source.tell()
    if source.wanted.sample is not None:
        columns = sample_parts(parts, source.wanted.sample)
    else:
        columns = join([part.vertices() for part in parts])
    table: dict[str, Any] = {}
    arrays = columns.positions, columns.normals, columns.colours
    for names, array in zip(NAMES, arrays, strict=True):
        if array is not None:
            table |= dict(zip(names, array.T, strict=True))
    meaning = find_meaning(list(table), wanted=source.wanted)
    assert meaning is not None
    meaning = replace(meaning, empty=Empty.KEPT)  # a vertex is no return
    return replace(gather(table, meaning), two_sided=columns.two_sided)


def _load(source: Source) -> list[Part]:
    """Return the meshes of a file, one for each place in its scene."""
    import trimesh  # not before a mesh is read

    logging.getLogger("trimesh").addHandler(logging.NullHandler())  # else it writes to the terminal
    resolver = None
    if source.path is not None and source.suffix == ".obj":
        resolver = trimesh.resolvers.FilePathResolver(str(source.path))
    source.stream.seek(0)
    options: dict[str, Any] = {"process": False}
    if source.suffix == ".obj":
        options |= {"split_objects": False, "group_material": True, "maintain_order": True}
    scene = trimesh.load_scene(
        source.stream, file_type=source.suffix[1:], resolver=resolver, **options
    )
    if source.suffix == ".stl":  # has three vertices of its own for each face
        for mesh in scene.geometry.values():
            mesh.merge_vertices()
    placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
    count = sum(len(scene.geometry[name].vertices) for _, name in placed)
    if count > unpacked_limit(source.size) // VERTEX:
        raise InputError(
            f"promises {count:,} vertices, more than {source.size:,} bytes hold; is it damaged?"
        )
    if not count and source.suffix in (".obj", ".stl"):  # trimesh passes over what it does not know
        raise InputError(f"cannot be read as {source.suffix[1:].upper()}: it has no vertices")
    if not count:
        raise InputError("has no vertices")
    return [Part(scene.geometry[name], np.asarray(matrix)) for matrix, name in placed]
