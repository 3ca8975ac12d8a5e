"""A compiler wrapper that compiles Verilator's run-time library once instead of once a design.

Verilator's ``make`` calls it through ``OBJCACHE``:
``python object_cache.py FOLDER c++ FLAGS -c -o OBJECT SOURCE``. The run-time library is the same in
every design and takes four fifths of the time to build a small one. Its files lie beside
``verilated.mk``. Their objects are kept in FOLDER under a digest of the command, the compiler and
the source; every other command is passed on to the compiler. The program runs without Python's site
packages and imports none.

Without optimisation (``-O0``) the library's headers take half of the time of a small design's own
files. They are compiled once for all designs as well. The result takes 70 MB.
"""

import hashlib
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

__all__ = ["main"]

HEADERS = '#include "verilated.h"\n#include "verilated_vpi.h"\n#include "verilated_dpi.h"\n'
"""Headers of the run-time library that a design includes."""

SIZE = hashlib.sha256().digest_size
"""Bytes of the digest before a kept object: one that is damaged is compiled anew."""


def main(folder: Path, command: list[str]) -> int:
    """Run a compiler command, or copy the object of the same command; return the exit code."""
    source = Path(command[-1])
    if "-o" not in command:
        return subprocess.call(command)
    index = command.index("-o")
    target = Path(command[index + 1])
    flags = [*command[1:index], *command[index + 2 : -1]]
    if not source.with_name("verilated.mk").exists():
        headers = _headers(folder, command[0], flags) if "-O0" in flags else []
        return subprocess.call([command[0], *headers, *command[1:]])
    kept = folder / f"{_digest(command[0], flags, source.name, source.read_text())}.kept"
    data = kept.read_bytes() if kept.exists() else b""
    if data[:SIZE] == hashlib.sha256(data[SIZE:]).digest():
        target.write_bytes(data[SIZE:])
        return 0
    status = subprocess.call(command)
    if status == 0:
        data = target.read_bytes()
        _keep(kept, hashlib.sha256(data).digest() + data)
    return status


def _keep(path: Path, data: bytes) -> None:
    """Write a file to a temporary name and rename it, as another process may read it any time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as scratch:
        scratch.write(data)
    Path(scratch.name).replace(path)


def _headers(folder: Path, compiler: str, flags: list[str]) -> list[str]:
    """Return flags that include the library's headers, compiled; none if they do not compile."""
    flags = [flag for flag in flags if flag not in ("-c", "-MMD")]
    header = folder / f"{_digest(compiler, sorted(flags), HEADERS)}.h"
    compiled = Path(f"{header}.gch")
    if not compiled.exists():
        _keep(header, HEADERS.encode())
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            own = Path(scratch) / compiled.name
            if subprocess.call([compiler, *flags, "-x", "c++-header", "-o", str(own), str(header)]):
                return []
            own.replace(compiled)
    return ["-include", str(header)]


def _digest(compiler: str, *inputs: object) -> str:
    """Return a digest of a compiler and of what it is given."""
    status = Path(shutil.which(compiler) or sys.executable).stat()
    key = repr((compiler, status.st_size, status.st_mtime_ns, *inputs))
    return hashlib.sha256(key.encode()).hexdigest()


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
