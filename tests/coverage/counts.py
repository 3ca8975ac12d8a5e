"""Verilator's counts of a run, folded to one bit for each point of a module.

A *point* is a block of lines, a branch, or a bit that goes from 0 to 1 or from 1 to 0. Its key has
the line in its module, the column, the kind and Verilator's comment, such as ``data[3]:0->1``.
"""

import re
import uuid
from collections import defaultdict
from pathlib import Path

import numpy as np

from tests.coverage.modules import find_modules

__all__ = ["KINDS", "fold", "reached", "read_keys"]

KINDS = ("line", "branch", "toggle")

_POINT = re.compile(
    rb"\x01f\x02([^\x01]*)\x01l\x02(\d+)\x01n\x02(\d+)\x01t\x02(\w+)"
    rb"\x01page\x02v_\w+/(\w+)\x01o\x02([^\x01']*)[^']*' (\d+)\n"
)


def fold(counts: Path, sources: Path) -> None:
    """Put the counts of a run into the folder that they are in, and remove their file.

    For each module there is a file ``DIGEST.keys`` with a key a line, and for each run and module a
    file ``DIGEST-RUN.bits`` with a bit for each key: 1 if the point was reached.

    Parameters
    ----------
    counts
        Verilator's file.
    sources
        Folder with the Verilog of the build.
    """
    files = {}
    found = defaultdict(lambda: defaultdict(int))
    for file, line, column, kind, page, comment, count in _POINT.findall(counts.read_bytes()):
        name = Path(file.decode()).name
        if name not in files:
            modules = find_modules((sources / name).read_text())
            files[name] = {module.name: module for module in modules}
        module = files[name].get(page.decode())
        if module is not None:
            key = b"%d %s %s %s" % (int(line) - module.first, column, kind, comment)
            found[module.digest][key] |= int(count) > 0
    run = uuid.uuid4().hex
    for digest, points in found.items():
        keys = sorted(points)
        listed = counts.with_name(f"{digest}.keys")
        if not listed.exists():
            listed.write_bytes(b"\n".join(keys))
        bits = np.packbits(np.fromiter((points[key] for key in keys), bool, len(keys)))
        bits.tofile(counts.with_name(f"{digest}-{run}.bits"))
    counts.unlink()


def read_keys(folder: Path, digest: str) -> list[str]:
    """Return the keys of a module's points; none if no run has that module."""
    listed = folder / f"{digest}.keys"
    return listed.read_text().split("\n") if listed.exists() else []


def reached(folder: Path, digest: str) -> np.ndarray:
    """Return which points any run has reached: shape (keys,), bool."""
    total = len(read_keys(folder, digest))
    together = np.zeros((total + 7) // 8, np.uint8)
    for file in folder.glob(f"{digest}-*.bits"):
        together |= np.fromfile(file, np.uint8)
    return np.unpackbits(together, count=total).astype(bool)
