"""First message of a live view: the cloud and its choices, once it is read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from splatline.host.encode.quality import QUALITIES
from splatline.host.sample_positions import SAMPLES
from splatline.host.shading.light_sets import LIGHTS

from .hardware import preset_facts

if TYPE_CHECKING:
    from .session import Session

__all__ = ["MAPS", "greeting"]

MAPS = ("viridis", "cividis", "magma", "inferno", "turbo", "terrain", "coolwarm", "gray")
"""Colour maps that are offered; any other of matplotlib's is taken too."""

LIGHT_TITLES = {
    "studio": "from above left, with a fill light",
    "front": "from the eye",
    "side": "grazing, which shows relief",
    "matte": "as studio, without highlights",
    "none": "the points' own colours",
}
"""A few words about each set of lights."""


def greeting(session: Session) -> dict[str, Any]:
    """Return the message ``hello`` of a session whose cloud is read."""
    live, subject = session.live, session.subject
    assert live is not None
    far = live.far_away
    notes = list(live.cloud.notes)
    notes += [f"{far:,} points lie far from the rest, and are not shown"] if far else []
    return {
        "type": "hello",
        "name": subject.name,
        "points": len(live.cloud),
        "colours": subject.colours(),
        "maps": list(MAPS),
        "presets": preset_facts(),
        "qualities": [{"name": name, "title": title} for name, title in QUALITIES.items()],
        "lights": [{"name": name, "title": LIGHT_TITLES[name]} for name in LIGHTS],
        "samples": list(SAMPLES),
        "notes": notes,
    }
