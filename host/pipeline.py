"""The host's work from end to end: a cloud and a view in, frames for the engine out."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.contract.presets import DEFAULT, PRESETS
from splatline.contract.variants import VARIANTS
from splatline.host.cloud.cloud import Cloud
from splatline.host.encode.quality import DEFAULT_QUALITY, QUALITIES, check_shapes
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.materials import Materials
from splatline.host.visibility.block_index import Index
from splatline.host.visibility.skips import DEFAULT_SKIPS, check_skips
from splatline.host.visibility.view import View

from .sample_positions import SAMPLES
from .stages import Stopwatch, draw_up, indexed

__all__ = ["make_frame", "make_frames", "total_counts"]


def make_frame(cloud: Cloud | Index, view: View, **options: Any) -> Frame:
    """Project, cull, shade, encode and sort a cloud, for one sample a pixel.

    ``options`` are those of :func:`make_frames` but ``samples``, and so are the errors.
    """
    (frame,) = make_frames(cloud, view, 1, **options)
    return frame


def make_frames(
    cloud: Cloud | Index,
    view: View,
    samples: int = 1,
    *,
    radii: npt.NDArray[np.floating[Any]] | None = None,
    lighting: Lighting | None = None,
    materials: Materials | None = None,
    config: EngineConfig = DEFAULT,
    quality: str = DEFAULT_QUALITY,
    skips: Iterable[str] = DEFAULT_SKIPS,
    depth_range: tuple[float, float] | None = None,
    shapes: str = "table",
) -> list[Frame]:
    """Project, cull, shade, encode and sort a cloud: frames whose mean has so many samples a pixel.

    An engine has one sample a pixel, opaque or not. The mean of frames whose images are shifted by
    parts of a pixel is the picture of as many samples: the accumulation buffer of Haeberli and
    Akeley, *The accumulation buffer: hardware support for high-quality rendering*, SIGGRAPH 1990.

    Each frame rounds its colours at another part of a level, which I0 tells the engine. Of four
    frames that a colour is the same in, as many show the level above as there are quarters of a
    level in it: so the mean of four frames has two bits of colour more, of sixteen four.

    Parameters
    ----------
    cloud
        The points; or their index (``build_index``), built once for many frames.
    view
        The camera and the size of the image.
    samples
        One of ``SAMPLES``.
    radii
        Radius of each point's disc, in the cloud's unit: shape (n,); see ``splat_radii``. An index
        has them already.
    lighting
        Lights and surface; the default ones if not given.
    materials
        The cloud's palette; found if not given. An index has it already.
    config
        The engine to draw it.
    quality
        One of ``QUALITIES``: ``paper``, ``fast`` or ``exact``.
    skips
        What to leave out, by name; see ``SKIPS``. If ``no_pixel`` would leave nothing at all, it is
        not applied.
    depth_range
        Distances along the view of depth 0 and of the largest depth, so that frames of one view can
        be put together; if not given, fitted to what the first frame that draws anything sees.
    shapes
        One of ``SHAPE_SOURCES``: where the shapes of the quality ``paper`` come from.

    Returns
    -------
    list of Frame
        ``counts`` of each has ``points``, ``dropped`` (reason -> points left out when the cloud was
        read), ``culled`` (reason -> points), ``elements`` (points drawn), ``quality``, ``skips``,
        ``shapes``, ``bits_sent`` (those of the stream, by the name of ``shapes``),
        ``codewords`` (length of the stream), ``control_words``, ``depth_range`` (distances along
        the view of depth 0 and of the largest depth) and ``seconds`` (per stage).

    Raises
    ------
    InputError
        If there is no pattern of so many samples, or the image is larger than the engine's or shows
        nothing of the cloud, or a radius is missing, negative or not finite; or if there is no
        quality, skip or source of shapes of a given name, or the ROM does not go with the rest.
    """
    if samples not in SAMPLES:
        raise InputError(
            f"no pattern of {samples} samples; there are: {', '.join(map(str, SAMPLES))}"
        )
    chosen = check_skips(skips)
    check_size(view.width, view.height, config)
    if quality not in QUALITIES:
        raise InputError(f"no quality named {quality!r}; there are: {', '.join(QUALITIES)}")
    check_shapes(shapes, quality, chosen, config)
    clock = Stopwatch()
    index = indexed(cloud, radii, materials, config, clock)

    def frames(left_out: frozenset[str]) -> list[Frame]:
        found: list[Frame] = []
        limits = depth_range
        for number, (right, down) in enumerate(SAMPLES[samples]):
            shift = view.shift[0] - right / 16.0, view.shift[1] - down / 16.0
            frame = draw_up(
                index,
                dataclasses.replace(view, shift=shift),
                left_out,
                lighting=lighting,
                config=config,
                quality=quality,
                depth_range=limits,
                shapes=shapes,
                rounding=(number + 0.5) / samples,
            )
            if limits is None and frame.counts["elements"]:
                limits = tuple(frame.counts["depth_range"])
            found.append(frame)
        return found

    found = _with_something(frames, chosen, index)
    found[0].counts["seconds"] = {**clock.laps, **found[0].counts["seconds"]}
    return found


def _with_something(
    frames: Callable[[frozenset[str]], list[Frame]], skips: frozenset[str], index: Index
) -> list[Frame]:
    """Return the frames of a picture, of which at least one draws something.

    Parameters
    ----------
    frames
        Makes them, with what is left out.
    skips
        What to leave out. If that leaves nothing for ``no_pixel``, it is not applied.
    index
        What is drawn.

    Raises
    ------
    InputError
        If nothing is in view.
    """
    found = frames(skips)
    culled: Counter[str] = Counter()
    for frame in found:
        culled.update(frame.counts["culled"])
    if any(frame.counts["elements"] for frame in found):
        return found
    if culled["no_pixel"] and "no_pixel" in skips:
        # Better a pixel for each than a picture of nothing.
        return _with_something(frames, skips - {"no_pixel"}, index)
    raise InputError(
        f"nothing of {index.cloud.name} is in view: of {len(index)} points, "
        + ", ".join(f"{count // len(found)} {reason}" for reason, count in culled.items() if count)
        + "; change the view"
    )


def check_size(width: int, height: int, config: EngineConfig) -> None:
    """Raise ``InputError`` if an engine cannot draw an image of this size."""
    if width > config.max_width or height > config.max_height:
        larger = [
            other.name
            for other in (*PRESETS.values(), *VARIANTS)
            if width <= other.max_width and height <= other.max_height
        ]
        raise InputError(
            f"the image is {width}x{height}; an engine of preset {config.name} draws at most "
            f"{config.max_width}x{config.max_height}"
            + (f"; preset {larger[0]} draws this size" if larger else "")
        )


def total_counts(frames: Sequence[Frame]) -> dict[str, Any]:
    """Return the counts of one picture's frames together: what was drawn and sent is added up.

    ``points`` and what else is the same for all stays as it is, and ``samples`` is their number.
    """
    first, *others = (frame.counts for frame in frames)
    total = dict(first)
    for counts in others:
        for name in _SUMMED & counts.keys():
            total[name] = _add(total[name], counts[name])
    return {**total, "samples": len(frames)}


_SUMMED = {"culled", "elements", "bits_sent", "codewords", "control_words", "seconds"}


def _add(one: Any, other: Any) -> Any:
    """Add numbers, or dictionaries of numbers."""
    if isinstance(one, dict):
        return {name: one.get(name, 0) + other.get(name, 0) for name in {**one, **other}}
    return one + other
