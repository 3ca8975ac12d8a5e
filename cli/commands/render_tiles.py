"""``splatline render`` of a picture that is larger than the engine's image: tile by tile."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from splatline.cli.options.drawing import Drawing, fail_mismatch, simulate_all
from splatline.cli.options.outputs import write_json
from splatline.cli.options.prepare import prepare_tiles
from splatline.cli.options.request import RenderRequest
from splatline.cli.report.progress import Stages
from splatline.cli.report.statistics import picture_statistics
from splatline.contract.errors import InputError

if TYPE_CHECKING:
    import numpy.typing as npt

    from splatline.cli.options.prepared import Picture
    from splatline.contract.config import EngineConfig
    from splatline.contract.raster import Raster
    from splatline.host.picture_tiles.frames import TileFrames
    from splatline.plots.png_rows import Band
    from splatline.sim.golden.multisample import Drawn

__all__ = ["TileOptions", "fits_engine", "refuse_with_tiles", "render_tiles"]


class TileOptions(NamedTuple):
    """The options of ``splatline render`` that count for tiles; see there."""

    config: EngineConfig
    samples: int
    engine: str
    stall: float
    seed: int
    background: tuple[float, float, float] | None
    output: Path | None
    depth: Path | None
    stats: Path | None


class DrawnRow(NamedTuple):
    """A row of tiles, drawn.

    Parameters
    ----------
    bands
        Its pixels, packed: of the picture and that of the depth, as far as they are written.
    drawn_pixels, cycles, mismatched_pixels
        Sums over the tiles.
    """

    bands: list[Band]
    drawn_pixels: int
    cycles: int
    mismatched_pixels: int


@dataclass
class _Totals:
    """Sums over the tiles."""

    drawn_pixels: int = 0
    cycles: int = 0
    mismatched_pixels: int = 0


def fits_engine(request: RenderRequest) -> bool:
    """Return whether an engine draws a request's picture in one frame."""
    width, height = request.size
    return width <= request.preset.max_width and height <= request.preset.max_height


def refuse_with_tiles(
    request: RenderRequest, engine: str, engines: int | None, reference: bool
) -> None:
    """Raise ``InputError`` if the picture is too large, or an option does not go with tiles."""
    most = f"{request.preset.max_width}x{request.preset.max_height}"
    refused = {
        "--reference and --out-dir": reference,
        "--engines": engines is not None,
        "--engine axi": engine == "axi",
        "--shapes rom": request.shapes != "table",
    }
    for name, given in refused.items():
        if given:
            raise InputError(
                f"{name} cannot draw in tiles: the picture must fit preset"
                f" {request.preset.name}, with at most {most} pixels"
            )
    from splatline.host.picture_tiles.grid import Grid

    Grid.of(*request.size, request.preset, None)


def render_tiles(
    context: click.Context, request: RenderRequest, options: TileOptions, stages: Stages
) -> None:
    """Draw a picture in tiles and write it row by row of tiles.

    Raises
    ------
    InputError
        See :func:`splatline.host.picture_tiles.frames.tile_picture`.
    """
    with contextlib.ExitStack() as stack:
        prepared = prepare_tiles(request, stages, options.samples, stack)
        picture = prepared.picture
        grid, totals = picture.grid, _Totals()
        tiles = grid.rows * grid.columns
        with stages.stage("tiles", f"Drawing {tiles:,} tiles") as share:
            _draw_and_write(picture, options, totals, share)
    stages.seconds.update(picture.counts.pop("seconds"))
    files = [str(path) for path in (options.output, options.depth) if path is not None]
    size = f"{grid.frame_width} x {grid.frame_height}"
    empty = picture.counts["tiles_empty"]
    note = f"drawn in {tiles:,} tiles of up to {size} pixels, of which {empty:,} are empty"
    numbers = {
        "cloud": " ".join(map(str, request.paths)) or f"scene {request.scene}",
        "view": prepared.camera,
        "splat_size": request.splat_size or "auto",
        "dropped": prepared.dropped,
        "far_away": prepared.far_away,
        "colour": prepared.colour_key or None,
        "notes": [*prepared.notes, note],
        **prepared.facts(),
        **picture_statistics(
            request.preset.name,
            (grid.width, grid.height),
            {**picture.counts, "samples": options.samples},
            drawn_pixels=totals.drawn_pixels,
            cycles=None if options.engine == "golden" else totals.cycles,
            mismatched_pixels=None if options.engine == "golden" else totals.mismatched_pixels,
            engine=options.engine,
            seconds=stages.seconds,
            stall=options.stall,
            seed=options.seed,
        ),
    }
    if options.stats is not None:
        write_json(options.stats, numbers)
        files.append(str(options.stats))

    from splatline.cli.report.tables import print_statistics

    print_statistics(numbers, title=request.name, files=files)
    if totals.mismatched_pixels:
        fail_mismatch(context, totals.mismatched_pixels)


def _draw_and_write(
    picture: Picture, options: TileOptions, totals: _Totals, share: Callable[[float], None]
) -> None:
    """Draw the rows of tiles and write them as they are done, from the top down."""
    from splatline.plots.png_rows import png_rows

    grid = picture.grid
    with contextlib.ExitStack() as stack:
        writers = [
            stack.enter_context(png_rows(path, grid.width, grid.height, grey=grey))
            for path, grey in ((options.output, False), (options.depth, True))
            if path is not None
        ]
        for number, row in enumerate(_drawn_rows(picture, options), 1):
            totals.drawn_pixels += row.drawn_pixels
            totals.cycles += row.cycles
            totals.mismatched_pixels += row.mismatched_pixels
            for writer, band in zip(writers, row.bands, strict=True):
                writer.write(band)
            share(number / grid.rows)


def _drawn_rows(picture: Picture, options: TileOptions) -> Iterator[DrawnRow]:
    """Yield the rows of tiles. The Verilog is simulated here, whoever made the frames."""
    draw = functools.partial(draw_row, options=options)
    if options.engine == "golden":
        return picture.map_rows(draw)
    return map(draw, picture.map_rows(list))


def draw_row(row: list[TileFrames], options: TileOptions) -> DrawnRow:
    """Draw a row of tiles and pack its pixels, here or on the worker of a cluster."""
    import numpy as np

    from splatline.plots.figure import BACKGROUND, depth_levels, rgb_levels
    from splatline.plots.png_rows import pack_band

    background = options.background or BACKGROUND
    levels: list[Callable[[Drawn], npt.NDArray[Any]]] = []
    if options.output is not None:
        levels.append(lambda drawn: rgb_levels(drawn.to_rgb(background)))
    if options.depth is not None:
        levels.append(depth_levels)
    tiles: list[list[npt.NDArray[Any]]] = [[] for _ in levels]
    drawn = cycles = mismatched = 0
    for drawing in _drawings(row, options):
        drawn += int(drawing.raster.drawn.sum())
        cycles += drawing.cycles or 0
        mismatched += drawing.mismatched_pixels or 0
        for found, level in zip(tiles, levels, strict=True):
            found.append(level(drawing.raster))
    bands = [pack_band(np.concatenate(found, axis=1)) for found in tiles]
    return DrawnRow(bands, drawn, cycles, mismatched)


def _drawings(row: list[TileFrames], options: TileOptions) -> Iterator[Drawing]:
    """Yield the drawing of each tile of a row, of its own pixels alone."""
    from splatline.sim import golden
    from splatline.sim.golden.multisample import average

    def picture_of(tile: TileFrames, rasters: Iterable[Raster | None]) -> Drawn:
        return average([_own_part(raster, tile, options.config) for raster in rasters])

    simulated = options.engine != "golden"
    frames = [frame for tile in row for frame in tile.frames if frame is not None]
    runs = iter(simulate_all(frames, options.stall, options.seed) if simulated else ())
    for tile in row:
        drawn = picture_of(tile, (frame and golden.render(frame) for frame in tile.frames))
        if simulated:
            own = [frame and next(runs) for frame in tile.frames]
            cycles = sum(run.cycles for run in own if run is not None)
            yield Drawing(drawn, picture_of(tile, (run and run.raster for run in own)), cycles)
        else:
            yield Drawing(drawn)


def _own_part(raster: Raster | None, tile: TileFrames, config: EngineConfig) -> Raster:
    """Return a tile's own part of its frame's raster; None is background."""
    from splatline.contract.raster import Raster

    if raster is None:
        raster = Raster.background(*tile.tile.size, config)
    return raster.part(*tile.tile.own)
