"""A compiler wrapper that compiles Verilator's run-time library once instead of once a design.

Verilator's ``make`` calls it through ``OBJCACHE``:
``python object_cache.py FOLDER c++ FLAGS -c -o OBJECT SOURCE``. The run-time library is the same in
every design and takes four fifths of the time to build a small one. Its files lie beside
``verilated.mk``. Their objects are kept in FOLDER under a digest of the command, the compiler and
the source; every other command is passed on to the compiler. The program runs without Python's site
packages and imports none.
"""

import hashlib
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

__all__ = ["main"]


def main(folder: Path, command: list[str]) -> int:
    """Run a compiler command, or copy the object of the same command; return the exit code."""
    source = Path(command[-1])
    if "-o" not in command or not source.with_name("verilated.mk").exists():
        return subprocess.call(command)
    index = command.index("-o") + 1
    target = Path(command[index])
    compiler = Path(shutil.which(command[0]) or sys.executable).stat()
    flags = [*command[:index], *command[index + 1 :]]
    key = repr((flags, compiler.st_size, compiler.st_mtime_ns)).encode()
    kept = folder / (hashlib.sha256(key + source.read_bytes()).hexdigest() + ".o")
    if kept.exists():
        shutil.copyfile(kept, target)
        return 0
    status = subprocess.call(command)
    if status == 0:
        folder.mkdir(parents=True, exist_ok=True)
        # Written to a temporary name and renamed, as another process may read it at any time.
        with tempfile.NamedTemporaryFile(dir=folder, delete=False) as scratch:
            scratch.write(target.read_bytes())
        Path(scratch.name).replace(kept)
    return status


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
