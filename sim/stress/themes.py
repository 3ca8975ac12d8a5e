"""The themes of the stress suite, each with the expected outcome and the reason for it."""

from __future__ import annotations

from .camera import camera_cases, fov_cases, size_cases
from .case import Theme
from .clouds_moved import degenerate_cases, dtype_cases, normal_cases, transform_cases
from .planes import plane_cases

__all__ = ["themes"]


def themes() -> dict[str, Theme]:
    """Return the themes by name, each with its cases."""
    return {
        "transforms": Theme(
            "Clouds in other units and far from zero",
            "A power of two scales every float exactly, so the code words must be the same, bit for"
            " bit. Other factors, and offsets up to 10^8, round each coordinate. A cloud of two"
            " units at 10^8 has steps of 1.5e-8 in float64, which move a splat by about a"
            " millionth of a pixel. Of some 10^5 borders and depth steps in a picture, less than"
            " one is crossed in the mean. A change of 0.1 % of the pixels is allowed, and so is a"
            " loss of 0.35 dB.",
            tuple(transform_cases()),
        ),
        "degenerate": Theme(
            "Clouds without extent",
            "Planes, lines, single positions and a depth range of zero are drawn like any other"
            " cloud. The drawn pixels agree with the reference to within a pixel (two in `paper`"
            " and `fast`), and there are no holes. Only a plane that is seen exactly edge on and"
            " has normals of its own shows nothing and is refused.",
            tuple(degenerate_cases()),
        ),
        "camera": Theme(
            "Points at, behind and a hair in front of the eye",
            "Points at the eye, behind it or before the near plane change no code word. They change"
            " only the order of elements within a line, and so only pixels where depths tie. A disc"
            " right in front of the eye covers the image, as it does in the reference, and takes no"
            " more code words than the image has blocks. (The square of the last distance, 1e-300,"
            " is 0 in float64, so that case is not compared with the reference.)",
            tuple(camera_cases()),
        ),
        "fov": Theme(
            "Fields of view and zooms",
            "Each field of view must agree with its own reference as 35 degrees does: no holes, and"
            " no stray pixels. `paper` and `fast` use the first order of the projection, with the"
            " shape that the disc has in the middle of the image. From 120 degrees on, their"
            " streams are sound, but their pictures are far from the reference; see the table.",
            tuple(fov_cases()),
        ),
        "sizes": Theme(
            "Splats from a millionth of a pixel to thousands of pixels",
            "A splat that covers no pixel's centre is left out, or drawn as the pixel that contains"
            " it. A huge splat covers the same pixels as the reference. A slanted disc of that size"
            " is not an ellipse, as `paper` and `fast` assume, so for these only the stream must be"
            " sound.",
            tuple(size_cases()),
        ),
        "normals": Theme(
            "Normals of any length, none, and edge on",
            "Normals of lengths from 2^-1000 to 2^1000 are normalised exactly. Zero, NaN and"
            " infinite normals are estimated from the neighbours. The PSNR against the reference"
            " then falls by at most 0.5 dB (1 dB if all normals are estimated). A disc that is"
            " almost edge on is a line one pixel wide, and a disc past edge on is not drawn.",
            tuple(normal_cases()),
        ),
        "dtypes": Theme(
            "Files of float16 to float128, and of integers",
            "Equal values give equal pictures, whatever their data type, and integers may use the"
            " full range of their type. float32 cannot hold a cloud of two units at 10^8, as its"
            " step there is 8 and all points coincide. The file has lost the cloud in that case;"
            " its values must be drawn the same as from float64.",
            tuple(dtype_cases()),
        ),
        "planes": Theme(
            "Planes at the ends of what a word holds",
            "Drawn by `plane`. A word holds slopes of up to 252 levels a pixel; a wall that leans"
            " by 71 degrees and fills the depth range has them. A steeper plane is cut off so that"
            " it leans the same way and goes through its disc's centre, and so does one whose Z"
            " would be beyond its range. Slopes that vanish are 0. No depth wraps.",
            tuple(plane_cases()),
            qualities=("exact",),
        ),
    }
