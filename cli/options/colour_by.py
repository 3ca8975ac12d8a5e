"""Options for what colours a point."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

from splatline.host.files.wanted import ColourBy

from .parameters import RANGE

__all__ = ["colour_by", "colour_options"]

_Command = TypeVar("_Command", bound=Callable[..., Any])


def colour_options(command: _Command) -> _Command:
    """Add the options ``colour``, ``colour_map`` and ``colour_range``, each None by default."""
    for option in (
        click.option(
            "--range",
            "colour_range",
            type=RANGE,
            metavar="LOW,HIGH",
            show_default="heights: those of the bulk; others: the middle 98 % of the values",
            help="With --colour: values at both ends of the map.",
        ),
        click.option(
            "--map",
            "colour_map",
            metavar="NAME",
            show_default="viridis; greys for the intensity",
            help="With --colour: one of matplotlib's colour maps; NAME_r is reversed.",
        ),
        click.option(
            "--colour",
            "--color",
            "colour",
            metavar="FIELD",
            show_default="the file's colours, else its intensity, else one colour",
            help="What colours a point: rgb, the file's own colours; height, the coordinate along"
            " --up; intensity; classification, the classes of the ASPRS standard in their usual"
            " colours; or a column of the file ('splatline info CLOUD' lists them).",
        ),
    ):
        command = option(command)
    return command


def colour_by(
    field: str | None, colour_map: str | None, ends: tuple[float, float] | None
) -> ColourBy | None:
    """Return what the options ask for, or None without a field.

    Raises
    ------
    click.UsageError
        If a map or a range is given without a field.
    InputError
        If the field has no use for them.
    """
    if field is not None:
        return ColourBy(field, colour_map, ends)
    for option, value in (("--map", colour_map), ("--range", ends)):
        if value is not None:
            raise click.UsageError(
                f"{option} needs --colour height, intensity or the name of a column"
            )
    return None
