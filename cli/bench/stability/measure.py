"""``splatline bench stability``: the stress suite as a page of tables."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from splatline.cli.bench.markdown import table
from splatline.cli.bench.options import folder_option
from splatline.cli.options.outputs import check_folder, write_text
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.statistics import tool_versions

if TYPE_CHECKING:
    from splatline.sim.stress.case import Outcome, Theme

__all__ = ["stability"]

HEADS = (
    "case", "pixels changed", "PSNR to the plain picture", "PSNR to the reference", "holes",
    "stray", "depth off", "words", "as expected",
)  # fmt: skip

NONE = "-"
"""Cell of a table without a number."""

INTRODUCTION = """\
# Numerical stability

Made by `splatline bench stability`; the tests in `tests/sim/stress/` use the same cases. Every case
is drawn in each quality ({qualities}; planes have but one) and compared with the exact reference of
the same input ({samples} x {samples} rays a pixel, float64). If a case has a plain input whose
picture it must reproduce, it is compared with that picture too. Each number is the worst of the
qualities.

- **Pixels changed**: share of pixels whose depth or colour differs from the plain picture.
- **PSNR**: in dB, against the plain picture (*same*: no difference) and against the reference. With
  three bits a channel the plain clouds have 17 to 23 dB.
- **Holes**: share of background among the pixels that the reference covers fully.
- **Stray**: share of drawn pixels that are further from the reference's coverage than rounding
  explains, which is 1 pixel in `exact` and 2 pixels in `paper` and `fast`.
- **Depth off**: share of pixels whose depth differs from the reference's at their centre by more
  than {far} of the depth range, of those that both draw; for planes alone.
- **Words**: number of code words, the largest of the qualities.

Every stream is also checked: it ends once, no code word is outside the image or at the background's
depth, there are no more code words than the sizes of the discs need, and every point is either
drawn or counted as left out. A floating-point warning of numpy is an error.
"""


@click.command()
@folder_option("stability.json and stability.md")
def stability(out_dir: Path) -> None:
    """Draw clouds, views and normals that are numerically hard, and tabulate the errors.

    Exit code 1 if a case is not as expected; the tables are written in any case.

    \b
    Examples:
      splatline bench stability
      splatline bench stability --out-dir build/bench
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    check_folder(out_dir)
    tell_compiling()
    begin = time.perf_counter()
    results = _measure()
    results["seconds"] = round(time.perf_counter() - begin, 1)
    out_dir.mkdir(parents=True, exist_ok=True)
    write_text(out_dir / "stability.json", _json(results))
    write_text(out_dir / "stability.md", _page(results))
    cases = [case for theme in results["themes"] for case in theme["cases"]]
    wrong = [case for case in cases if not case["as_expected"]]
    click.echo(
        f"{len(cases) - len(wrong)} of {len(cases)} cases as expected; "
        f"written: {out_dir / 'stability.json'}, {out_dir / 'stability.md'}"
    )
    if wrong:
        raise click.exceptions.Exit(1)


def _measure() -> dict[str, Any]:
    """Return every case's outcomes, by theme."""
    import numba
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from splatline.host.encode.quality import QUALITIES
    from splatline.sim.stress.case import FAR, REACH, SAMPLES, measure
    from splatline.sim.stress.themes import themes

    # The pictures are so small that starting threads would take most of the time.
    numba.set_num_threads(1)
    console = Console(stderr=True)
    found = []
    chosen = themes()
    with Progress(
        BarColumn(bar_width=30),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.description}", markup=False),
        console=console,
        transient=True,
        disable=not console.is_terminal,
    ) as progress:
        task = progress.add_task("", total=sum(len(theme.cases) for theme in chosen.values()))
        for name, theme in chosen.items():
            if not console.is_terminal:
                console.print(f"{theme.title} ...", highlight=False, markup=False, soft_wrap=True)
            rows = []
            for case in theme.cases:
                progress.update(task, description=case.name)
                outcomes = {quality: measure(case, quality) for quality in theme.qualities}
                rows.append(_row(case.name, case.base is not None, outcomes))
                progress.advance(task)
            found.append(_theme(name, theme, rows))
    return {
        "versions": tool_versions("golden"),
        "qualities": list(QUALITIES),
        "samples": SAMPLES,
        "reach": REACH,
        "far": FAR,
        "themes": found,
    }


def _theme(name: str, theme: Theme, rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    return {"name": name, "title": theme.title, "expected": theme.expected, "cases": list(rows)}


def _row(name: str, based: bool, outcomes: dict[str, Outcome]) -> dict[str, Any]:
    """Return a case's outcomes by quality and the worst of them, ready for JSON."""
    import dataclasses

    from splatline.sim.stress.case import Outcome

    plain = {
        quality: {**dataclasses.asdict(outcome), "problems": list(outcome.problems)}
        for quality, outcome in outcomes.items()
    }
    # None is the best value: no difference, or nothing to compare.
    fields = [field.name for field in dataclasses.fields(Outcome)]
    lowest = {"psnr_base_db", "psnr_db", "drawn"}
    worst: dict[str, Any] = {}
    for key in fields:
        values = [row[key] for row in plain.values() if row[key] is not None]
        if key != "problems":
            worst[key] = (min if key in lowest else max)(values) if values else None
    return {
        "case": name,
        "has_base": based,
        "as_expected": not any(row["problems"] for row in plain.values()),
        "worst": worst,
        "qualities": plain,
    }


def _json(results: dict[str, Any]) -> str:
    """Return JSON in which each case has a line of its own, for line-by-line diffs."""
    themes = []
    for theme in results["themes"]:
        rows = ",\n".join(f"      {json.dumps(case, allow_nan=False)}" for case in theme["cases"])
        heads = "".join(
            f"      {json.dumps(key)}: {json.dumps(theme[key])},\n"
            for key in ("name", "title", "expected")
        )
        themes.append("    {\n" + heads + f'      "cases": [\n{rows}\n      ]' + "\n    }")
    rest = "".join(
        f"  {json.dumps(key)}: {json.dumps(value, allow_nan=False)},\n"
        for key, value in results.items()
        if key != "themes"
    )
    return "{\n" + rest + '  "themes": [\n' + ",\n".join(themes) + "\n  ]\n}\n"


def _page(results: dict[str, Any]) -> str:
    """Return the results as Markdown."""
    qualities = ", ".join(f"`{name}`" for name in results["qualities"])
    parts = [
        INTRODUCTION.format(
            qualities=qualities, samples=results["samples"], far=_percent(results["far"])
        )
    ]
    heads = ("theme", "cases", "as expected", "most pixels changed", "most holes", "most stray")
    rows = []
    for theme in results["themes"]:
        cases = theme["cases"]
        link = f"[{theme['title']}](#{_anchor(theme['title'])})"
        good = sum(case["as_expected"] for case in cases)
        most = [_most(cases, key) for key in ("changed", "holes", "stray")]
        rows.append([link, str(len(cases)), str(good), *map(_percent, most)])
    parts.append(table(heads, rows, words=1) + "\n")
    for theme in results["themes"]:
        parts.append(f"## {theme['title']}\n\n{theme['expected']}\n")
        parts.append(table(HEADS, (_cells(case) for case in theme["cases"]), words=1) + "\n")
        parts.extend(_complaints(theme["cases"]))
    return "\n".join(parts)


def _cells(case: dict[str, Any]) -> list[str]:
    worst = case["worst"]
    same = "same" if case["has_base"] and worst["changed"] is not None else NONE
    refused = all(row["refused"] for row in case["qualities"].values())
    return [
        case["case"],
        _percent(worst["changed"]),
        same if worst["psnr_base_db"] is None else f"{worst['psnr_base_db']:.1f}",
        NONE if worst["psnr_db"] is None else f"{worst['psnr_db']:.1f}",
        _percent(worst["holes"]),
        _percent(worst["stray"]),
        _percent(worst["depth_off"]),
        "nothing in view" if refused else str(worst["words"]),
        "yes" if case["as_expected"] else "**no**",
    ]


def _complaints(cases: Iterable[dict[str, Any]]) -> Iterable[str]:
    """Return a Markdown list of the problems; empty if there are none."""
    lines = [
        f"- {case['case']}, `{quality}`: {'; '.join(row['problems'])}"
        for case in cases
        for quality, row in case["qualities"].items()
        if row["problems"]
    ]
    return ["Not as expected:\n\n" + "\n".join(lines) + "\n"] if lines else []


def _most(cases: Iterable[dict[str, Any]], key: str) -> float | None:
    values = [case["worst"][key] for case in cases]
    return max((value for value in values if value is not None), default=None)


def _percent(share: float | None) -> str:
    """Return a share in percent with at most three decimals, or a dash for None."""
    if share is None:
        return NONE
    if share == 0.0:
        return "0"
    digits = max(0, min(3, 1 - math.floor(math.log10(100.0 * share))))
    return f"{100.0 * share:.{digits}f} %"


def _anchor(title: str) -> str:
    """Return a heading's anchor, as a link's target."""
    kept = "".join(mark for mark in title.lower() if mark.isalnum() or mark in " -_")
    return kept.replace(" ", "-")
