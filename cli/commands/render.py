"""``splatline render``: from a cloud to a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from splatline.cli.options.chain import chain_options
from splatline.cli.options.cloud_and_view import request_options
from splatline.cli.options.drawing import (
    Drawing,
    background_option,
    draw,
    engine_options,
    fail_mismatch,
)
from splatline.cli.options.outputs import check_files, check_folder, require_suffix, write_json
from splatline.cli.options.prepare import prepare
from splatline.cli.options.prepared import PreparedFrames
from splatline.cli.options.request import RenderRequest
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Stages
from splatline.cli.report.statistics import drawing_statistics
from splatline.contract.errors import InputError
from splatline.host.sample_positions import SAMPLES

from .render_tiles import TileOptions, fits_engine, refuse_with_tiles, render_tiles

if TYPE_CHECKING:
    from splatline.sim.reference.reference import Reference

__all__ = ["render"]

_Colour = tuple[float, float, float]


@click.command()
@request_options
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="PNG",
    show_default="the cloud's name, unless --out-dir is given",
    help="The picture.",
)
@click.option(
    "--samples",
    type=click.Choice([str(number) for number in SAMPLES]),
    default="1",
    help="Samples a pixel. Each sample is a frame of its own, shifted by part of a pixel, so code"
    " words and cycles are multiplied. The picture is the mean of the frames.",
)
@engine_options
@chain_options
@background_option
@click.option(
    "--depth", type=click.Path(path_type=Path), metavar="PNG", help="Write the depth as a picture."
)
@click.option(
    "--reference", is_flag=True, help="Draw the exact reference too, and measure the error."
)
@click.option("--stats", type=click.Path(path_type=Path), metavar="JSON", help="Write the numbers.")
@click.option(
    "--out-dir",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Write all pictures, a figure of them side by side, and stats.json; implies --reference.",
)
@click.pass_context
def render(
    context: click.Context,
    request: RenderRequest,
    output: Path | None,
    samples: str,
    engine: str,
    stall: float,
    seed: int,
    engines: int | None,
    link: str,
    background: _Colour | None,
    depth: Path | None,
    reference: bool,
    stats: Path | None,
    out_dir: Path | None,
) -> None:
    """Draw a point cloud, or a built-in scene if there is no CLOUD.

    CLOUD is a LAS, LAZ, E57, PLY, PCD, PTS, PTX, XYZ, CSV or NPZ file or of a kind like these, or a
    mesh as OBJ, STL, OFF or GLB; also compressed (.gz). '-' is the standard input. The vertices of
    a mesh are taken as points, or its faces are sampled.

    \b
    Examples:
      splatline render                                     the terrain, as terrain.png
      splatline render scan.ply -o scan.png --orbit 30,20
      splatline render scan.ply --size 512x384 --fov 25 --up z --splat-size 0.05
      splatline render scan.ply --target 3.5,-2,0 --distance 8    look at a point
      splatline render scan.laz                            a LAS, LAZ or PLY file of any size
      splatline render tiles/*.laz --memory 2G             many files as one cloud
      splatline render tiles/*.laz --dask local            the same by all cores, with Dask
      splatline render part.stl --sample 1000000           points on the faces of a mesh
      splatline render - --format ply -o scan.png          from another program
      splatline render scan.ply --samples 4                smooth edges, four frames
      splatline render scan.ply --size 16384x16384         a poster: drawn in tiles, no seams
      splatline render scan.ply --up z --colour height --map turbo
      splatline render scan.ply --colour intensity --map magma --range 0,4000
      splatline render scan.ply --colour classification    ground brown, buildings red ...
      splatline render --scene knot --engine rtl           simulate the Verilog, compare
      splatline render --engine rtl --engines 4            the same with a chain of four
      splatline render scan.ply --reference --stats scan.json
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    if output is None and out_dir is None:
        output = Path(f"{request.name}.png")
    require_suffix(output, ".png")
    require_suffix(depth, ".png")
    check_folder(out_dir)
    numbers_of_set = out_dir / "stats.json" if out_dir is not None and out_dir.is_dir() else None
    check_files((output, depth, stats, numbers_of_set), inputs=request.paths)

    tell_compiling()
    stages = Stages()
    if not fits_engine(request):
        options = TileOptions(
            request.preset, int(samples), engine, stall, seed, background, output, depth, stats
        )
        refuse_with_tiles(request, engine, engines, reference or out_dir is not None)
        render_tiles(context, request, options, stages)
        return
    prepared = prepare(request, stages, int(samples))
    if prepared.cloud is None and (reference or out_dir is not None):
        raise InputError("the exact reference is drawn of a cloud that fits the memory alone")
    drawing = draw(
        prepared.frames, engine, stages, stall=stall, seed=seed, engines=engines, link=link
    )
    if background is None:
        from splatline.plots.figure import BACKGROUND

        background = BACKGROUND
    exact = None
    quality: dict[str, Any] = {}
    if reference or out_dir is not None:
        exact, quality = _measure(prepared, drawing, request.lights, background, stages)

    files = _write_pictures(drawing, background, output, depth, stages)
    numbers = {
        "cloud": " ".join(map(str, request.paths)) or f"scene {request.scene}",
        "view": prepared.camera,
        "splat_size": request.splat_size or "auto",
        "dropped": prepared.dropped,
        "far_away": prepared.far_away,
        "colour": prepared.colour_key or None,
        "notes": prepared.notes,
        **prepared.facts,
        **drawing_statistics(
            prepared.frames, drawing, engine=engine, seconds=stages.seconds, stall=stall, seed=seed
        ),
        **({} if engines is None else {"engines": engines, "link": link}),
        **quality,
    }
    files += _write_numbers(drawing, exact, background, numbers, stats, out_dir)

    from splatline.cli.report.tables import print_statistics

    print_statistics(numbers, title=request.name, files=files)
    if drawing.mismatched_pixels:
        fail_mismatch(context, drawing.mismatched_pixels)


def _measure(
    prepared: PreparedFrames, drawing: Drawing, lights: str, background: _Colour, stages: Stages
) -> tuple[Reference, dict[str, Any]]:
    """Draw the exact reference and compare the engine's picture with it."""
    from splatline.host.shading.light_sets import LIGHTS
    from splatline.host.visibility.trim import trimmed_radii
    from splatline.sim import reference
    from splatline.sim.reference import metrics

    assert prepared.cloud is not None
    assert prepared.discs is not None
    radii, _, cover = prepared.discs
    with stages.stage("reference", "Drawing the exact reference") as share:
        exact = reference.render(
            prepared.cloud,
            prepared.view,
            trimmed_radii(prepared.cloud.positions, radii, prepared.view, cover),
            LIGHTS[lights],
            background=background,
            progress=share,
        )
    with stages.stage("metrics", "Measuring the error"):
        quality = metrics.compare(
            drawing.raster,
            exact,
            background=background,
            depth_range=prepared.frames[0].counts["depth_range"],
        )
    return exact, quality


def _write_pictures(
    drawing: Drawing,
    background: _Colour,
    output: Path | None,
    depth: Path | None,
    stages: Stages,
) -> list[str]:
    """Write the picture and that of the depth, if they were asked for; return their names."""
    if output is None and depth is None:
        return []
    with stages.stage("write", "Writing the picture"):
        from splatline.plots import figure

        if output is not None:
            figure.save_rgb(output, drawing.raster.to_rgb(background))
        if depth is not None:
            figure.save_depth(depth, drawing.raster)
    return [str(path) for path in (output, depth) if path is not None]


def _write_numbers(
    drawing: Drawing,
    exact: Reference | None,
    background: _Colour,
    numbers: dict[str, Any],
    stats: Path | None,
    out_dir: Path | None,
) -> list[str]:
    """Write the numbers and the set of pictures, if they were asked for; return their names."""
    files = []
    if stats is not None:
        write_json(stats, numbers)
        files.append(str(stats))
    if out_dir is not None:
        assert exact is not None, "a set of pictures has the reference in it"
        from splatline.plots import figure

        out_dir.mkdir(parents=True, exist_ok=True)
        figure.picture_set(
            out_dir,
            rtl=drawing.rtl,
            golden=drawing.golden,
            reference=exact,
            background=background,
            stats=numbers,
        )
        write_json(out_dir / "stats.json", numbers)
        files.append(f"{out_dir}/")
    return files
