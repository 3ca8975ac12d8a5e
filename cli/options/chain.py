"""The options of commands that know chains of engines."""

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
            help="With --engines: join the engines' pictures on the way out, or load each into the"
            " next.",
        ),
        click.option(
            "--engines",
            type=click.IntRange(1, MOST_ENGINES),
            metavar="N",
            default=None,
            show_default="one, without a chain",
            help="A chain of so many engines.",
        ),
    ):
        command = option(command)
    return command
