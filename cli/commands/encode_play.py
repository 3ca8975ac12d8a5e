"""``splatline encode`` and ``play``: frames as files of code words."""

from __future__ import annotations

from pathlib import Path

import click

from splatline.cli.options.cloud_and_view import request_options
from splatline.cli.options.drawing import background_option, draw, engine_options, fail_mismatch
from splatline.cli.options.outputs import check_files, require_suffix, write_json
from splatline.cli.options.prepare import prepare
from splatline.cli.options.request import RenderRequest
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Stages
from splatline.cli.report.statistics import drawing_statistics

__all__ = ["encode", "play"]


@click.command()
@request_options
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FRAME",
    required=True,
    help="File of the code words; FRAME.json is written beside it.",
)
def encode(request: RenderRequest, output: Path) -> None:
    """Write the code words that draw a cloud, and a JSON sidecar.

    FRAME has little-endian 64-bit code words, sorted by line. FRAME.json has the view, the tables,
    the configuration and the counts.

    \b
    Examples:
      splatline encode scan.ply -o scan.frame
      splatline encode scan.ply --colour intensity --map magma -o scan.frame
      splatline encode --scene knot --orbit 80,10 -o knot.frame
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from splatline.host.frame_file import sidecar_path

    check_files((output, sidecar_path(output)), inputs=request.paths)
    tell_compiling()
    stages = Stages()
    prepared = prepare(request, stages)

    from splatline.host.frame_file import save_frame

    save_frame(prepared.frames[0], output, view=prepared.view)
    counts = prepared.frames[0].counts

    from splatline.cli.report.tables import colour_lines, format_value, nonzero, print_facts

    print_facts(
        [
            ("points", format_value(counts["points"])),
            ("not drawn", format_value(nonzero(counts["culled"]))),
            ("elements", format_value(counts["elements"])),
            ("code words", format_value(counts["codewords"])),
            ("control words", format_value(counts["control_words"])),
            *colour_lines(prepared.colour_key),
            *(("note", line) for line in prepared.notes),
            None,
            *((f"{stage}, s", f"{value:.3f}") for stage, value in stages.seconds.items()),
            None,
            ("written", str(output)),
            ("written", str(sidecar_path(output))),
        ],
        title=request.name,
    )


@click.command()
@click.argument("frame", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="PNG",
    show_default="the frame's name",
    help="The picture.",
)
@engine_options
@background_option
@click.option(
    "--depth", type=click.Path(path_type=Path), metavar="PNG", help="Write the depth as a picture."
)
@click.option("--stats", type=click.Path(path_type=Path), metavar="JSON", help="Write the numbers.")
@click.pass_context
def play(
    context: click.Context,
    frame: Path,
    output: Path | None,
    engine: str,
    stall: float,
    seed: int,
    background: tuple[float, float, float] | None,
    depth: Path | None,
    stats: Path | None,
) -> None:
    """Draw the code words of a FRAME that 'splatline encode' wrote.

    \b
    Examples:
      splatline play scan.frame -o scan.png
      splatline play scan.frame --engine rtl --stall 0.3 -o scan.png
    """  # noqa: D301
    if output is None:
        output = Path(f"{frame.stem}.png")
    require_suffix(output, ".png")
    require_suffix(depth, ".png")
    from splatline.host.frame_file import sidecar_path

    check_files((output, depth, stats), inputs=[frame, sidecar_path(frame)])
    tell_compiling()
    stages = Stages()
    with stages.stage("read", f"Reading {frame}"):
        from splatline.host.frame_file import load_frame

        loaded = load_frame(frame)
    drawing = draw([loaded], engine, stages, stall=stall, seed=seed)

    from splatline.plots import figure

    numbers = {
        "frame": str(frame),
        **drawing_statistics(
            [loaded], drawing, engine=engine, seconds=stages.seconds, stall=stall, seed=seed
        ),
    }
    figure.save_rgb(output, drawing.raster.to_rgb(background or figure.BACKGROUND))
    if depth is not None:
        figure.save_depth(depth, drawing.raster)
    if stats is not None:
        write_json(stats, numbers)

    from splatline.cli.report.tables import print_statistics

    files = [str(path) for path in (output, depth, stats) if path is not None]
    print_statistics(numbers, title=str(frame), files=files)
    if drawing.mismatched_pixels:
        fail_mismatch(context, drawing.mismatched_pixels)
