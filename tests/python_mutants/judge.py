"""Runs tests on mutants, each in a copy of the rooms."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from queue import SimpleQueue

from tests.python_mutants.choose import Mutant, mutate
from tests.python_mutants.groups import ROOT, Group

__all__ = ["Verdict", "judge"]

ROOMS = ("boards", "cli", "constraints", "contract", "flow", "host", "plots", "rtl", "sim", "view")

PATIENCE = 6.0
"""Times the unchanged tests' seconds, and a minute for the compiler: longer is a hang."""

Verdict = str
"""``noticed``, ``hung`` or ``survived``."""


def judge(
    group: Group, mutants: list[Mutant], processes: int
) -> Iterator[tuple[Mutant, Verdict, str]]:
    """Yield each mutant with its verdict and the test that noticed it, as they are done.

    Raises
    ------
    RuntimeError
        If the tests fail without a mutant.
    """
    with ExitStack() as stack:
        folders = [
            Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="splatline-")))
            for _ in range(processes)
        ]
        pool = stack.enter_context(ThreadPoolExecutor(processes))

        def start(copy: Path) -> float:
            _fill(copy)
            begin = time.monotonic()
            verdict, told = _run(copy, group, copy / "cache", None)
            if verdict != "survived":
                raise RuntimeError(f"{group.name}: the tests fail without a mutant: {told}")
            return time.monotonic() - begin

        limit = PATIENCE * max(pool.map(start, folders)) + 60.0
        copies: SimpleQueue[Path] = SimpleQueue()
        for copy in folders:
            copies.put(copy)

        def one(mutant: Mutant) -> tuple[Mutant, Verdict, str]:
            copy = copies.get()
            file = copy / mutant.file
            original = file.read_text()
            try:
                file.write_text(mutate(original, mutant))
                with tempfile.TemporaryDirectory(dir=copy, prefix="cache-") as cache:
                    shutil.copytree(copy / "cache", cache, dirs_exist_ok=True)
                    return mutant, *_run(copy, group, Path(cache), limit)
            finally:
                file.write_text(original)
                copies.put(copy)

        yield from pool.map(one, mutants)


def _fill(copy: Path) -> None:
    """Copy the rooms and the tests; ``splatline`` is a package of the copy."""
    ignore = shutil.ignore_patterns("__pycache__")
    for room in (*ROOMS, "tests"):
        shutil.copytree(ROOT / room, copy / room, ignore=ignore)
    shutil.copytree(ROOT / "api", copy / "package" / "splatline", ignore=ignore)
    for room in ROOMS:
        (copy / "package" / "splatline" / room).symlink_to(copy / room)
    for file in ("pyproject.toml", "README.md", "Makefile"):
        shutil.copy(ROOT / file, copy / file)


def _run(copy: Path, group: Group, cache: Path, limit: float | None) -> tuple[Verdict, str]:
    """Run a group's tests in a copy until one fails; return the verdict and the test.

    ``cache`` is the folder of compiled functions. Those that have the mutant in them are compiled
    anew.
    """
    cache.mkdir(exist_ok=True)
    environment = {
        **os.environ,
        "PYTHONPATH": f"{copy / 'package'}{os.pathsep}{copy}",
        "PYTHONDONTWRITEBYTECODE": "1",
        "NUMBA_CACHE_DIR": str(cache),
    }
    call = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "--tb=no"]
    try:
        done = subprocess.run(
            [*call, *group.tests],
            cwd=copy,
            env=environment,
            capture_output=True,
            text=True,
            timeout=limit,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "hung", ""
    if done.returncode == 0:
        return "survived", ""
    failed = re.search(r"(?m)^(?:FAILED|ERROR) (\S+)", done.stdout)
    return "noticed", failed[1] if failed else done.stdout[-200:]
