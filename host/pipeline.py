"""The pipeline: a cloud and a view in, frames for the engine out."""

from __future__ import annotations

import dataclasses
import functools
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.contract.presets import DEFAULT
from splatline.contract.variants import CONFIGS
from splatline.host.cloud.cloud import Cloud
from splatline.host.encode.quality import DEFAULT_QUALITY, QUALITIES, check_shapes
from splatline.host.shading.lighting import Lighting
from splatline.host.shading.materials import Materials
from splatline.host.visibility.block_index import Index
from splatline.host.visibility.skips import DEFAULT_SKIPS, check_skips
from splatline.host.visibility.view import View, check_view

from .sample_positions import SAMPLES
from .stages import Stopwatch, draw_up, indexed

__all__ = [
    "check_request",
    "check_size",
    "make_frame",
    "make_frames",
    "nothing_in_view",
    "sample_views",
    "total_counts",
]

INDEX_FRAMES = 16
"""Frames that take about as long as palette and index of a large cloud."""


def make_frame(cloud: Cloud | Index, view: View, **options: Any) -> Frame:
    """Project, cull, shade, encode and sort a cloud, for one sample a pixel.

    Options and errors are those of :func:`make_frames`, except ``samples``.
    """
    (frame,) = make_frames(cloud, view, 1, **options)
    return frame


def make_frames(
    cloud: Cloud | Index,
    view: View,
    samples: int = 1,
    *,
    radii: npt.NDArray[np.floating[Any]] | None = None,
    thin: npt.NDArray[np.bool_] | None = None,
    cover: float = 1.0,
    lighting: Lighting | None = None,
    materials: Materials | None = None,
    config: EngineConfig = DEFAULT,
    quality: str = DEFAULT_QUALITY,
    skips: Iterable[str] = DEFAULT_SKIPS,
    depth_range: tuple[float, float] | None = None,
    shapes: str = "table",
    close_specks: bool = False,
    may_be_empty: bool = False,
    progress: Callable[[float], None] | None = None,
) -> list[Frame]:
    """Project, cull, shade, encode and sort a cloud: frames whose mean is the picture.

    An engine draws one sample a pixel. Each frame's image is shifted by a part of a pixel, and the
    mean of the frames has ``samples`` samples a pixel: the accumulation buffer of Haeberli and
    Akeley, *The accumulation buffer: hardware support for high-quality rendering*, SIGGRAPH 1990.

    Each frame rounds colours at another fraction of a level, which I0 tells the engine. The mean of
    four frames has two more bits of colour, of sixteen frames four.

    Parameters
    ----------
    cloud
        The points, or their index (``build_index``), which is built once for many frames.
    view
        The camera and the size of the image.
    samples
        One of ``SAMPLES``.
    radii
        Radius of each point's disc, as of ``measure_discs``: shape (n,). Not given with an index.
    thin
        Which points have no gap about them, as of ``measure_discs``: shape (n,). None: none.
    cover
        As of ``Discs.drawn``: small discs are trimmed where specks are closed. 1: none is.
    lighting
        Lights and surface; None: the default ones.
    materials
        The cloud's palette; None: it is computed. Not given with an index, which has one.
    config
        The configuration of the engine.
    quality
        One of ``QUALITIES``: ``paper``, ``fast`` or ``exact``. For an engine with planes ``fast``
        and ``exact`` are the same, and there is no ``paper``.
    skips
        Reasons to leave points out (``SKIPS``); ``no_pixel`` is ignored if it would leave nothing.
    depth_range
        Distances along the view of depth 0 and of the largest depth, the same in frames to be
        combined. None: the range of the first frame that draws anything.
    shapes
        One of ``SHAPE_SOURCES``: the source of the shapes of the quality ``paper``.
    close_specks
        Whether single pixels that show through a surface are closed; see ``encode.close_specks``.
        Not with shapes from the ROM.
    may_be_empty
        Whether frames that draw nothing are no error, as those of a part of a picture.
    progress
        Called with the share of the work that is done, after the index and after each frame.

    Returns
    -------
    list of Frame
        ``counts`` of each has ``points``, ``dropped`` (reason -> points left out when the cloud was
        read), ``culled`` (reason -> points), ``elements`` (points drawn), ``quality``, ``skips``,
        ``shapes``, ``specks`` (pixels that were closed, if they were), ``bits_sent`` (those of the
        stream, by the name of ``shapes``), ``codewords`` (length of the stream), ``control_words``,
        ``depth_range`` (distances along the view of depth 0 and of the largest depth) and
        ``seconds`` (per stage).

    Raises
    ------
    InputError
        If an option has no such value, or the ROM does not go with the other options. If the image
        is larger than the engine's, or shows nothing of the cloud. If a radius is missing, negative
        or not finite.
    """
    chosen = check_skips(skips)
    check_size(view.width, view.height, config)
    check_view(view)
    check_request(samples, config, quality, shapes, chosen)
    if close_specks and shapes != "table":
        raise InputError("specks are not closed among shapes from the ROM: take --shapes table")
    clock = Stopwatch()
    index = indexed(cloud, radii, thin, materials, config, clock)
    draw = functools.partial(
        draw_up,
        index,
        lighting=lighting,
        config=config,
        quality=quality,
        shapes=shapes,
        cover=cover,
        close=close_specks,
    )
    tell = _frame_counter(progress, samples, index is not cloud)
    frames = functools.partial(_frames_of_samples, draw, view, samples, depth_range, tell)
    found = frames(chosen) if may_be_empty else _with_something(frames, chosen, index)
    found[0].counts["seconds"] = {**clock.laps, **found[0].counts["seconds"]}
    return found


def check_request(
    samples: int, config: EngineConfig, quality: str, shapes: str, skips: frozenset[str]
) -> None:
    """Raise ``InputError`` if an option has no such value, or does not go with another."""
    if samples not in SAMPLES:
        raise InputError(
            f"no pattern of {samples} samples; there are: {', '.join(map(str, SAMPLES))}"
        )
    if quality not in QUALITIES:
        raise InputError(f"no quality named {quality!r}; there are: {', '.join(QUALITIES)}")
    if config.plane and quality == "paper":
        raise InputError(
            f"an engine of preset {config.name} draws every splat exactly; take quality exact,"
            " or preset rgb24 for quality paper"
        )
    check_shapes(shapes, quality, skips, config)


def _frame_counter(
    progress: Callable[[float], None] | None, samples: int, indexed: bool
) -> Callable[[int], None]:
    """Return what tells the share of some frames, and of the index if it was made here."""
    if progress is None:
        return lambda frames: None
    before = INDEX_FRAMES if indexed else 0

    def tell(frames: int) -> None:
        progress((before + frames) / (before + samples))

    tell(0)
    return tell


def _frames_of_samples(
    draw: Callable[..., Frame],
    view: View,
    samples: int,
    depth_range: tuple[float, float] | None,
    tell: Callable[[int], None],
    skips: frozenset[str],
) -> list[Frame]:
    """Return a frame for each sample, all with one depth range.

    Parameters
    ----------
    draw
        Returns the frame of a view; see ``draw_up``.
    view
        The view without a sample's shift.
    samples, depth_range, skips
        See :func:`make_frames`.
    tell
        Called with the number of frames that are made, after each.
    """
    found: list[Frame] = []
    limits = depth_range
    for shifted, rounding in sample_views(view, samples):
        frame = draw(shifted, skips, depth_range=limits, rounding=rounding)
        if limits is None and frame.counts["elements"]:
            limits = tuple(frame.counts["depth_range"])
        found.append(frame)
        tell(len(found))
    return found


def sample_views(view: View, samples: int) -> list[tuple[View, float]]:
    """Return the view of each sample of a pixel, and the rounding offset of its colours."""
    shifts = [
        (view.shift[0] - right / 16.0, view.shift[1] - down / 16.0)
        for right, down in SAMPLES[samples]
    ]
    return [
        (dataclasses.replace(view, shift=shift), (number + 0.5) / samples)
        for number, shift in enumerate(shifts)
    ]


def _with_something(
    frames: Callable[[frozenset[str]], list[Frame]], skips: frozenset[str], index: Index
) -> list[Frame]:
    """Return the frames of a picture; at least one of them draws something.

    Parameters
    ----------
    frames
        Returns the frames for a set of skips.
    skips
        Reasons to leave points out. ``no_pixel`` is ignored if it would leave nothing.
    index
        The points.

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
        # A picture of one pixel a point is better than an empty one.
        return _with_something(frames, skips - {"no_pixel"}, index)
    raise nothing_in_view(index, culled, len(found))


def nothing_in_view(index: Index, culled: Mapping[str, int], samples: int) -> InputError:
    """Return the error of a picture that shows nothing; ``culled`` is summed over the samples."""
    reasons = ", ".join(f"{count // samples} {why}" for why, count in culled.items() if count)
    return InputError(
        f"nothing of {index.cloud.name} is in view: of {len(index)} points, {reasons};"
        " change the view"
    )


def check_size(width: int, height: int, config: EngineConfig) -> None:
    """Raise ``InputError`` if an engine cannot draw an image of this size."""
    if width > config.max_width or height > config.max_height:
        larger = [
            other.name
            for other in CONFIGS.values()
            if width <= other.max_width and height <= other.max_height
        ]
        raise InputError(
            f"the image is {width}x{height}; an engine of preset {config.name} draws at most "
            f"{config.max_width}x{config.max_height}"
            + (f"; preset {larger[0]} draws this size" if larger else "")
        )


def total_counts(frames: Sequence[Frame]) -> dict[str, Any]:
    """Return the counts of a picture's frames together.

    Counts of drawn and sent data are added. Other counts are those of the first frame. ``samples``
    is the number of frames.
    """
    first, *others = (frame.counts for frame in frames)
    total = dict(first)
    for counts in others:
        for name in _SUMMED & counts.keys():
            total[name] = _add(total[name], counts[name])
    return {**total, "samples": len(frames)}


_SUMMED = {
    "culled", "elements", "bits_sent", "codewords", "control_words", "seconds", "specks",
}  # fmt: skip


def _add(one: Any, other: Any) -> Any:
    """Add numbers, or dictionaries of numbers."""
    if isinstance(one, dict):
        return {name: one.get(name, 0) + other.get(name, 0) for name in {**one, **other}}
    return one + other
