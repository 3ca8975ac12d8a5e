"""Several samples a pixel: as many frames, each seen from a fraction of a pixel further.

An engine has one sample a pixel, opaque or not. The mean of frames whose images are shifted by
parts of a pixel is the picture of as many samples: the accumulation buffer of Haeberli and Akeley,
*The accumulation buffer: hardware support for high-quality rendering*, SIGGRAPH 1990.

Each frame rounds its colours at another part of a level, which I0 tells the engine. Of four frames
that a colour is the same in, as many show the level above as there are quarters of a level in it:
so the mean of four frames has two bits of colour more, of sixteen four, from the same engine.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

from ..rtl.format import PAPER
from .cloud import Cloud
from .errors import InputError
from .frame import Frame
from .index import Index
from .pipeline import Stopwatch, indexed, make_frame
from .sample_places import SAMPLES
from .view import View

__all__ = ["make_frames", "total_counts"]


def make_frames(
    cloud: Cloud | Index,
    view: View,
    samples: int = 1,
    *,
    depth_range: tuple[float, float] | None = None,
    **options: Any,
) -> list[Frame]:
    """Return the frames whose mean has so many samples a pixel.

    Parameters
    ----------
    cloud, view, depth_range, options
        As :func:`splatline.host.pipeline.make_frame` takes them. The frames have one depth range:
        that of the first, unless it is given.
    samples
        One of ``SAMPLES``.

    Raises
    ------
    InputError
        If there is no pattern of so many samples, and as ``make_frame`` does.
    """
    if samples not in SAMPLES:
        raise InputError(
            f"no pattern of {samples} samples; there are: {', '.join(map(str, SAMPLES))}"
        )
    clock = Stopwatch()
    known = options.pop("radii", None), options.pop("materials", None)
    index = indexed(cloud, *known, options.get("config", PAPER), clock)
    frames: list[Frame] = []
    for number, (right, down) in enumerate(SAMPLES[samples]):
        shift = view.shift[0] - right / 16.0, view.shift[1] - down / 16.0
        moved = dataclasses.replace(view, shift=shift)
        rounding = (number + 0.5) / samples
        frames.append(
            make_frame(index, moved, depth_range=depth_range, rounding=rounding, **options)
        )
        depth_range = depth_range or tuple(frames[0].counts["depth_range"])
    frames[0].counts["seconds"] = {**clock.laps, **frames[0].counts["seconds"]}
    return frames


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
