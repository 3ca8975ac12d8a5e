"""Time from the command to the picture: fresh processes that read a file and draw it."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from splatline.cli.bench.sizes import MEDIUM
from splatline.contract.tool_error import ToolFailure

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.host.cloud.cloud import Cloud

__all__ = ["NOISE", "PEERS", "Kind", "first_pictures", "kinds", "write_ply"]

NOISE = 0.7
"""Standard deviation of the noise along the normal, in median radii of the discs."""

REPEATS = 3
"""Runs after one that loads what is on disk into memory; the fastest counts."""

OURS = "import sys; from splatline.cli.main import main; sys.exit(main(prog_name='splatline'))"

PYVISTA = """
import sys, pyvista
file, picture, width, height = sys.argv[1:]
plotter = pyvista.Plotter(off_screen=True, window_size=[int(width), int(height)])
cloud = pyvista.read(file)
rgb = "RGB" in cloud.point_data
plotter.add_points(cloud, scalars="RGB" if rgb else None, rgb=rgb, point_size=2)
plotter.screenshot(picture)
"""

OPEN3D = """
import sys, open3d
file, picture, width, height = sys.argv[1:]
cloud = open3d.io.read_point_cloud(file)
rendering = open3d.visualization.rendering
renderer = rendering.OffscreenRenderer(int(width), int(height))
material = rendering.MaterialRecord()
material.shader = "defaultLit" if cloud.has_normals() else "defaultUnlit"
material.point_size = 2
renderer.scene.add_geometry("cloud", cloud, material)
bounds = cloud.get_axis_aligned_bounding_box()
middle, extent = bounds.get_center(), bounds.get_max_extent()
renderer.setup_camera(35.0, middle, middle + [0.0, 0.0, 2.0 * extent], [0.0, 1.0, 0.0])
open3d.io.write_image(picture, renderer.render_to_image())
"""

PEERS = {"VTK points (PyVista)": ("pyvista", PYVISTA), "Open3D off-screen": ("open3d", OPEN3D)}
"""Package and program of each peer: reads a file and writes a picture of it."""


class Kind(NamedTuple):
    """A cloud whose first picture is timed: its points, and whether it has noise or normals."""

    points: int
    noisy: bool = False

    @property
    def name(self) -> str:
        """Its name in tables."""
        return f"{self.points:,} points, " + ("noisy, no normals" if self.noisy else "normals")


def kinds(points: int) -> tuple[Kind, ...]:
    """Return the clouds that are timed, the largest of them with ``points`` points."""
    return Kind(points), Kind(max(1, points // 4), noisy=True), Kind(min(MEDIUM, points))


def first_pictures(
    cloud: Cloud,
    radii: npt.NDArray[np.float64],
    clouds: Sequence[Kind],
    options: Sequence[str],
    size: tuple[int, int],
    peers: bool,
    announce: Callable[[str], None],
) -> list[dict[str, Any]]:
    """Return the times of ``splatline render`` for each kind of cloud, and those of the peers.

    Parameters
    ----------
    cloud, radii
        The cloud that is resampled.
    clouds
        Kinds of clouds.
    options
        Of ``splatline render``, in addition to the size.
    size
        Width and height of the picture.
    peers
        Whether other renderers are timed too.
    announce
        Called with a description before each renderer.

    Returns
    -------
    list of dict
        ``cloud``, ``points``, ``bytes`` of the file, ``wall`` (seconds of the process), ``seconds``
        of each stage by name, ``start`` (the rest), and ``peers``: ``wall`` or ``why`` by name.

    Raises
    ------
    ToolFailure
        If ``splatline render`` fails.
    """
    found = []
    with tempfile.TemporaryDirectory(prefix="splatline-") as name:
        folder = Path(name)
        file, picture, stats = (folder / file for file in ("a.ply", "a.png", "a.json"))
        for kind in clouds:
            announce(f"{kind.name}, to the first picture")
            _write_cloud(file, cloud, radii, kind)
            shape = "x".join(map(str, size))
            command = ["render", file, "-o", picture, "--stats", stats, "--size", shape, *options]
            wall, seconds = _fastest(
                [OURS, *command], lambda: json.loads(stats.read_text())["seconds"]
            )
            run: dict[str, Any] = {"cloud": kind.name, "points": kind.points}
            run |= {"bytes": file.stat().st_size, "wall": wall, "seconds": seconds}
            run["start"] = max(0.0, wall - sum(seconds.values()))
            run["peers"] = {}
            for peer, (package, program) in PEERS.items() if peers else ():
                announce(f"{kind.name}, {peer} to the first picture")
                run["peers"][peer] = _peer(package, [program, file, picture, *map(str, size)])
            found.append(run)
    return found


def _write_cloud(path: Path, cloud: Cloud, radii: npt.NDArray[np.float64], kind: Kind) -> None:
    """Write a cloud resampled as a kind tells."""
    import numpy as np

    from splatline.host.cloud.resample import resample

    sampled, smaller = resample(cloud, radii, kind.points)
    positions = sampled.positions
    if kind.noisy:
        size = NOISE * float(np.median(smaller))
        noise = np.random.default_rng(2).normal(scale=size, size=(kind.points, 1))
        positions = positions + noise * sampled.normals
    write_ply(path, positions, None if kind.noisy else sampled.normals, sampled.colours)


def write_ply(
    path: Path,
    positions: npt.NDArray[np.float64],
    normals: npt.NDArray[np.float32] | None,
    colours: npt.NDArray[np.uint8],
) -> None:
    """Write a binary PLY file, as scanners' programs do: float32, colours in bytes."""
    import numpy as np

    parts: list[tuple[str, str, tuple[str, ...], npt.NDArray[Any]]]
    parts = [("float", "<f4", ("x", "y", "z"), positions)]
    if normals is not None:
        parts.append(("float", "<f4", ("nx", "ny", "nz"), normals))
    parts.append(("uchar", "u1", ("red", "green", "blue"), colours))
    rows = np.empty(len(positions), [(names[0], kind, (3,)) for _, kind, names, _ in parts])
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}"]
    for kind, _, names, values in parts:
        rows[names[0]] = values
        header += [f"property {kind} {name}" for name in names]
    with path.open("wb") as stream:
        stream.write(("\n".join([*header, "end_header"]) + "\n").encode())
        rows.tofile(stream)


def _peer(package: str, arguments: list[Any]) -> dict[str, Any]:
    """Return the wall time of a peer's program, or the reason of its failure."""
    if importlib.util.find_spec(package) is None:
        return {"wall": None, "why": f"{package} is not installed: pip install '.[peers]'"}
    try:
        return {"wall": _fastest(arguments, dict)[0]}
    except ToolFailure as error:
        return {"wall": None, "why": str(error.message)}


def _fastest(arguments: Sequence[Any], result: Callable[[], Any]) -> tuple[float, Any]:
    """Return the least wall time of a Python program, and the result of that run.

    Raises
    ------
    ToolFailure
        If it fails.
    """
    command = [sys.executable, "-c", *map(str, arguments)]
    environment = {"EGL_PLATFORM": "surfaceless", **os.environ}
    best, found = float("inf"), None
    for number in range(1 + REPEATS):
        begin = time.perf_counter()
        run = subprocess.run(
            command, capture_output=True, text=True, errors="replace", check=False, env=environment
        )
        wall = time.perf_counter() - begin
        if run.returncode:
            # The last line of a traceback is the error.
            said = run.stderr.strip().rpartition("\n")[2]
            raise ToolFailure(said or f"exit code {run.returncode}")
        if number and wall < best:
            best, found = wall, result()
    return best, found
