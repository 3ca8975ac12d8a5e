"""Printed tables of facts; the JSON files have the same numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = [
    "colour_lines",
    "format_range",
    "format_value",
    "nonzero",
    "print_facts",
    "print_statistics",
    "print_table",
]

_Fact = tuple[str, "str | tuple[str, str]"]

MOST_CLASSES = 24
"""Classes of points that are printed; the JSON has more."""

_QUALITY = {
    "psnr_db": ("PSNR", "{:.2f} dB"),
    "psnr_foreground_db": ("PSNR, foreground", "{:.2f} dB"),
    "ssim": ("SSIM", "{:.4f}"),
    "hole_fraction": ("holes", "{:.3%}"),
    "silhouette_iou": ("silhouette IoU", "{:.4f}"),
    "depth_rmse": ("depth error, RMS", "{:.4g}"),
}


def print_statistics(stats: dict[str, Any], *, title: str, files: list[str]) -> None:
    """Print the summary of a drawn frame: counts, agreement, quality, times and files."""
    width, height = stats["size"]
    facts: list[_Fact | None] = [
        ("image", f"{width} x {height}, {stats['drawn_pixels']:,} pixels drawn"),
        ("engine", f"{stats['engine']}, preset {stats['preset']}"),
        ("quality", str(stats.get("quality", "-"))),
    ]
    if stats["samples"] > 1:
        facts.append(("samples a pixel", f"{stats['samples']}, a frame each, counted together"))
    for key, label in (
        ("dropped", "points not read"),
        ("points", "points"),
        ("culled", "not drawn"),
        ("elements", "elements"),
        ("specks", "pixels closed"),
    ):
        value = nonzero(stats.get(key))
        if value or value == 0:
            facts.append((label, format_value(value)))
    if "codewords" in stats:
        facts.append(
            ("code words", f"{stats['codewords']:,}, of them {stats['control_words']:,} control")
        )
    if "words_twice" in stats:
        facts.append(("sent again", f"{stats['words_twice']:,}, as they reach into another tile"))
    if "bits_sent" in stats:
        sent = [f"{bits:,} ({name})" for name, bits in stats["bits_sent"].items()]
        facts.append(("bits sent", ", ".join(sent)))
    if stats["cycles"] is not None:
        each = stats["cycles_per_element"]
        per = "" if each is None else f", {each:.3f} an element"
        facts += [None, ("clock cycles", f"{stats['cycles']:,}{per}")]
        facts.append(("pixels unlike golden", _verdict(stats["mismatched_pixels"])))
    if "psnr_db" in stats:
        facts.append(None)
        for key, (label, template) in _QUALITY.items():
            value = stats.get(key)
            facts.append((label, "-" if value is None else template.format(value)))
    if stats.get("colour"):
        facts += [None, *colour_lines(stats["colour"])]
    if stats.get("notes"):
        facts += [None, *(("note", line) for line in stats["notes"])]
    facts.append(None)
    facts += [(f"{stage}, s", f"{value:.3f}") for stage, value in stats["seconds"].items()]
    facts.append(None)
    facts += [("written", name) for name in files]
    print_facts(facts, title=title)


def print_facts(facts: list[_Fact | None], *, title: str) -> None:
    """Print a table of names and values; a value may have a style, and None separates groups."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(title=title, title_justify="left", show_header=False, min_width=44)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for fact in facts:
        if fact is None:
            table.add_section()
        else:
            # As Text, since a file's name may have square brackets, which rich takes as markup.
            table.add_row(fact[0], Text(*fact[1]) if isinstance(fact[1], tuple) else Text(fact[1]))
    Console().print(table)


def print_table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print rows of texts under titles; columns of numbers are aligned on the right."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(title_justify="left")
    for number, title in enumerate(titles):
        is_number = any(row[number][:1].lstrip("-").isdigit() for row in rows)
        table.add_column(title, justify="right" if is_number else "left", overflow="fold")
    for row in rows:
        table.add_row(*map(Text, row))
    Console().print(table)


def colour_lines(key: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    """Return lines of a table about a ``Cloud.colour_key``; none if it is empty."""
    if not key:
        return []
    by = f"{key['by']} along {key['up']}" if "up" in key else str(key["by"])
    lines = []
    if "classes" in key:
        for item in key["classes"][:MOST_CLASSES]:
            name = f" {item['name']}" if item["name"] else ""
            points = f"{format_value(item['points'])} points"
            lines.append((f"class {item['class']}", f"{item['colour']}{name}, {points}"))
        more = len(key["classes"]) - MOST_CLASSES + key["other_classes"]
        if more > 0:
            lines.append(("other classes", format_value(more)))
    elif key["range"] is None:
        by += ", but no point has a value"
    elif key["range"][0] == key["range"][1]:
        by += f", {format_value(key['range'][0])} for every point"
    else:
        low, high = format_range(*key["range"])
        by += f", {low} to {high}, map {key['map']}"
    if key["without_value"]:
        lines.append(("without a value", f"{format_value(key['without_value'])} points"))
    return [("coloured by", by), *lines]


def format_value(value: Any) -> str:
    """Return a number with thousands separators, or a dict as ``name 1, name 2``."""
    if isinstance(value, dict):
        parts = [f"{name.replace('_', ' ')} {format_value(part)}" for name, part in value.items()]
        return ", ".join(parts) or "none"
    if isinstance(value, (list, tuple)):
        return ", ".join(map(format_value, value))
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    return f"{value:,}" if isinstance(value, int) else f"{value:,.6g}"


def format_range(low: float, high: float) -> tuple[str, str]:
    """Return both ends of a range with as many digits as tell a thousandth of it, and at least six.

    Whole numbers keep all of their digits.
    """
    digits = 6
    if low < high and max(abs(low), abs(high)) < math.inf:
        digits += max(0, math.ceil(math.log10(max(abs(low), abs(high)) / (high - low))) - 2)
    low_text, high_text = (
        f"{end:,}" if isinstance(end, int) else f"{end:,.{min(digits, 17)}g}" for end in (low, high)
    )
    return low_text, high_text


def nonzero(value: Any) -> Any:
    """Return a dict without its zeros, or any other value itself."""
    if isinstance(value, dict):
        return {name: part for name, part in value.items() if part}
    return value


def _verdict(mismatched: int) -> tuple[str, str]:
    return f"{mismatched:,}", "bold red" if mismatched else "green"
