"""The commands that write, and what they read."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

__all__ = ["COMMANDS", "Command", "write_inputs"]


@dataclass(frozen=True)
class Command:
    """A command that writes files.

    Parameters
    ----------
    name
        For people.
    arguments
        Of ``splatline``.
    files
        What it writes; those in folders that it makes have the folder's name first.
    """

    name: str
    arguments: tuple[str, ...]
    files: tuple[str, ...]


def _command(name: str, line: str, *files: str) -> Command:
    return Command(name, tuple(line.split()), files)


COMMANDS = (
    _command(
        "render", "render a.csv --size 48x32 -o a.png --depth d.png --stats s.json",
        "a.png", "d.png", "s.json",
    ),
    _command(
        "render --out-dir", "render a.csv --size 32x24 --out-dir out",
        "out/engine.png", "out/golden.png", "out/reference.png", "out/figure.png",
        "out/stats.json",
    ),
    _command("render in tiles", "render a.csv --size 900x40 -o a.png", "a.png"),
    _command("render in parts", "render a.las --memory 400M --size 48x32 -o a.png", "a.png"),
    _command("encode", "encode a.csv --size 48x32 -o a.frame", "a.frame", "a.frame.json"),
    _command("play", "play in.frame -o a.png --stats s.json", "a.png", "s.json"),
    _command("film gif", "film a.csv --size 32x24 --seconds 0.2 -o a.gif", "a.gif"),
    _command("film webp", "film a.csv --size 32x24 --seconds 0.2 -o a.webp", "a.webp"),
    _command("film mp4", "film a.csv --size 32x24 --seconds 0.2 -o a.mp4", "a.mp4"),
    _command(
        "registers", "registers --c-header a.h --json a.json --markdown a.md --c-driver out",
        "a.h", "a.json", "a.md", "out/splatline.h", "out/splatline_driver.h",
        "out/splatline_driver.c",
    ),
)  # fmt: skip


def write_inputs(folder: Path) -> None:
    """Write the files that the commands read, but a frame; those are ``a.csv`` and ``a.las``."""
    rng = np.random.default_rng(7)
    normals = rng.normal(size=(300, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rows = np.hstack([normals, normals, np.round(127.5 * (normals + 1.0))])
    np.savetxt(
        folder / "a.csv", rows, "%.6f", ",", header="x,y,z,nx,ny,nz,red,green,blue", comments=""
    )
    from tests.host.files.las_files import las

    (folder / "a.las").write_bytes(las(7))
