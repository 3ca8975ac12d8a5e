"""Measures clouds larger than the memory: fresh processes that read a file and draw it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from splatline.contract.tool_error import ToolFailure

__all__ = ["measure_large"]

OURS = "import sys; from splatline.cli.main import main; sys.exit(main(prog_name='splatline'))"

DECOMPRESS = """
import sys, laspy
with laspy.open(sys.argv[1], laz_backend=laspy.LazBackend.LazrsParallel) as reader:
    for _ in reader.chunk_iterator(1 << 20):
        pass
"""
"""laspy and lazrs alone: every field of every point, in pieces of a million."""

READ = """
import sys
from pathlib import Path
from splatline.host.large.pieces import PieceFile
for _ in PieceFile(Path(sys.argv[1]), None).pieces():
    pass
"""
"""The reader alone: coordinates and colours, checked."""


def measure_large(
    scan: Path,
    size: tuple[int, int],
    preset: str,
    memory: str,
    octree: Path | None,
    announce: Callable[[str], None],
) -> dict[str, Any]:
    """Return times and memory for a LAZ file.

    Parameters
    ----------
    scan
        The LAZ file.
    size
        Width and height of the picture.
    preset
        An engine that draws it.
    memory
        What ``--memory`` is given.
    octree
        The same points as COPC, or None.
    announce
        Called with a description before each run.

    Returns
    -------
    dict
        ``points``, ``bytes``, ``decompress``, ``read``, ``render``, ``copc`` (None without a file),
        ``dask`` and ``alone``: each with ``seconds``, ``user`` (seconds of the processor) and
        ``peak`` (bytes of memory); the pictures with ``stats`` too. ``same`` tells whether Dask's
        picture is the other's; None if the other is of a cloud that fits the memory.
    """
    wide = [f"--size={size[0]}x{size[1]}", f"--preset={preset}", f"--memory={memory}"]
    with tempfile.TemporaryDirectory() as folder:

        def draw(name: str, path: Path, *options: str) -> dict[str, Any]:
            announce(f"{name}: {path.name}")
            return _draw(path, Path(folder) / f"{name}.png", [*wide, *options])

        announce(f"decompress: {scan.name}")
        decompress = _run([sys.executable, "-c", DECOMPRESS, str(scan)])
        announce(f"read: {scan.name}")
        read = _run([sys.executable, "-c", READ, str(scan)])
        draw("warm", scan)  # what is compiled on first use, and what the disk holds
        render = draw("render", scan)
        copc = None if octree is None else draw("copc", octree)
        dask = draw("dask", scan, "--dask=local")
        same = _bytes(folder, "render") == _bytes(folder, "dask")
        in_parts = "parts" in render["stats"]
    return {
        "points": render["stats"]["points"],
        "bytes": scan.stat().st_size,
        "size": list(size),
        "preset": preset,
        "memory": memory,
        "decompress": decompress,
        "read": read,
        "render": render,
        "copc": copc,
        "dask": dask,
        "same": same if in_parts else None,
    }


def _bytes(folder: str, name: str) -> bytes:
    """Return a picture's bytes."""
    return (Path(folder) / f"{name}.png").read_bytes()


def _draw(path: Path, picture: Path, options: Sequence[str]) -> dict[str, Any]:
    """Return the figures of a command that draws a cloud."""
    numbers = picture.with_suffix(".json")
    command = [sys.executable, "-c", OURS, "render", str(path), "-o", str(picture)]
    found = _run([*command, f"--stats={numbers}", *options])
    return {**found, "stats": json.loads(numbers.read_text())}


def _run(command: Sequence[str]) -> dict[str, float]:
    """Return a process's seconds, those of the processor, and its largest memory in bytes."""
    start = time.perf_counter()
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            errors.seek(0)
            raise ToolFailure(errors.read().decode(errors="replace")[-2000:])
    return {
        "seconds": time.perf_counter() - start,
        "user": usage.ru_utime + usage.ru_stime,
        "peak": usage.ru_maxrss * 1024,
    }
