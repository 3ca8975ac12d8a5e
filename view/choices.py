"""A person's choices in a live view beside the camera: each value by its name."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from splatline.contract.presets import PRESETS
from splatline.host.files.colouring import check_map
from splatline.host.files.wanted import ColourBy
from splatline.host.pipeline import check_request

from .draw import Settings
from .events import DEFAULT_COLOUR
from .hex_colour import hex_colour

__all__ = ["Choices"]


@dataclass(frozen=True)
class Choices:
    """The settings of a live view.

    Parameters
    ----------
    settings
        How a picture is drawn.
    colour
        What colours the points; None: the file's own colours.
    show
        ``picture`` or ``depth``.
    split
        The pictures at the left and the right, each of ``PICTURES``; None: the engine's alone.
    """

    settings: Settings = dataclasses.field(default_factory=Settings)
    colour: ColourBy | None = None
    show: str = "picture"
    split: tuple[str, str] | None = None

    def changed(self, name: str, value: Any) -> Choices:
        """Return the choices with another value.

        An engine with planes has no quality ``paper``; ``exact`` takes its place.

        Raises
        ------
        InputError
            If the value does not go with the others, or there is no such colour map.
        """
        if name == "colour":
            check_map(value)
        if name in ("colour", "show", "split"):
            return dataclasses.replace(self, **{name: value})
        settings = self.settings
        if name == "preset":
            preset = PRESETS[value]
            paper = preset.plane and settings.quality == "paper"
            quality = "exact" if paper else settings.quality
            settings = dataclasses.replace(settings, preset=preset, quality=quality)
        else:
            settings = dataclasses.replace(settings, **{name: value})
        check_request(settings.samples, settings.preset, settings.quality, "table", settings.skips)
        return dataclasses.replace(self, settings=settings)

    def described(self) -> dict[str, Any]:
        """Return the choices as plain values."""
        settings, by = self.settings, self.colour
        ends = None if by is None or by.range is None else list(by.range)
        return {
            "preset": settings.preset.name,
            "quality": settings.quality,
            "samples": settings.samples,
            "lights": settings.lights,
            "background": hex_colour(settings.background),
            "colour": {
                "by": DEFAULT_COLOUR if by is None else by.field,
                "map": None if by is None else by.map,
                "range": ends,
            },
            "show": self.show,
            "split": self.split and {"left": self.split[0], "right": self.split[1]},
        }
