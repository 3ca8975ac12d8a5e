"""Compiles Verilator's own run-time library once, not once a design: stands before the compiler.

``python object_cache.py FOLDER c++ FLAGS -c -o OBJECT SOURCE``, as ``make`` calls it through
``OBJCACHE``. Four fifths of the time to build a small design go into files that are the same in
every design. Those, which lie beside ``verilated.mk``, are kept in FOLDER under a digest of the
command, the compiler and the text; anything else is handed to the compiler as it is. Runs without
Python's site packages, and so imports none.
"""

import hashlib
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

__all__ = ["main"]


def main(folder: Path, command: list[str]) -> int:
    """Run a compiler's command, or copy what the same one made before; return its exit code."""
    source = Path(command[-1])
    if "-o" not in command or not source.with_name("verilated.mk").exists():
        return subprocess.call(command)
    place = command.index("-o") + 1
    target = Path(command[place])
    compiler = Path(shutil.which(command[0]) or sys.executable).stat()
    flags = [*command[:place], *command[place + 1 :]]
    key = repr((flags, compiler.st_size, compiler.st_mtime_ns)).encode()
    kept = folder / (hashlib.sha256(key + source.read_bytes()).hexdigest() + ".o")
    if kept.exists():
        shutil.copyfile(kept, target)
        return 0
    status = subprocess.call(command)
    if status == 0:
        folder.mkdir(parents=True, exist_ok=True)
        # Under a name of its own first: another process may look for it at any time.
        with tempfile.NamedTemporaryFile(dir=folder, delete=False) as scratch:
            scratch.write(target.read_bytes())
        Path(scratch.name).replace(kept)
    return status


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
