"""Options that several benchmarks share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import click

from splatline.cli.options.parameters import DIAMETER

__all__ = ["folder_option", "scenes_option", "splats_option"]

_Command = TypeVar("_Command", bound=Callable[..., Any])


def scenes_option(command: _Command) -> _Command:
    """Add the option ``scenes``: names of built-in scenes; an empty tuple means all scenes."""
    return click.option(
        "--scene",
        "scenes",
        multiple=True,
        metavar="NAME",
        show_default="all",
        help="Built-in scene; may be given several times.",
    )(command)


def splats_option(sizes: Sequence[float | None]) -> Callable[[_Command], _Command]:
    """Return a decorator for the option ``splats``: diameters in pixels, None for the spacing."""
    return click.option(
        "--splats",
        multiple=True,
        type=DIAMETER,
        metavar="auto|PIXELS",
        default=sizes,
        show_default=", ".join("auto" if size is None else f"{size:g}" for size in sizes),
        help="Median diameter of the splats; auto: the points' own spacing. May be given several"
        " times.",
    )


def folder_option(files: str) -> Callable[[_Command], _Command]:
    """Return a decorator for the option ``out_dir``, whose help names the files."""
    return click.option(
        "--out-dir",
        type=click.Path(path_type=Path),
        metavar="FOLDER",
        default=Path("docs/bench"),
        help=f"Folder for {files}.",
    )
