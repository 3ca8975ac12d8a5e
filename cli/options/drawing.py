"""Drawing of frames by the golden renderer or the Verilog, and the options for it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import click

from splatline.cli.report.progress import Stages
from splatline.contract.errors import InputError, install_hint
from splatline.contract.tool_error import ToolFailure

from .parameters import COLOUR

if TYPE_CHECKING:
    from splatline.contract.frame import Frame
    from splatline.sim.cosim.player.jobs import Outcome
    from splatline.sim.golden.multisample import Drawn

__all__ = [
    "Drawing",
    "background_option",
    "draw",
    "engine_options",
    "fail_mismatch",
    "simulate_all",
]

_Command = TypeVar("_Command", bound=Callable[..., Any])


@dataclass(frozen=True)
class Drawing:
    """A drawn picture, of one sample a pixel or of several.

    Parameters
    ----------
    golden
        The golden renderer's picture.
    rtl
        The Verilog's picture, if it was simulated.
    cycles
        Clock cycles of the Verilog from the first code word to the end of the raster, summed over
        the frames.
    """

    golden: Drawn
    rtl: Drawn | None = None
    cycles: int | None = None

    @property
    def raster(self) -> Drawn:
        """The Verilog's picture if it was simulated, else the golden renderer's."""
        return self.golden if self.rtl is None else self.rtl

    @property
    def mismatched_pixels(self) -> int | None:
        """Number of pixels that differ between Verilog and golden; None without a simulation."""
        if self.rtl is None:
            return None
        from splatline.sim.golden.multisample import mismatches

        return mismatches(self.rtl, self.golden)


def engine_options(command: _Command) -> _Command:
    """Add the options ``engine``, ``stall`` and ``seed`` to a command."""
    for option in (
        click.option(
            "--seed",
            type=click.IntRange(0, 2**32 - 1),
            metavar="N",
            default=1,
            help="With rtl and axi: seed of the random stalls.",
        ),
        click.option(
            "--stall",
            type=click.FloatRange(0.0, 0.99),
            metavar="SHARE",
            default=0.0,
            help="With rtl and axi: share of the cycles in which each port stalls, at random.",
        ),
        click.option(
            "--engine",
            type=click.Choice(["golden", "rtl", "axi"]),
            default="golden",
            help="golden: the bit-exact renderer, fast. rtl: the Verilog, simulated and compared"
            " with golden; exit code 1 if a colour or a depth differs. axi: the same for the engine"
            " on AXI, through the driver; slow.",
        ),
    ):
        command = option(command)
    return command


def background_option(command: _Command) -> _Command:
    """Add the option ``background``: RGB in 0..1, or None for the figures' own colour."""
    return click.option(
        "--background",
        type=COLOUR,
        metavar="#RRGGBB",
        show_default="the figures' own",
        help="Colour of the background: #RRGGBB, white, black or grey.",
    )(command)


def draw(
    frames: Sequence[Frame],
    engine: str,
    stages: Stages,
    *,
    stall: float,
    seed: int,
    engines: int | None = None,
    link: str = "merge",
) -> Drawing:
    """Draw a picture.

    Parameters
    ----------
    frames
        A frame for each sample of a pixel.
    engine
        ``golden``, ``rtl`` or ``axi``; the golden renderer draws in every case.
    stages
        Receives the times ``golden``, ``rtl_build`` and ``rtl_run``.
    stall, seed
        Random stalls in the simulation of the Verilog.
    engines, link
        Number of engines in the chain and its link; None: a single engine.

    Raises
    ------
    InputError
        If the simulation is asked for and its packages are not installed.
    ToolFailure
        If the simulator fails or the Verilog breaks the rules of its ports.
    """
    from splatline.sim import golden
    from splatline.sim.golden.multisample import average

    parts = [[frame] for frame in frames]
    if engines is not None:
        if engine == "axi":
            raise InputError("a chain has no buses yet: give --engines or --engine axi, not both")
        from splatline.host.encode.partition import partition

        parts = [partition(frame, engines) for frame in frames]
    pictures = []
    with stages.stage("golden", "Drawing with the golden renderer") as share:
        for number, each in enumerate(parts, 1):
            pictures.append(golden.render_parts(each))
            share(number / len(parts))
    if engine == "golden":
        return Drawing(average(pictures))
    runs = []
    for number, each in enumerate(parts, 1):
        which = f", sample {number} of {len(parts)}" if len(parts) > 1 else ""
        steps = {
            "build": "Writing the Verilog and building its simulator, if they are new",
            "run": f"Simulating the Verilog{which}",
        }
        with Stages().stages(steps) as tell:
            if engines is not None:
                run = _simulate_chain(each, link, stall, seed, tell)
            elif engine == "axi":
                run = _simulate_on_buses(each[0], stall, seed, tell)
            else:
                run = _simulate(each[0], stall, seed, tell)
        runs.append(run)
    for run in runs:
        for name, value in run.seconds.items():
            stages.seconds[f"rtl_{name}"] = stages.seconds.get(f"rtl_{name}", 0.0) + value
    rasters = average([run.raster for run in runs])
    return Drawing(average(pictures), rasters, sum(run.cycles for run in runs))


def _simulate_chain(
    parts: list[Frame], link: str, stall: float, seed: int, tell: Callable[[str, float], None]
) -> Outcome:
    """Simulate the Verilog of a chain."""
    with _simulation_errors():
        from splatline.sim.cosim.player.chains import simulate_parts

        return simulate_parts(parts, link=link, stall=stall, seed=seed, progress=tell)


def _simulate(frame: Frame, stall: float, seed: int, tell: Callable[[str, float], None]) -> Outcome:
    """Simulate the Verilog of an engine."""
    with _simulation_errors():
        from splatline.sim.cosim.player.frames import simulate_frame

        return simulate_frame(frame, stall=stall, seed=seed, progress=tell)


def simulate_all(frames: Sequence[Frame], stall: float, seed: int) -> list[Outcome]:
    """Simulate the Verilog of an engine for some frames, each alone, in one run."""
    if not frames:
        return []
    with _simulation_errors():
        from splatline.sim.cosim.player.frames import simulate_frames

        return simulate_frames(frames, stall=stall, seed=seed)


def _simulate_on_buses(
    frame: Frame, stall: float, seed: int, tell: Callable[[str, float], None]
) -> Outcome:
    """Simulate the Verilog of an engine on AXI."""
    with _simulation_errors():
        from splatline.sim.cosim.axi.axi_frames import simulate_on_buses

        return simulate_on_buses(frame, stall=stall, seed=seed, progress=tell)


@contextmanager
def _simulation_errors() -> Iterator[None]:
    """Convert a simulation's errors to those that the command line reports in a message."""
    from splatline.sim.cosim.simulator import SimulationError

    try:
        yield
    except ModuleNotFoundError as error:
        hint = install_hint("cosim")
        raise InputError(f"the simulation needs {error.name}: {hint}") from error
    except SimulationError as error:
        raise ToolFailure(str(error)) from error


def fail_mismatch(context: click.Context, pixels: int) -> NoReturn:
    """Report that Verilog and golden differ at some pixels, and exit with code 1."""
    click.echo(
        f"splatline: {pixels:,} pixels of the Verilog's picture differ from the golden renderer's",
        err=True,
    )
    context.exit(1)
