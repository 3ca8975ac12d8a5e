"""What is being done and how long it took."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["Counter", "Stages"]


class Stages:
    """Times the stages of a command and shows the one under way on standard error.

    A terminal gets a moving bar and a clock, which vanish when the stage ends; anything else gets
    one line a stage.

    Attributes
    ----------
    seconds
        Wall time of each stage that has ended, by name.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str, description: str) -> Iterator[None]:
        """Time the block as stage ``name``; an empty name shows it without timing it."""
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            Progress,
            SpinnerColumn,
            TextColumn,
            TimeElapsedColumn,
        )

        console = Console(stderr=True)
        start = time.perf_counter()
        if console.is_terminal:
            with Progress(
                SpinnerColumn(),
                TextColumn("{task.description}", markup=False),
                BarColumn(bar_width=30),
                TimeElapsedColumn(),
                console=console,
                transient=True,
            ) as progress:
                progress.add_task(description, total=None)
                yield
        else:
            console.print(f"{description} ...", highlight=False, markup=False, soft_wrap=True)
            yield
        if name:
            self.seconds[name] = time.perf_counter() - start


class Counter:
    """Shows how far a known number of runs has come: a bar, or a line every tenth elsewhere.

    Parameters
    ----------
    total
        Number of runs, each of which is announced with ``advance``.
    """

    def __init__(self, total: int) -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TaskProgressColumn,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )

        self._total = total
        self._begun = 0
        self._console = Console(stderr=True)
        self._progress = Progress(
            BarColumn(bar_width=30),
            TaskProgressColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            TextColumn("{task.description}", markup=False),
            console=self._console,
            transient=True,
            disable=not self._console.is_terminal,
        )
        self._task = self._progress.add_task("", total=total)

    def __enter__(self) -> Counter:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def advance(self, description: str) -> None:
        """Say that one run is done, if it is not the first, and the next begins."""
        self._progress.update(self._task, completed=self._begun, description=description)
        tenths = 10 * self._begun // self._total
        if not self._console.is_terminal and (
            self._begun == 0 or tenths > 10 * (self._begun - 1) // self._total
        ):
            self._console.print(
                f"{10 * tenths:3d} %  {description} ...", highlight=False, markup=False,
                soft_wrap=True,
            )  # fmt: skip
        self._begun += 1
