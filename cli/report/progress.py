"""Progress of a command on standard error, and the times of its stages."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

__all__ = ["Counter", "Stages"]

EVERY = 0.1
"""Seconds between two looks of a terminal's bar at the share that is done."""

SLOW = 3.0
"""Seconds after which a stage says its share elsewhere than in a terminal."""


class Stages:
    """Timer of a command's stages that shows the current stage on standard error.

    A terminal shows a bar and a clock, which vanish when the stage ends. Any other output gets one
    line for each stage, and for a slow one that tells its share a line for each quarter.

    Attributes
    ----------
    seconds
        Wall time of each finished stage, by name.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str, description: str) -> Iterator[Callable[[float], None]]:
        """Show and time the block as stage ``name``; a stage with an empty name is not timed.

        Yields
        ------
        callable
            May be called with the share of the stage that is done, 0 to 1, as often as one likes.
        """
        start = time.perf_counter()
        with _Shown(description) as shown:
            yield shown.tell
        if name:
            self.seconds[name] = time.perf_counter() - start

    @contextmanager
    def stages(self, descriptions: Mapping[str, str]) -> Iterator[Callable[[str, float], None]]:
        """Show and time the block as several stages, each of which begins when it is first told.

        Parameters
        ----------
        descriptions
            Description of each stage by its name. The first stage begins with the block.

        Yields
        ------
        callable
            Called with a stage's name and the share of it that is done.
        """
        names = list(descriptions)
        current, start = names[0], time.perf_counter()
        shown = _Shown(descriptions[current])

        def tell(name: str, share: float) -> None:
            nonlocal current, start, shown
            if name != current:
                shown.__exit__()
                now = time.perf_counter()
                self.seconds[current] = self.seconds.get(current, 0.0) + now - start
                current, start = name, now
                shown = _Shown(descriptions[name]).__enter__()
            shown.tell(share)

        shown.__enter__()
        try:
            yield tell
        finally:
            shown.__exit__()
        now = time.perf_counter()
        self.seconds[current] = self.seconds.get(current, 0.0) + now - start


class _Shown:
    """A stage on standard error, as a context: a bar in a terminal, else lines."""

    def __init__(self, description: str) -> None:
        from rich.console import Console

        self._description = description
        self._console = Console(stderr=True)
        self._progress = self._bar() if self._console.is_terminal else None
        self._share = 0.0
        self._quarter = 0
        self._begun = self._looked = time.perf_counter()

    def __enter__(self) -> _Shown:
        if self._progress is None:
            self._print(f"{self._description} ...")
        else:
            self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._progress is not None:
            self._progress.stop()

    def tell(self, share: float) -> None:
        """Show the share that is done. It never falls, and most calls return at once."""
        self._share = min(max(share, self._share), 1.0)
        now = time.perf_counter()
        if now - self._looked < EVERY:
            return
        self._looked = now
        if self._progress is not None:
            # Drawn here, since the bar's own thread waits while compiled code runs.
            task = self._progress.task_ids[0]
            self._progress.update(task, total=1.0, completed=self._share, refresh=True)
            return
        quarter = int(4.0 * self._share)
        if self._quarter < quarter < 4 and now - self._begun >= SLOW:
            self._quarter = quarter
            self._print(f"{int(100.0 * self._share):3d} %  {self._description} ...")

    def _print(self, line: str) -> None:
        self._console.print(line, highlight=False, markup=False, soft_wrap=True)

    def _bar(self) -> Any:
        """Return a bar that moves to and fro until a share is told."""
        from rich.progress import (
            BarColumn,
            Progress,
            SpinnerColumn,
            TaskProgressColumn,
            TextColumn,
            TimeElapsedColumn,
        )

        progress = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=30),
            TaskProgressColumn(),
            TimeElapsedColumn(),
            console=self._console,
            transient=True,
        )
        progress.add_task(self._description, total=None)
        return progress


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
