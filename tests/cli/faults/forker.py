"""Runs commands in forks of a process that has all loaded: a run takes some hundredths of a second.

numba works in one thread of its own, as those of OpenMP do not survive a fork.
"""

import contextlib
import ctypes
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import asdict, dataclass
from pathlib import Path

from splatline.cli.main import main
from splatline.view.film import ahead

from .commands import COMMANDS, write_inputs

__all__ = ["Forker", "Outcome", "Trial"]

ROOT = Path(__file__).parents[3]

EVENTS = {"open", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.chmod", "shutil.rmtree"}
"""What Python tells of before it is done, with a file's name first."""


@dataclass(frozen=True)
class Trial:
    """A command, and what goes wrong.

    Parameters
    ----------
    arguments
        Of ``splatline``.
    folder
        Where it runs; files that it makes must be in there.
    most_bytes
        Bytes of a file: the write that would exceed them fails, as on a full disk.
    dies
        The process is killed instead, in the middle of that write.
    kill_at
        Number of the operation on a file of the folder before which the process is killed.
    kill_after
        Seconds after which it is killed.
    memory
        Bytes that the process may grow by.
    read_only
        The folder may not be written to, not even by root.
    temporary
        Folder of temporary files; the system's if empty.
    """

    arguments: tuple[str, ...]
    folder: str
    most_bytes: int | None = None
    dies: bool = False
    kill_at: int | None = None
    kill_after: float | None = None
    memory: int | None = None
    read_only: bool = False
    temporary: str = ""


@dataclass(frozen=True)
class Outcome:
    """What came of a trial.

    Parameters
    ----------
    code
        Exit code; the negative number of a signal.
    told
        What the command wrote to standard error.
    operations
        Operations on files of the folder.
    """

    code: int
    told: str
    operations: int


class Forker:
    """A process that runs trials; a context that ends it.

    Parameters
    ----------
    warm
        Names of commands that it runs first, so that what they need is loaded.
    planted
        Python text that spoils the program, so that trials must find a fault.
    """

    def __init__(self, warm: Sequence[str], planted: str = "") -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.cli.faults.forker", planted, *warm],
            cwd=ROOT,
            env={**os.environ, "NUMBA_THREADING_LAYER": "workqueue", "NUMBA_NUM_THREADS": "1"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def __enter__(self) -> "Forker":
        return self

    def __exit__(self, *_: object) -> None:
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    def run(self, trial: Trial) -> Outcome:
        """Run a trial to its end."""
        print(json.dumps(asdict(trial)), file=self._process.stdin, flush=True)
        return Outcome(**json.loads(self._process.stdout.readline()))


class _AtOnce:
    """Stands for a pool of threads: numba's own pool serves one thread only."""

    def __init__(self, *_: object) -> None:
        pass

    def submit(self, make: Callable, *arguments: object) -> Future:
        """Return what a function gives."""
        done: Future = Future()
        done.set_result(make(*arguments))
        return done

    def shutdown(self, **_: object) -> None:
        """Nothing waits."""


def _serve() -> None:
    """Load all; run the trials that the standard input names; write what came of each."""
    planted, *warm = sys.argv[1:]
    exec(planted, {})
    ahead.ThreadPoolExecutor = _AtOnce
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.chdir(folder),
        contextlib.redirect_stdout(sys.stderr),
    ):
        write_inputs(Path(folder))
        for command in COMMANDS:
            if command.name in warm:
                main(list(command.arguments), standalone_mode=False)
    for line in sys.stdin:
        trial = Trial(**json.loads(line))
        told, counted = os.pipe(), os.pipe()
        process = os.fork()
        if not process:
            _run(trial, told[1], counted[1])
        for _, end in (told, counted):
            os.close(end)
        if trial.kill_after is not None:
            time.sleep(trial.kill_after)
            os.kill(process, signal.SIGKILL)
        text, operations = (_text(end) for end, _ in (told, counted))
        code = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
        print(json.dumps(asdict(Outcome(code, text, len(operations)))), flush=True)


def _text(end: int) -> str:
    with os.fdopen(end, "rb") as stream:
        return stream.read().decode(errors="replace")


def _run(trial: Trial, told: int, counted: int) -> None:
    """Be the command, and end."""
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(nothing, 1)
    os.dup2(told, 2)
    sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w", buffering=1)
    os.chdir(trial.folder)
    if trial.temporary:
        os.environ["TMPDIR"] = trial.temporary
    if trial.read_only:
        _obey_modes()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if trial.dies:
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
    folder = os.path.realpath(trial.folder)
    _watch(folder, trial.kill_at, counted)
    if trial.most_bytes is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (trial.most_bytes, trial.most_bytes))
    if trial.memory is not None:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        most = pages * resource.getpagesize() + trial.memory
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
    try:
        main(list(trial.arguments), prog_name="splatline")
    except SystemExit as error:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(error.code if isinstance(error.code, int) else int(error.code is not None))
    except BaseException:
        sys.excepthook(*sys.exc_info())
        sys.stderr.flush()
    os._exit(1)


def _obey_modes() -> None:
    """Give up root's right to write where a mode forbids it (capset(2), CAP_DAC_OVERRIDE)."""
    libc = ctypes.CDLL(None, use_errno=True)
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)  # version 3, this process
    data = (ctypes.c_uint32 * 6)()
    libc.capget(header, data)
    for n in 0, 1:  # in effect, and permitted
        data[n] &= ~(1 << 1)
    assert libc.capset(header, data) == 0


def _watch(folder: str, kill_at: int | None, counted: int) -> None:
    """Count operations on files of a folder; kill this process before one of them."""
    seen = 0

    def hook(event: str, arguments: tuple) -> None:
        nonlocal seen
        if event not in EVENTS or not isinstance(arguments[0], str | os.PathLike):
            return
        if event == "open" and not (arguments[2] or 0) & (os.O_WRONLY | os.O_RDWR):
            return
        if not os.path.realpath(arguments[0]).startswith(folder + os.sep):
            return
        if seen == kill_at:
            os.kill(os.getpid(), signal.SIGKILL)
        seen += 1
        os.write(counted, b".")

    sys.addaudithook(hook)


if __name__ == "__main__":
    _serve()
