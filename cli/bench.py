"""``splatline bench``: measurements that become pages, tables and plots."""

from __future__ import annotations

from pathlib import Path

import click

from .bench_host import host
from .bench_stability import stability
from .outputs import check_folder
from .parameters import ORBIT, SIZE

__all__ = ["bench"]


@click.group()
def bench() -> None:
    """Measure, and write tables and plots of it.

    \b
    Examples:
      splatline bench accuracy                  every quality and preset against the reference
      splatline bench host                      rates of every stage, beside other renderers
      splatline bench stability                 the stress suite as tables
    """  # noqa: D301  (click reads the backspace as "do not wrap")


@bench.command()
@click.argument("clouds", nargs=-1, type=click.Path(path_type=Path), metavar="[CLOUD ...]")
@click.option(
    "--scene",
    "scenes",
    multiple=True,
    metavar="NAME",
    show_default="all",
    help="Built-in scene; may be given several times.",
)
@click.option(
    "--view",
    "views",
    multiple=True,
    type=ORBIT,
    metavar="AZ,EL",
    show_default="the scene's, or 30,20",
    help="Azimuth and elevation of the eye in degrees; may be given several times.",
)
@click.option("--size", type=SIZE, metavar="WxH", default=None, show_default="512x512",
              help="Size of the image in pixels.")  # fmt: skip
@click.option(
    "--out-dir",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    default=Path("docs/bench"),
    help="Where accuracy.json, accuracy.md and the plots go.",
)
@click.option(
    "--no-pictures",
    "unseen",
    multiple=True,
    metavar="NAME",
    help="Keep a cloud's numbers without its pictures, where terms forbid them; may be repeated.",
)
@click.option("--quick", is_flag=True, help="A small image and few runs: a trial.")
def accuracy(
    clouds: tuple[Path, ...],
    scenes: tuple[str, ...],
    views: tuple[tuple[float, float], ...],
    size: tuple[int, int] | None,
    out_dir: Path,
    unseen: tuple[str, ...],
    quick: bool,
) -> None:
    """Measure every quality, preset and skip against the exact reference.

    Times, code words, cycles and errors, for the built-in scenes and any CLOUDs, with splats of the
    points' spacing and of several sizes in pixels.

    \b
    Examples:
      splatline bench accuracy
      splatline bench accuracy scan.ply --view 30,20 --view -120,5 --out-dir build/bench
      splatline bench accuracy --scene knot --quick --out-dir build/bench
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from ..host.errors import InputError
    from ..host.scenes import SCENES
    from .bench_accuracy import Sweep, measure
    from .bench_write import write_accuracy

    unknown = [name for name in scenes if name not in SCENES]
    if unknown:
        raise InputError(f"no scene named {unknown[0]!r}; there are: {', '.join(SCENES)}")
    missing = [path for path in clouds if not path.is_file()]
    if missing:
        raise InputError(f"{missing[0]}: no such file")
    names = [*(scenes or SCENES), *(path.stem for path in clouds)]
    for name in unseen:
        if name not in names:
            raise InputError(f"no pictures of {name!r} to leave out; there are: {', '.join(names)}")
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise InputError(f"two clouds are called {twice[0]!r}; rename one of them")
    check_folder(out_dir)
    sweep = Sweep(clouds, scenes or SCENES, views, size or (512, 512))
    if quick:
        sweep = Sweep(
            clouds,
            scenes or SCENES[-1:],
            views,
            size or (64, 64),
            splats=(None, 3.5),
            presets=("paper", "rgb24"),
            fewer_presets=("paper",),
            ladders=(None,),
            repeats=1,
        )
    with _Counter(sweep.total()) as counter:
        results, crops = measure(sweep, counter.advance)
    shown = [crop for crop in crops if crop.scene not in unseen]
    files = write_accuracy(out_dir, results, shown)
    click.echo(f"{len(results['runs'])} runs; written: {', '.join(map(str, files))}")


class _Counter:
    """Shows how far a known number of runs has come: a bar, or a line every tenth elsewhere."""

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

    def __enter__(self) -> _Counter:
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


for _command in (host, stability):
    bench.add_command(_command)
