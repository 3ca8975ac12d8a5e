"""Scans of the ground that are seen from above."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .request import RenderRequest

if TYPE_CHECKING:
    from splatline.host.visibility.view import View

__all__ = ["seen_from_above"]


def seen_from_above(
    request: RenderRequest, camera: dict[str, Any], view: View
) -> tuple[float, float, float] | None:
    """Return the direction up if a survey is seen from above: its upper side is the outer one.

    From below, the ground shows its back; None then, and for all other clouds.
    """
    from splatline.host.files.source import usual_up
    from splatline.host.visibility.view import UP_AXES

    survey = request.path is not None and usual_up(request.path, request.format) == "z"
    return UP_AXES[camera["up"]] if survey and view.looks_down(camera["up"]) else None
