"""Classes of points in the ASPRS standard, and their usual colours.

Names: LAS Specification 1.4 R15, table 17, and table 9 for the classes that LAS 1.1 to 1.3 had.
Colours follow the default legends of Potree (``src/materials/ClassificationScheme.js``) and QGIS
(``qgspointcloudclassifiedrenderer.cpp``): ground is brown, vegetation green, darker the higher,
buildings red, water blue, wires yellow. Where they have one colour for several classes, or black,
these are told apart.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["CLASSES", "class_colours", "class_name"]

CLASSES: dict[int, tuple[str, tuple[int, int, int]]] = {
    0: ("never classified", (128, 128, 128)),
    1: ("unassigned", (170, 170, 170)),
    2: ("ground", (161, 82, 46)),
    3: ("low vegetation", (90, 240, 90)),
    4: ("medium vegetation", (0, 204, 0)),
    5: ("high vegetation", (0, 140, 0)),
    6: ("building", (255, 85, 85)),
    7: ("low noise", (170, 0, 0)),
    8: ("model key point", (222, 184, 135)),
    9: ("water", (50, 110, 255)),
    10: ("rail", (170, 0, 170)),
    11: ("road surface", (88, 88, 98)),
    12: ("overlap", (120, 130, 160)),
    13: ("wire, guard", (255, 255, 85)),
    14: ("wire, conductor", (240, 215, 0)),
    15: ("transmission tower", (255, 85, 255)),
    16: ("wire connector", (255, 170, 0)),
    17: ("bridge deck", (140, 120, 255)),
    18: ("high noise", (205, 0, 90)),
    19: ("overhead structure", (150, 80, 200)),
    20: ("ignored ground", (110, 70, 50)),
    21: ("snow", (235, 245, 255)),
    22: ("temporal exclusion", (60, 140, 140)),
}
"""Name and colour of each class: red, green, blue."""

GOLDEN = 0.6180339887498949
"""Step of the hue from a class to the next: (sqrt(5) - 1) / 2, so that near classes differ."""


def class_name(number: int) -> str:
    """Return the name of a class, or an empty text if the standard gives it none."""
    return CLASSES[number][0] if number in CLASSES else ""


def class_colours(numbers: npt.NDArray[np.int64]) -> npt.NDArray[np.uint8]:
    """Return the colour of each class: shape (n, 3).

    A class outside the standard has a hue of its own, the same in every file.
    """
    hue = (numbers * GOLDEN) % 1.0
    bright = np.where(numbers % 2 == 0, 235.0, 175.0)
    # Red, green and blue peak a third of a turn apart.
    turns = (hue[:, np.newaxis] + np.array([0.0, 2.0 / 3.0, 1.0 / 3.0])) % 1.0
    pure = np.clip(np.abs(6.0 * turns - 3.0) - 1.0, 0.0, 1.0)
    colours = np.rint(bright[:, np.newaxis] * (0.25 + 0.75 * pure)).astype(np.uint8)
    for number, (_, colour) in CLASSES.items():
        colours[numbers == number] = colour
    return colours
