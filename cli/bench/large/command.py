"""``splatline bench large``: clouds larger than the memory."""

from __future__ import annotations

import tempfile
from pathlib import Path

import click

from splatline.cli.bench.options import folder_option
from splatline.cli.options.outputs import check_folder, lines_of_json, write_text
from splatline.cli.options.parameters import SIZE
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Stages

__all__ = ["large"]


@click.command()
@click.argument("scan", required=False, type=click.Path(path_type=Path), metavar="[LAZ]")
@click.option(
    "--points",
    type=click.IntRange(min=1),
    metavar="N",
    default=100_000_000,
    help="Points of the scan that is made if there is no LAZ.",
)
@click.option(
    "--copc", type=click.Path(path_type=Path), metavar="FILE", help="The same points as COPC."
)
@click.option("--size", type=SIZE, metavar="WxH", default="1024x1024", help="Size of the picture.")
@click.option("--preset", default="wide2048", help="An engine that draws this size.")
@click.option("--memory", default="2G", metavar="SIZE", help="Memory for the cloud.")
@folder_option("large.json and large.md")
def large(
    scan: Path | None,
    points: int,
    copc: Path | None,
    size: tuple[int, int],
    preset: str,
    memory: str,
    out_dir: Path,
) -> None:
    """Measure how a LAZ file of any size is drawn: time, memory, COPC and Dask.

    \b
    Examples:
      splatline bench large                                100 million points, made first
      splatline bench large scan.laz --copc scan.copc.laz
      splatline bench large --points 2000000 --out-dir build/bench
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from splatline.cli.bench.large.make_scan import make_scan
    from splatline.cli.bench.large.measure import measure_large
    from splatline.cli.bench.large.page import write_page
    from splatline.cli.bench.machine import described

    check_folder(out_dir)
    tell_compiling()
    stages = Stages()
    with tempfile.TemporaryDirectory() as folder:
        if scan is None:
            scan = Path(folder) / "scan.laz"
            with stages.stage("make", f"Making a scan of {points:,} points") as share:
                make_scan(scan, points, progress=share)
        results = measure_large(
            scan, size, preset, memory, copc, lambda line: click.echo(line, err=True)
        )
    results = {"machine": described("laspy", "lazrs", "distributed"), **results}
    out_dir.mkdir(parents=True, exist_ok=True)
    write_text(out_dir / "large.json", lines_of_json(results))
    write_text(out_dir / "large.md", write_page(results))
    click.echo(f"written: {out_dir / 'large.json'}, {out_dir / 'large.md'}")
