"""Names that columns have in files, by what they hold; the earlier names count first."""

from __future__ import annotations

import re
from collections.abc import Sequence

from splatline.contract.errors import InputError

from .wanted import CLASSIFICATION, HEIGHT, INTENSITY, RGB, ColourBy

__all__ = ["HINTS", "NORMALS", "POSITIONS", "Names", "kinds_of", "no_field", "plain_name"]

Names = tuple[str, ...]

POSITIONS: tuple[Names, ...] = (
    ("x", "y", "z"),
    ("xyz",),
    ("position",),
    ("positions",),
    ("points",),
    ("vertices",),
    ("pos",),
    ("px", "py", "pz"),
    ("pos_x", "pos_y", "pos_z"),
    ("points:0", "points:1", "points:2"),
    ("easting", "northing", "elevation"),
    ("easting", "northing", "height"),
)
NORMALS: tuple[Names, ...] = (
    ("nx", "ny", "nz"),
    ("normal_x", "normal_y", "normal_z"),
    ("normalx", "normaly", "normalz"),
    ("n_x", "n_y", "n_z"),
    ("normals:0", "normals:1", "normals:2"),
    ("normal",),
    ("normals",),
)
COLOURS: tuple[Names, ...] = (
    ("red", "green", "blue"),
    ("r", "g", "b"),
    ("rf", "gf", "bf"),
    ("diffuse_red", "diffuse_green", "diffuse_blue"),
    ("colours",),
    ("colors",),
    ("rgb",),
    ("rgba",),
    ("colour",),
    ("color",),
)
PACKED: tuple[Names, ...] = (("rgb",), ("rgba",))
HARMONICS: tuple[Names, ...] = (("f_dc_0", "f_dc_1", "f_dc_2"),)
INTENSITIES: tuple[Names, ...] = (
    ("intensity",),
    ("scalar_intensity",),
    ("intensities",),
    ("reflectance",),
    ("scalar_reflectance",),
    ("reflectivity",),
    ("remission",),
)
CLASSES: tuple[Names, ...] = (("classification",), ("scalar_classification",), ("class",))

HINTS = re.compile(r"rgb|colou?r|red$|green$|blue$|norm|^n[xyz]$|intens|reflec|remis|^scalar|f_dc")
"""Names of columns that a person may expect to see in the picture."""

_UNIT = re.compile(r"\s*[\[(][^\[\]()]*[\])]$")


def plain_name(name: str) -> str:
    """Return a column's name without its unit, in lower case: ``x`` of ``X [m]``."""
    return _UNIT.sub("", name.strip().lower()).replace(" ", "_")


def kinds_of(colour: ColourBy | None) -> list[tuple[str, tuple[Names, ...], tuple[int, ...]]]:
    """Return what may colour a point, the best first: what it is, its names, and its widths."""
    own = [
        ("packed colour", PACKED, (1,)),
        ("colour", COLOURS, (3, 4)),
        ("colour, spherical harmonics", HARMONICS, ()),
    ]
    if colour is None:
        return [*own, ("intensity, as grey", INTENSITIES, (1,))]
    if colour.kind == RGB:
        return own
    if colour.kind == HEIGHT:
        return []
    if colour.kind == INTENSITY:
        kind = "intensity, as grey" if colour.map is None else "intensity, as colour"
        return [(kind, INTENSITIES, (1,))]
    if colour.kind == CLASSIFICATION:
        return [("class, as colour", CLASSES, (1,))]
    name = plain_name(colour.field)
    return [("value, as colour", ((name,), (f"scalar_{name}",)), (1,))]


def no_field(colour: ColourBy, fields: Sequence[str]) -> InputError:
    """Return the error about a file that lacks what is to colour a point."""
    missing = {
        RGB: "no colours",
        INTENSITY: "no intensity",
        CLASSIFICATION: "no classification",
    }.get(colour.kind, f"no field {colour.field.strip()!r}")
    return InputError(f"has {missing}; its fields are {', '.join(fields)}")
