"""Progress of a command on standard error, and the times of its stages."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["Counter", "Stages"]


class Stages:
    """Timer of a command's stages that shows the current stage on standard error.

    A terminal shows a moving bar and a clock, which vanish when the stage ends. Any other output
    gets one line for each stage.

    Attributes
    ----------
    seconds
        Wall time of each finished stage, by name.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str, description: str) -> Iterator[None]:
        """Show and time the block as stage ``name``; a stage with an empty name is not timed."""
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
    """Progress of a known number of runs: a bar in a terminal, else a line every tenth.

    Parameters
    ----------
    total
        Number of runs; ``advance`` is called before each.
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
        """Announce the next run; the run before it is done."""
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
