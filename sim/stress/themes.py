"""The themes of the stress suite, each with the expected outcome and the reason for it."""

from __future__ import annotations

from .camera import camera_cases, fov_cases, size_cases
from .case import Theme
from .clouds_moved import degenerate_cases, dtype_cases, normal_cases, transform_cases

__all__ = ["themes"]


def themes() -> dict[str, Theme]:
    """Return the themes by name, each with its cases."""
    return {
        "transforms": Theme(
            "Clouds in other units and far from zero",
            "A power of two scales every float exactly, so the code words must be the same, every"
            " bit. Other factors, and offsets up to 10^8, round each coordinate: a cloud of two"
            " units at 10^8 has steps of 1.5e-8 in float64, which moves a splat by about a"
            " millionth of a pixel. Of some 10^5 borders and depth steps in a picture less than one"
            " is crossed in the mean; 0.1 % of the pixels are allowed, and with them 0.35 dB.",
            tuple(transform_cases()),
        ),
        "degenerate": Theme(
            "Clouds without extent",
            "Planes, lines, single places, a depth range of zero: they are drawn like any other"
            " cloud. What is drawn lies where the reference has it, to within a pixel (two in"
            " `paper` and `fast`), and covers what it covers. Only a plane seen exactly edge on,"
            " with normals of its own, shows nothing and is refused.",
            tuple(degenerate_cases()),
        ),
        "camera": Theme(
            "Points at, behind and a hair in front of the eye",
            "Points at or behind the eye or before the near plane change no code word, only the"
            " order among elements of a line, and so no more than ties of depth."
            " A disc right before the eye covers the image, as it does in truth, and takes no more"
            " words than the image has blocks. (The last distance, 1e-300, has no square in"
            " float64; the reference is left out there.)",
            tuple(camera_cases()),
        ),
        "fov": Theme(
            "Fields of view and zooms",
            "Each field of view is as near to its own reference as 35 degrees is: no holes, nothing"
            " drawn where nothing is. `paper` and `fast` draw the first order of the projection,"
            " with the shape that the disc has in the middle of the image; from 120 degrees on"
            " their pictures are sound streams, but no longer near the truth, and the table says"
            " how far.",
            tuple(fov_cases()),
        ),
        "sizes": Theme(
            "Splats from a millionth of a pixel to thousands of pixels",
            "A splat that covers no pixel's centre is left out, or is the pixel that holds it; a"
            " huge one covers what the reference says. A disc that leans away is, at that size, no"
            " longer the ellipse of `paper` and `fast`: for those the stream must be sound.",
            tuple(size_cases()),
        ),
        "normals": Theme(
            "Normals of any length, none, and edge on",
            "Lengths from 2^-1000 to 2^1000 are taken out exactly. Zero, NaN and infinite normals"
            " are estimated from the neighbours: a picture as near to its reference as before, to"
            " within 0.5 dB (1 dB where all are estimated). A disc all but edge on is a line one"
            " pixel wide, and one past it is not drawn.",
            tuple(normal_cases()),
        ),
        "dtypes": Theme(
            "Files of float16 to float128, and of integers",
            "The same values are the same picture, whatever type holds them; integers may span"
            " their type. float32 holds no cloud of two units at 10^8: its step there is 8, and all"
            " points fall on one place. That is a property of the file, not of the renderer: what"
            " the file does hold is drawn, the same as from float64.",
            tuple(dtype_cases()),
        ),
    }
