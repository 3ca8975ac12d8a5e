"""Simulation of whole frames in an engine's Verilog: code words in, rasters and cycles out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.contract.raster import Raster
from splatline.sim.cosim.kept_verilog import kept, parts_of_build
from splatline.sim.cosim.simulator import Build
from splatline.sim.cosim.watch import Progress

from .jobs import STREAMS, Outcome, Playing
from .play import play_jobs
from .player import wrap

__all__ = ["Job", "build_engine", "play", "simulate_frame", "simulate_frames"]


@dataclass(frozen=True, kw_only=True)
class Job(Playing):
    """Frames to play to an engine in succession, with the options of :class:`.jobs.Playing`.

    Parameters
    ----------
    frame
        First frame.
    followed_by
        Further frames. Their table writes and code words are offered while the frames before are
        still being drawn.
    """

    frame: Frame
    followed_by: Sequence[Frame] = ()

    @property
    def frames(self) -> list[Frame]:
        """The frames of the job."""
        return [self.frame, *self.followed_by]

    @property
    def parts(self) -> list[list[Frame]]:
        """Each frame as a single part, for the one engine."""
        return [[frame] for frame in self.frames]


def simulate_frame(
    frame: Frame,
    *,
    initial: Raster | None = None,
    stall: float = 0.0,
    seed: int = 1,
    progress: Progress | None = None,
) -> Outcome:
    """Draw one frame with the generated Verilog of its configuration.

    Parameters
    ----------
    frame
        Frame to draw.
    initial
        Initial raster.
    stall
        Share of the cycles, 0 to 255/256, in which each port stalls at random.
    seed
        Seed of the random stalls.
    progress
        Called now and then with ``build`` or ``run``, and the share of it that is done.

    Raises
    ------
    SimulationError
        If the simulator fails or the engine breaks a rule of its contract.
    """
    rates = dict.fromkeys(STREAMS, 1.0 - stall)
    return play([Job(frame=frame, initial=initial, rates=rates, seed=seed)], progress=progress)[0]


def simulate_frames(frames: Sequence[Frame], *, stall: float = 0.0, seed: int = 1) -> list[Outcome]:
    """Draw frames as :func:`simulate_frame` does, each alone, in one run of the simulator."""
    rates = dict.fromkeys(STREAMS, 1.0 - stall)
    return play([Job(frame=frame, rates=rates, seed=seed) for frame in frames])


def build_engine(
    config: EngineConfig,
    simulator_name: str = "verilator",
    progress: Callable[[float], None] | None = None,
) -> Build:
    """Build the player around an engine's Verilog, or return its cached build.

    ``progress`` is called now and then with the share that is done.
    """
    writing, building = parts_of_build(progress)

    def write() -> str:
        from splatline.flow.verilog import generate

        return generate(config, progress=writing)[0]

    text = kept("engine", config, write)
    return wrap(text, config, simulator_name=simulator_name, progress=building)


def play(
    jobs: Sequence[Job],
    *,
    simulator_name: str = "verilator",
    built: Build | None = None,
    progress: Progress | None = None,
) -> list[Outcome]:
    """Play frames one after the other, in one run of the simulator.

    Parameters
    ----------
    jobs
        At least one; all of one configuration.
    simulator_name
        One of ``simulator.SIMULATORS``.
    built
        A build of ``frame_player`` to use instead of the configuration's own, such as one with a
        planted fault.
    progress
        See :func:`.play.play_jobs`.

    Raises
    ------
    SimulationError, ValueError
        See :func:`.play.play_jobs`.
    """

    def build(config: EngineConfig, _: int, tell: Callable[[float], None] | None) -> Build:
        return built or build_engine(config, simulator_name, tell)

    return play_jobs(jobs, build, progress)
