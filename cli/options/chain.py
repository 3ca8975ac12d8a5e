"""Options for chains of engines."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

from splatline.contract.chain_links import LINKS, MOST_ENGINES

__all__ = ["chain_options"]

_Command = TypeVar("_Command", bound=Callable[..., Any])


def chain_options(command: _Command) -> _Command:
    """Add the options ``engines``, a number or None, and ``link``."""
    for option in (
        click.option(
            "--link",
            type=click.Choice(LINKS),
            default=LINKS[0],
            help="With --engines: merge the engines' pictures, or load each picture into the next"
            " engine.",
        ),
        click.option(
            "--engines",
            type=click.IntRange(1, MOST_ENGINES),
            metavar="N",
            default=None,
            show_default="one engine, no chain",
            help="Number of engines in a chain.",
        ),
    ):
        command = option(command)
    return command
