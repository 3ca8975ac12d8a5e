"""Scans of the ground that are seen from above."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .request import RenderRequest

if TYPE_CHECKING:
    from splatline.host.visibility.view import View

__all__ = ["is_survey", "seen_from_above"]

SURVEYS = (".las", ".laz", ".e57", ".ptx")
"""Formats of surveyors, whose z points up."""


def is_survey(request: RenderRequest) -> bool:
    """Return whether a request's file has a surveyor's format."""
    return request.path is not None and request.path.suffix.lower() in SURVEYS


def seen_from_above(
    request: RenderRequest, camera: dict[str, Any], view: View
) -> tuple[float, float, float] | None:
    """Return the direction up if a survey is seen from above: its upper side is the outer one.

    From below, the ground shows its back; None then, and for all other clouds.
    """
    from splatline.host.visibility.view import UP_AXES

    up = UP_AXES[camera["up"]]
    downward = -sum(a * b for a, b in zip(view.axes[2], up, strict=True))
    return up if is_survey(request) and downward >= 0.0 else None
