"""``splatline info``: what a cloud or a frame holds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Stages

__all__ = ["info"]

GENERAL = ("format", "points")
EXTENT = ("low", "high", "extent", "splat_size")
CHECKS = ("dropped", "far_from_the_rest", "estimated_normals", "colours")
"""Facts of a cloud in the order in which they are printed; others stand between the first two."""

COLUMNS = ("columns_used", "columns_ignored", "notes", "fields")


@click.command()
@click.argument("path", type=click.Path(path_type=Path), metavar="CLOUD|FRAME")
@click.option(
    "--header",
    "depth",
    flag_value="header",
    help="Read the header alone: format, number of points, fields and their types; of LAS the"
    " extent too.",
)
@click.option(
    "--full",
    "depth",
    flag_value="full",
    help="Read all values of a large file too, for the ranges of its fields, extent and spacing.",
)
@click.option(
    "--format",
    metavar="NAME",
    show_default="by the name of CLOUD",
    help="Format of CLOUD, as 'splatline render' takes it; '-' as CLOUD is the standard input.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def info(path: Path, depth: str | None, format: str | None, as_json: bool) -> None:
    """Describe a cloud or a frame: format, points, fields with ranges, extent, spacing.

    Values are read if that takes about a second: up to 256 MB of a binary file, 16 MB of a text or
    a LAZ file. Of larger files the header tells.

    \b
    Examples:
      splatline info scan.ply
      splatline info scan.laz --header
      splatline info scan.laz --full --json
      splatline info scan.frame --json
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from splatline.host.files.readers import FORMATS
    from splatline.host.files.source import format_suffix
    from splatline.host.frame_file import sidecar_path

    # A frame may have any name, but its sidecar lies beside it.
    is_frame = (
        format is None
        and path.is_file()
        and format_suffix(path) not in FORMATS
        and (path.suffix.lower() == ".frame" or sidecar_path(path).is_file())
    )
    facts = _frame_facts(path) if is_frame else _cloud_facts(path, depth or "quick", format)
    if as_json:
        click.echo(json.dumps(facts, indent=2, allow_nan=False))
    elif is_frame:
        from splatline.cli.report.tables import format_value, print_facts

        print_facts(
            [(key.replace("_", " "), format_value(value)) for key, value in facts.items()],
            title=str(path),
        )
    else:
        _print_cloud(facts, str(path))


def _frame_facts(path: Path) -> dict[str, Any]:
    """Return the facts of a frame, with the encoder's counts if the sidecar has them."""
    from splatline.host.frame_file import describe_frame, load_frame

    facts = describe_frame(load_frame(path))
    counts = facts.pop("counts")
    return {**counts, **facts}


def _cloud_facts(path: Path, depth: str, format: str | None) -> dict[str, Any]:
    """Return the facts of a cloud, in the file's own coordinates."""
    from splatline.host.files.survey import survey

    tell_compiling()
    stages = {"read": f"Reading {path}", "spacing": f"Measuring the spacing of {path.name}"}
    with Stages().stages(stages) as tell:
        return survey(path, depth, format=format, progress=tell)


def _print_cloud(facts: dict[str, Any], title: str) -> None:
    """Print a table of facts, and one of the fields; what is not known is left out."""
    from splatline.cli.report.tables import (
        format_range,
        format_value,
        nonzero,
        print_facts,
        print_table,
    )

    known = {key: nonzero(value) for key, value in facts.items() if value is not None}
    if "low" in known:
        ends = [format_range(*pair) for pair in zip(known["low"], known["high"], strict=True)]
        known["low"], known["high"] = (", ".join(texts) for texts in zip(*ends, strict=True))
    others = [key for key in known if key not in (*GENERAL, *EXTENT, *CHECKS, *COLUMNS)]
    print_facts(
        [
            *(
                (key.replace("_", " "), format_value(known[key]))
                for key in (*GENERAL, *others, *EXTENT, *CHECKS)
                if key in known
            ),
            *(("note", line) for line in known["notes"]),
        ],
        title=title,
    )
    rows: list[tuple[str, ...]] = []
    for field in known["fields"]:
        ends = ("", "")
        if field["low"] is not None:
            ends = format_range(field["low"], field["high"])
        missing = f", {field['not_finite']:,} not finite" if field["not_finite"] else ""
        rows.append((field["name"], field["type"] or "", *ends, (field["used_as"] or "") + missing))
    titles = ("field", "type", "low", "high", "taken for")
    shown = [number for number in range(5) if number != 1 or any(row[1] for row in rows)]
    if not any(row[2] for row in rows):
        shown = [number for number in shown if number not in (2, 3)]
    print_table([titles[i] for i in shown], [[row[i] for i in shown] for row in rows])
