"""Clouds larger than the memory: their options, and their frames."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from splatline.cli.report.progress import Stages
from splatline.contract.errors import InputError

from .camera import see
from .parameters import MEMORY
from .prepared import PreparedFrames, PreparedTiles
from .request import RenderRequest

if TYPE_CHECKING:
    from splatline.host.large.cluster import Traffic
    from splatline.host.large.cluster_tiles import ClusterTiles
    from splatline.host.large.draw_parts import Drawing, PartFrames
    from splatline.host.large.plan import Plan

__all__ = ["LARGE_OPTIONS", "is_large", "prepare_large", "prepare_large_tiles"]

SHARE = 4
"""The memory that is used by default is the machine's over this."""

LARGE_OPTIONS = (
    click.option(
        "--dask",
        metavar="ADDRESS|local",
        help="Draw on the workers of a Dask cluster, or on processes of this machine; needs the"
        " extra dask. The picture is the same.",
    ),
    click.option(
        "--memory",
        type=MEMORY,
        metavar="SIZE",
        show_default="a quarter of the machine's",
        help="Memory for the cloud, such as 2G. A LAS, LAZ or binary PLY file that needs more is"
        " read in parts: points of a pixel become one, or of more pixels if the memory asks for"
        " it. View, depths and colours are then those of a sample, and discs those of the points"
        " that are left.",
    ),
)
"""Options for large clouds, last one first."""


def is_large(request: RenderRequest) -> bool:
    """Return whether a request's cloud is drawn in parts."""
    if request.path is None:
        return False
    if len(request.paths) > 1 or request.dask is not None:
        return True
    suffix = request.path.suffix.lower()
    if suffix not in (".las", ".laz", ".ply") or request.format is not None:
        return False
    if request.sample is not None or not request.path.is_file():
        return False  # a pipe is read once
    from splatline.host.files.las_header import read_las_header
    from splatline.host.files.ply_rows import ply_rows
    from splatline.host.files.readers import open_cloud_file, parser_errors
    from splatline.host.large.memory import FIXED_BYTES, POINT_BYTES

    with open_cloud_file(request.path) as source, parser_errors(source):
        if suffix == ".ply":
            rows = ply_rows(source)
            count = 0 if rows is None else rows.points
        else:
            count = read_las_header(source).count
    return FIXED_BYTES + POINT_BYTES * count > _memory(request)


def prepare_large(
    request: RenderRequest, camera: dict[str, Any], stages: Stages, samples: int
) -> PreparedFrames:
    """Return the frames of a request's cloud, drawn part by part; see ``prepare``.

    Raises
    ------
    InputError
        If a file cannot be read, an option does not go with a large cloud, or nothing is in view.
    """
    from splatline.host.large.draw_parts import frames_of

    plan, drawing = _planned(request, camera, stages, samples)
    joined, facts = _draw(plan, drawing, request, stages)
    return PreparedFrames(
        frames=frames_of(plan, drawing, joined),
        view=plan.view,
        camera=camera,
        facts=facts,
        **_told(plan, joined),
    )


def prepare_large_tiles(
    request: RenderRequest,
    camera: dict[str, Any],
    stages: Stages,
    samples: int,
    stack: ExitStack,
) -> PreparedTiles:
    """Return the tiles of a request's cloud, drawn part by part; see ``prepare_tiles``."""
    from splatline.host.large.joined_tiles import tiles_of

    plan, drawing = _planned(request, camera, stages, samples)
    facts: dict[str, Any] = {"parts": len(plan.parts)}
    if request.dask is None:
        joined, _ = _draw(plan, drawing, request, stages)
        picture = tiles_of(plan, drawing, joined)
        return PreparedTiles(picture, camera, **_told(plan, joined), facts=lambda: facts)
    shared = _on_cluster(plan, drawing, request, stages, stack)
    return PreparedTiles(
        shared,
        camera,
        **_told(plan, shared.parts),
        facts=lambda: {**facts, **_travelled(shared.traffic)},
    )


def _on_cluster(
    plan: Plan, drawing: Drawing, request: RenderRequest, stages: Stages, stack: ExitStack
) -> ClusterTiles:
    """Return the tiles of a cloud whose parts are drawn on a cluster, which ``stack`` closes."""
    from splatline.host.large.cluster import open_cluster
    from splatline.host.large.cluster_tiles import draw_tiles_on_cluster

    assert request.dask is not None
    client = stack.enter_context(open_cluster(request.dask))
    with _telling(plan, request, stages) as tell:
        return draw_tiles_on_cluster(plan, drawing, client, progress=tell)


def _planned(
    request: RenderRequest, camera: dict[str, Any], stages: Stages, samples: int
) -> tuple[Plan, Drawing]:
    """Return the plan of a request's cloud, and how its parts are drawn."""
    from splatline.host.cloud.upward import upward_of
    from splatline.host.large.draw_parts import Drawing
    from splatline.host.large.plan import make_plan
    from splatline.host.shading.light_sets import LIGHTS

    _check(request)
    with stages.stage("survey", f"Looking at samples of {_named(request.paths)}"):
        plan = make_plan(
            request.paths,
            request.colour,
            functools.partial(see, camera=camera, size=request.size),
            1 << request.preset.material_bits,
            bulk=request.fit != "all",
            keep=request.keep,
        )
    drawing = Drawing(
        config=request.preset,
        quality=request.quality,
        skips=request.skips,
        samples=samples,
        lighting=LIGHTS[request.lights],
        splat_size=request.splat_size,
        close_specks=request.close_specks,
        memory=_memory(request),
        up=upward_of(camera["orbit"], camera["up"]),
    )
    return plan, drawing


def _told(plan: Plan, joined: PartFrames) -> dict[str, Any]:
    """Return what is told of a cloud in parts; see ``PreparedFrames`` and ``PreparedTiles``."""
    return {
        "dropped": joined.dropped,
        "colour_key": plan.colourings[0].key,
        "notes": _notes(plan, joined),
    }


def _notes(plan: Plan, joined: PartFrames) -> list[str]:
    """Return what a person should know about a cloud that is drawn in parts."""
    parts = f", in {len(plan.parts)} parts" if len(plan.parts) > 1 else ""
    return [
        *joined.notes,
        f"points of one pixel and depth are drawn as one{parts}; the view fits a sample",
    ]


def _draw(
    plan: Plan, drawing: Drawing, request: RenderRequest, stages: Stages
) -> tuple[PartFrames, dict[str, Any]]:
    """Draw a plan's parts here or on a cluster; return statistics, too."""
    facts: dict[str, Any] = {"parts": len(plan.parts)}
    if request.dask is None:
        from splatline.host.large.draw_parts import draw_parts

        with _telling(plan, request, stages) as tell:
            return draw_parts(plan, drawing, progress=tell), facts
    from splatline.host.large.cluster import draw_on_cluster, open_cluster

    with open_cluster(request.dask) as client, _telling(plan, request, stages) as tell:
        joined, traffic = draw_on_cluster(plan, drawing, client, progress=tell)
    return joined, {**facts, **_travelled(traffic)}


def _telling(
    plan: Plan, request: RenderRequest, stages: Stages
) -> AbstractContextManager[Callable[[str, float], None]]:
    """Return the stage in which parts are drawn."""
    where = "" if request.dask is None else f" on {request.dask}"
    return stages.stages({"parts": f"Drawing {plan.count:,} points{where}"})


def _travelled(traffic: Traffic) -> dict[str, int]:
    """Return the statistics of a cluster's tasks."""
    return {"dask_tasks": traffic.tasks, "dask_bytes": traffic.bytes}


def _check(request: RenderRequest) -> None:
    """Raise ``InputError`` if an option does not go with parts of a cloud."""
    for name in ("format", "sample"):
        if getattr(request, name) is not None:
            raise InputError(f"--{name} goes with one cloud that fits the memory")
    if request.shapes != "table":
        raise InputError("--shapes rom goes with one cloud that fits the memory")
    if any(str(path) == "-" for path in request.paths):
        raise InputError("the standard input can be one cloud alone, and no large one")


def _named(paths: tuple[Path, ...]) -> str:
    """Return how files are called in a message."""
    return str(paths[0]) if len(paths) == 1 else f"{len(paths)} files"


def _memory(request: RenderRequest) -> int:
    """Return the bytes that a request's cloud may take."""
    machine = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return request.memory if request.memory is not None else machine // SHARE
