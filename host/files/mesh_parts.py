"""Points of meshes: their vertices, or points spread evenly over their faces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .columns import Columns

__all__ = ["Part", "join", "sample_parts"]

SEED = 1
"""Of the places within faces, so that a file always gives the same cloud."""

GREY = (102, 102, 102)
"""trimesh's colour for a material that is missing."""

_Floats = npt.NDArray[np.float64]


class Part:
    """A mesh at one place of a scene.

    Parameters
    ----------
    mesh
        A ``Trimesh``, or a ``PointCloud``, which has no faces.
    matrix
        Its transform, for columns: shape (4, 4).
    """

    def __init__(self, mesh: Any, matrix: _Floats) -> None:
        self._mesh = mesh
        self._turn = matrix[:3, :3]
        self.positions = np.asarray(mesh.vertices, np.float64) @ self._turn.T + matrix[:3, 3]
        faces = np.asarray(getattr(mesh, "faces", np.empty((0, 3), np.int64)))
        self.faces = faces.reshape(-1, 3)
        if len(faces) and (faces.min() < 0 or faces.max() >= len(self.positions)):
            raise InputError("has faces of vertices that it lacks; is it damaged?")
        # What a file gives is in the cache from the start; asking would compute normals.
        self._given = "vertex_normals" in getattr(getattr(mesh, "_cache", None), "cache", {})

    def vertices(self) -> Columns:
        """Return the vertices as points."""
        normals = None
        if self._given or len(self.faces):
            normals = self._turned(np.asarray(self._mesh.vertex_normals, np.float64))
        return Columns(
            self.positions,
            normals,
            self._vertex_colours(),
            two_sided=not self._given and not self._is_closed(),
        )

    def areas(self) -> _Floats:
        """Return the areas of the faces: shape (faces,); those that have none are 0."""
        twice = np.linalg.norm(self._crosses(), axis=1)
        return np.where(np.isfinite(twice), 0.5 * twice, 0.0)

    def points(self, face: npt.NDArray[np.intp], weights: _Floats) -> Columns:
        """Return points on faces, from the weights of their corners: shape (n,) and (n, 3)."""
        corners = self.faces[face]

        def between(values: npt.NDArray[Any]) -> _Floats:
            mixed: _Floats = np.einsum("nk,nkc->nc", weights, values[corners].astype(np.float64))
            return mixed

        if self._given:
            normals = self._turned(between(np.asarray(self._mesh.vertex_normals)))
        else:
            normals = self._crosses()[face] * (-1.0 if np.linalg.det(self._turn) < 0.0 else 1.0)
        visual = self._mesh.visual
        colours: npt.NDArray[Any] | None = None
        if visual.kind == "face":
            colours = np.asarray(visual.face_colors)[face, :3]
        elif visual.kind == "texture" and self._has_image():
            colours = _looked_up(visual, between(np.asarray(visual.uv, np.float64)))
        elif (of_vertices := self._vertex_colours()) is not None:
            colours = np.rint(between(of_vertices)).astype(np.uint8)
        two_sided = not self._given and not self._is_closed()
        return Columns(between(self.positions), normals, colours, two_sided=two_sided)

    def _turned(self, normals: _Floats) -> _Floats:
        """Return normals under the transform: they stay across the surface."""
        a, b, c = self._turn.T
        # The matrix of cofactors: the inverse's transpose times the determinant, without dividing.
        cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)
        sign = -1.0 if np.linalg.det(self._turn) < 0.0 else 1.0
        return sign * (normals @ cofactors.T)

    def _crosses(self) -> _Floats:
        """Return normals of the faces whose length is twice their area."""
        first, second, third = (self.positions[self.faces[:, i]] for i in range(3))
        return np.cross(second - first, third - first)

    def _is_closed(self) -> bool:
        """Return whether the normals of the faces point out of a volume."""
        return bool(len(self.faces) and self._mesh.is_volume)

    def _has_image(self) -> bool:
        material = self._mesh.visual.material
        image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
        return image is not None and self._mesh.visual.uv is not None

    def _vertex_colours(self) -> npt.NDArray[np.uint8] | None:
        """Return the vertices' colours, shape (n, 3); None if the file has none."""
        visual = self._mesh.visual
        if visual.kind is None:
            return None
        if visual.kind == "texture":
            if self._has_image():
                return _looked_up(visual, np.asarray(visual.uv, np.float64))
            colour = np.asarray(visual.material.main_color, np.uint8)[:3]
            return None if tuple(colour) == GREY else np.tile(colour, (len(self.positions), 1))
        colours = np.asarray(visual.vertex_colors, np.uint8)
        return colours[:, :3] if len(colours) == len(self.positions) else None


def sample_parts(parts: Sequence[Part], count: int) -> Columns:
    """Return ``count`` points, spread evenly over the faces of all parts.

    The faces are laid out behind each other by area. Of ``count`` equal steps along them each gets
    one point, at random within the step and the face.

    Raises
    ------
    InputError
        If no face has an area.
    """
    areas = [part.areas() for part in parts]
    ends = np.cumsum(np.concatenate(areas))
    total = float(ends[-1]) if len(ends) else 0.0
    if not 0.0 < total < np.inf:
        raise InputError("has no faces to sample; leave --sample out")
    random = np.random.default_rng(SEED)
    along = (np.arange(count) + random.random(count)) * (total / count)
    # Faces without an area end where the one before them ends, and so are never found.
    face = np.minimum(np.searchsorted(ends, along, side="right"), np.flatnonzero(ends == total)[0])
    # Uniform in a triangle: Osada et al., Shape Distributions, 2002, section 4.2.
    root, share = np.sqrt(random.random(count)), random.random(count)
    weights = np.stack([1.0 - root, root * (1.0 - share), root * share], axis=-1)
    found = []
    first = 0
    for part, sizes in zip(parts, areas, strict=True):
        inside = (face >= first) & (face < first + len(sizes))
        if inside.any():
            found.append(part.points(face[inside] - first, weights[inside]))
        first += len(sizes)
    return join(found)


def join(parts: Sequence[Columns]) -> Columns:
    """Return the points of all parts; what some of them lack is not a number."""

    def joined(arrays: list[npt.NDArray[Any] | None]) -> npt.NDArray[Any] | None:
        if all(array is None for array in arrays):
            return None
        return np.concatenate(
            [
                np.full((len(part.positions), 3), np.nan) if array is None else array
                for part, array in zip(parts, arrays, strict=True)
            ]
        )

    positions = joined([part.positions for part in parts])
    normals = joined([part.normals for part in parts])
    colours = joined([part.colours for part in parts])
    assert positions is not None
    two_sided = any(part.two_sided for part in parts)
    return Columns(positions, normals, colours, two_sided=two_sided)


def _looked_up(visual: Any, places: _Floats) -> npt.NDArray[np.uint8]:
    """Return the colours of a texture: shape (n, 3)."""
    found = visual.material.to_color(np.nan_to_num(places, posinf=0.0, neginf=0.0))
    return np.asarray(found, np.uint8)[:, :3]
