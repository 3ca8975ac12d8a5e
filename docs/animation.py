"""Parts of the manual's animated drawings: a small picture, and the motion of SVG.

A drawing has a panel of its own, so that it is legible on light and on dark pages. It moves by CSS
alone. Readers who ask their system for less motion see one moment of it.
"""

import base64
import dataclasses
import io

import numpy as np
from PIL import Image

from splatline.host import fit_view, load_scene, make_frame, splat_radii
from splatline.sim import golden

PANEL, TEXT, MUTED, EDGE = "#10151c", "#e6edf3", "#93a1b0", "#2b3644"

BACKGROUND = (24, 31, 40)
"""Colour of a pixel that nothing was drawn into."""


def small_frame(every, **options):
    """Return a frame of 96 x 96 pixels: one of ``every`` points of the knot, in preset rgb24."""
    scene = load_scene("knot")
    arrays = ("positions", "normals", "colours", "two_sided")
    few = {name: getattr(scene.cloud, name)[::every] for name in arrays}
    cloud = dataclasses.replace(scene.cloud, **few)
    radii = splat_radii(cloud)
    view = fit_view(cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up, size=(96, 96))
    return make_frame(cloud, view, radii=radii, **options)


def draw_first(frame, count):
    """Return the golden picture of the first ``count`` code words of a frame."""
    words = np.append(frame.codewords[:count], frame.codewords[-1])
    return golden.render(dataclasses.replace(frame, codewords=words))


def pixels_of(raster):
    """Return the colours of a raster with the drawing's background: (lines, columns, 3), uint8."""
    return np.where(raster.drawn[..., np.newaxis], raster.colour, BACKGROUND).astype(np.uint8)


def png(pixels):
    """Return pixels, of shape (lines, columns, 3), as the address of a PNG within the SVG."""
    file = io.BytesIO()
    picture = Image.fromarray(pixels).quantize(128, dither=Image.Dither.NONE)
    picture.save(file, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode()


def text(x, y, words, *, size=13, fill=TEXT, anchor="start", extra=""):
    """Return a line of text."""
    return (
        f'<text x="{x:g}" y="{y:g}" font-size="{size}" fill="{fill}" '
        f'text-anchor="{anchor}" {extra}>{words}</text>'
    )


def rect(x, y, width, height, *, fill="none", stroke="none", extra=""):
    """Return a rectangle."""
    return (
        f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" '
        f'fill="{fill}" stroke="{stroke}" {extra}/>'
    )


def keyframes(name, values, hold=0.0):
    """Return the rule of an animation that jumps from value to value, evenly in time.

    ``hold``: share of the time for which the last value stays.
    """
    step = (1.0 - hold) * 100.0 / len(values)
    kept, last = [], None
    for index, value in enumerate(values):
        if value != last:
            kept.append(f"{index * step:.4g}%{{{value}}}")
        last = value
    return f"@keyframes {name}{{{''.join(kept)}100%{{{last}}}}}"


def moves(name):
    """Return the attribute of an element that an animation moves."""
    return f'style="animation-name:{name}"'


def svg(width, height, seconds, still, title, rules, parts):
    """Return the drawing. ``still``: share of the time at which it rests for a calm reader."""
    style = (
        "text{font-family:system-ui,sans-serif}"
        ".mono{font-family:ui-monospace,monospace}"
        "image{image-rendering:pixelated}"
        f'[style^="animation"]{{animation-duration:{seconds}s;animation-iteration-count:infinite;'
        "animation-timing-function:step-end}"
        "@media (prefers-reduced-motion:reduce){"
        f'[style^="animation"]{{animation-play-state:paused;animation-delay:-{still * seconds}s}}}}'
    )
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
            f'width="{width}" height="{height}" role="img">',
            f"<title>{title}</title>",
            f"<style>{style}{''.join(rules)}</style>",
            rect(0.5, 0.5, width - 1, height - 1, fill=PANEL, stroke=EDGE, extra='rx="10"'),
            *parts,
            "</svg>\n",
        ]
    )
