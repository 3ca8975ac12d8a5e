"""What is being done and how long it took."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["Stages"]


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
