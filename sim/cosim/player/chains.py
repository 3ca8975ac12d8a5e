"""Simulation of whole frames in the Verilog of a chain, one stream of code words an engine."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.host.encode.partition import partition
from splatline.host.encode.partition_methods import DEFAULT_METHOD
from splatline.sim.cosim.kept_verilog import kept, parts_of_build
from splatline.sim.cosim.simulator import Build
from splatline.sim.cosim.watch import Progress

from .jobs import STREAMS, Outcome, Playing
from .play import play_jobs
from .player import wrap

__all__ = ["ChainJob", "build_chain", "play_chain", "simulate_parts"]


@dataclass(frozen=True, kw_only=True)
class ChainJob(Playing):
    """Frames to play to a chain in succession, with the options of :class:`.jobs.Playing`.

    Parameters
    ----------
    frames
        Parts of each frame, shape (frames, engines). All parts of a frame have the same tables.
    """

    frames: Sequence[Sequence[Frame]]

    @classmethod
    def partitioned(
        cls, *frames: Frame, engines: int, method: str = DEFAULT_METHOD, **options: object
    ) -> ChainJob:
        """Return a job of whole frames, each partitioned among the engines."""
        parts = [partition(frame, engines, method) for frame in frames]
        return cls(frames=parts, **options)  # type: ignore[arg-type]

    @property
    def parts(self) -> Sequence[Sequence[Frame]]:
        """The part of each frame that each engine draws."""
        return self.frames


def build_chain(
    config: EngineConfig,
    engines: int,
    link: str = "merge",
    *,
    queue: int | None = None,
    simulator_name: str = "verilator",
    progress: Callable[[float], None] | None = None,
) -> Build:
    """Build the player around a chain's Verilog, or return its cached build.

    ``progress`` is called now and then with the share that is done.
    """
    writing, building = parts_of_build(progress)

    def write() -> str:
        from splatline.flow.chain_verilog import generate_chain
        from splatline.rtl.chain.chain import QUEUE

        length = QUEUE if queue is None else queue
        return generate_chain(config, engines, link, queue=length, progress=writing)[0]

    text = kept("chain", (config, engines, link, queue), write)
    return wrap(text, config, engines, simulator_name=simulator_name, progress=building)


def play_chain(
    jobs: Sequence[ChainJob],
    *,
    link: str = "merge",
    queue: int | None = None,
    simulator_name: str = "verilator",
    built: Build | None = None,
    progress: Progress | None = None,
) -> list[Outcome]:
    """Play jobs one after the other, in one run of the simulator.

    Parameters
    ----------
    jobs
        At least one; all of one configuration and number of engines.
    link, queue
        Link of the chain, and length of its fifos.
    simulator_name
        One of ``simulator.SIMULATORS``.
    built
        A build of ``frame_player`` to use instead of the chain's own, such as one with a planted
        fault.
    progress
        See :func:`.play.play_jobs`.

    Raises
    ------
    SimulationError, ValueError
        See :func:`.play.play_jobs`.
    """

    def build(config: EngineConfig, engines: int, tell: Callable[[float], None] | None) -> Build:
        return built or build_chain(
            config, engines, link, queue=queue, simulator_name=simulator_name, progress=tell
        )

    return play_jobs(jobs, build, progress)


def simulate_parts(
    parts: Sequence[Frame],
    *,
    link: str = "merge",
    stall: float = 0.0,
    seed: int = 1,
    progress: Progress | None = None,
) -> Outcome:
    """Draw one frame, partitioned among the engines, with the generated Verilog of a chain.

    Parameters
    ----------
    parts
        The part of each engine.
    link
        Link of the chain.
    stall, seed, progress
        As for :func:`.frames.simulate_frame`.

    Raises
    ------
    SimulationError
        If the simulator fails or the chain breaks a rule of its contract.
    """
    rates = dict.fromkeys(STREAMS, 1.0 - stall)
    job = ChainJob(frames=[parts], rates=rates, seed=seed)
    return play_chain([job], link=link, progress=progress)[0]
