"""Damaged files of compiled functions, and processes that write them at once."""

import importlib.util
import os
import random
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

__all__ = ["damaged_functions", "shared_functions"]

SOURCE = """
from splatline.host.compiled_cache import cached_njit
@cached_njit()
def add(a, b):
    return 3 * a + b
"""

SHARED = """
import sys
sys.path.insert(0, sys.argv[1])
from function_of_trial import add
kinds = {"int": int, "float": float, "complex": complex}
for kind in sys.argv[2:]:
    one = kinds[kind]
    assert add(one(2), one(1)) == 7 and type(add(one(2), one(1))) is one, kind
"""
"""A process that calls the function with some types, in its own order."""

KINDS = ["int", "float", "complex"]


def damaged_functions(numbers: range, folder: Path) -> Iterator[tuple[str, str]]:
    """Call a compiled function whose file is damaged in a process of its own."""
    file = folder / "function_of_trial.py"
    file.write_text(SOURCE)
    assert _call(file) == 0
    (kept,) = (folder / "__pycache__").glob("*.nbc")
    whole = kept.read_bytes()
    for number in numbers:
        rng = random.Random(f"function {number}")
        data, at = bytearray(whole), rng.randrange(len(whole))
        damage = rng.choice(("cut", "bit", "bytes"))
        if damage == "cut":
            del data[at:]
        elif damage == "bit":
            data[at] ^= 1 << rng.randrange(8)
        else:
            data[at : at + 64] = rng.randbytes(len(data[at : at + 64]))
        kept.write_bytes(data)
        code = _call(file)
        yield ("done", "") if code == 0 else ("failed", f"function {number}: ends with {code}")


def _call(file: Path) -> int:
    """Import a module and call its function in a fork; return the exit code."""
    process = os.fork()
    if not process:
        code = 1
        try:
            spec = importlib.util.spec_from_file_location(file.stem, file)
            module = importlib.util.module_from_spec(spec)
            sys.modules[file.stem] = module
            spec.loader.exec_module(module)
            code = int(module.add(2, 1) != 7)
        finally:
            os._exit(code)
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


def shared_functions(numbers: range, folder: Path) -> Iterator[tuple[str, str]]:
    """Have two processes compile three signatures of a function at once, then a third use all."""
    file = folder / "function_of_trial.py"
    file.write_text(SOURCE)
    for number in numbers:
        for kept in (folder / "__pycache__").glob("*.nbc"):
            kept.unlink()
        rng = random.Random(f"shared {number}")
        both = [
            subprocess.Popen(_command(folder, rng.sample(KINDS, 3)), stderr=subprocess.PIPE)
            for _ in range(2)
        ]
        wrong = [told for each in both if (told := each.communicate()[1])]
        third = subprocess.run(_command(folder, KINDS), stderr=subprocess.PIPE, check=False)
        wrong += [third.stderr] if third.stderr else []
        text = b"; ".join(wrong).decode()
        yield ("failed", f"shared {number}: {text}") if text else ("done", "")


def _command(folder: Path, kinds: list[str]) -> list[str]:
    return [sys.executable, "-c", SHARED, str(folder), *kinds]
