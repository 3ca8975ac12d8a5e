"""The statistics of a picture in tiles, before its tiles are made."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

__all__ = ["first_counts"]


def first_counts(
    points: int, dropped: dict[str, int], quality: str, skips: Iterable[str], *, close: bool
) -> dict[str, Any]:
    """Return the statistics of a picture of which nothing is made yet.

    They have the names of :func:`splatline.host.pipeline.make_frames`, and ``words_twice``,
    ``tiles`` and ``tiles_empty``.

    Parameters
    ----------
    points, dropped
        Points of the cloud, and those left out as it was read, by reason.
    quality, skips
        How splats become code words, and reasons to leave points out.
    close
        Whether specks are closed.
    """
    return {
        "points": points,
        "dropped": dropped,
        "culled": {},
        "elements": 0,
        "quality": quality,
        "skips": sorted(skips),
        "shapes": "table",
        "bits_sent": {"table": 0},
        "codewords": 0,
        "control_words": 0,
        **({"specks": 0} if close else {}),
        "words_twice": 0,
        "tiles": 0,
        "tiles_empty": 0,
        "depth_range": [0.0, 0.0],
        "seconds": {},
    }
