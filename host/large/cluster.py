"""Draws the parts of a large cloud on the workers of a Dask cluster, and joins them in a tree.

Sort-last: a worker draws its part alone, and what travels is at most one code word for each pixel
(Molnar, Cox, Ellsworth and Fuchs, *A sorting classification of parallel rendering*, 1994). The
parts depend on the files alone, and frames may be joined in any order, so the picture is that of
one machine, bit for bit. Dask does again what a lost worker has done.
"""

from __future__ import annotations

import platform
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import metadata
from typing import Any, NamedTuple

from splatline.contract.errors import InputError, install_hint
from splatline.contract.frame import Frame

from .draw_parts import Drawing, PartFrames, Progress, check_shown, draw_part, join_parts
from .plan import Part, Plan

__all__ = [
    "LOCAL",
    "Traffic",
    "bytes_of",
    "draw_on_cluster",
    "draw_on_worker",
    "hand_out",
    "lost_workers",
    "open_cluster",
    "wait_for",
]

LOCAL = "local"
"""The address of a cluster of this machine's own processes."""

ANY_PORT = "127.0.0.1:0"
"""Of the scheduler's web server, which cannot be left out. The usual port may be taken."""

PATIENCE = 10
"""Seconds to wait for a scheduler, and for its first worker."""

PACKAGES = ("splatline", "numpy", "numba", "distributed")
"""Packages whose versions must be alike, beside Python's."""


class Traffic(NamedTuple):
    """Results of the tasks of a picture.

    Parameters
    ----------
    tasks
        Parts that were drawn, and joins.
    bytes
        Code words that the tasks returned, in bytes. All of them may go to another worker.
    """

    tasks: int
    bytes: int


def draw_on_cluster(
    plan: Plan, drawing: Drawing, client: Any, *, progress: Progress | None = None
) -> tuple[PartFrames, Traffic]:
    """Draw all parts on a cluster's workers; see :func:`splatline.host.large.draw_parts`.

    Parameters
    ----------
    plan, drawing
        As for ``draw_parts``. The workers read the files by the same names.
    client
        See :func:`open_cluster`.
    progress
        Called now and then with the stage ``parts`` and the share that is done.

    Raises
    ------
    InputError
        If a file is damaged, or a worker has it not; if workers are lost again and again, or
        nothing is in view.
    """
    shared = hand_out(client, plan, drawing)
    futures = [client.submit(draw_on_worker, *shared, part, pure=False) for part in plan.parts]
    tasks = list(futures)
    while len(futures) > 1:
        pairs = [futures[first : first + 2] for first in range(0, len(futures), 2)]
        futures = [
            client.submit(_join, *pair, pure=False) if len(pair) == 2 else pair[0] for pair in pairs
        ]
        tasks += [future for future in futures if future not in tasks]
    sizes = [client.submit(_bytes, future, pure=False) for future in tasks]
    try:
        wait_for(sizes, progress)
        with lost_workers():
            joined = futures[0].result()
            traffic = Traffic(len(tasks), sum(client.gather(sizes)))
    finally:
        client.cancel([*tasks, *sizes])
    check_shown(plan, drawing, joined)
    return joined, traffic


def hand_out(client: Any, *values: Any) -> list[Any]:
    """Return futures of values that each worker fetches once.

    They are results of tasks, which Dask does again if a worker is lost. What is scattered would be
    lost with the last worker that holds it.
    """
    return [client.submit(_same, value, pure=False) for value in values]


def _same(value: Any) -> Any:
    """Return a value, on a worker."""
    return value


@contextmanager
def open_cluster(address: str) -> Iterator[Any]:
    """Open a client of a cluster whose workers have the same packages.

    Parameters
    ----------
    address
        Of a Dask scheduler, such as ``tcp://host:8786``; ``local``: processes of this machine.

    Raises
    ------
    InputError
        If Dask is not installed, no scheduler answers, it has no workers, or their packages differ.
    """
    try:
        from distributed import Client, LocalCluster
    except ModuleNotFoundError as error:
        raise InputError(f"--dask needs {error.name}: {install_hint('dask')}") from None
    if address == LOCAL:
        with (
            LocalCluster(
                dashboard_address=ANY_PORT, memory_limit=None, threads_per_worker=1
            ) as cluster,
            Client(cluster) as client,
        ):
            yield client
        return
    try:
        client = Client(address, timeout=PATIENCE)
    except (OSError, TimeoutError, ValueError) as error:
        raise InputError(
            f"no Dask scheduler answers at {address!r} ({error or type(error).__name__}); start one"
            " with 'dask scheduler', or take --dask local"
        ) from None
    with client:
        _check_workers(client, address)
        yield client


def _check_workers(client: Any, address: str) -> None:
    """Raise ``InputError`` unless there are workers with the same packages."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        raise InputError(
            f"the Dask scheduler at {address} has no workers; start some: dask worker {address}"
        ) from None
    mine = _versions()
    for worker, answer in client.run(_versions, on_error="return").items():
        if isinstance(answer, Exception):
            raise InputError(f"the worker {worker} cannot import splatline: {answer}")
        for name, version in answer.items():
            if version != mine[name]:
                raise InputError(
                    f"the worker {worker} has {name} {version}, this machine {mine[name]};"
                    " install the same everywhere"
                )


def _versions() -> dict[str, str]:
    """Return the versions that must be alike."""
    return {
        "Python": platform.python_version(),
        **{package: metadata.version(package) for package in PACKAGES},
    }


@contextmanager
def lost_workers() -> Iterator[None]:
    """Raise ``InputError`` if Dask gives a task up, since its workers are lost."""
    from distributed import KilledWorker

    try:
        yield
    except KilledWorker as error:
        raise InputError(
            "workers were lost again and again while they drew one part; do they have enough"
            f" memory? ({error.last_worker.address})"
        ) from None


def wait_for(futures: Sequence[Any], progress: Progress | None) -> None:
    """Wait until all futures are done; tell the stage ``parts`` the share of them.

    Raises
    ------
    InputError
        If a task raised it, or workers are lost again and again.
    """
    from distributed import as_completed

    with lost_workers():
        for done, _ in enumerate(as_completed(futures, raise_errors=True), 1):
            if progress is not None:
                progress("parts", done / len(futures))


def draw_on_worker(plan: Plan, drawing: Drawing, part: Part) -> PartFrames:
    """Draw a part, on a worker."""
    from distributed import get_worker

    try:
        return draw_part(plan, part, drawing)
    except InputError as error:
        raise InputError(f"{error} (on the worker {get_worker().address})") from None


def _join(one: PartFrames, other: PartFrames) -> PartFrames:
    """Join two parts, on a worker."""
    return join_parts([one, other])


def _bytes(parts: PartFrames) -> int:
    """Return the bytes of the code words of parts, on the worker that has them."""
    return bytes_of(parts.frames)


def bytes_of(frames: Sequence[Frame | None]) -> int:
    """Return the bytes of the code words of frames."""
    return sum(frame.codewords.nbytes for frame in frames if frame is not None)
