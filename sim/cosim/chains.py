"""Whole frames through the Verilog of a chain of engines: a stream of code words for each."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ...host.deal import deal
from ...host.deal_methods import DEFAULT_METHOD
from ...host.frame import Frame
from ...rtl.format import EngineConfig
from .. import golden
from ..beats import to_beats
from ..raster import Raster
from . import simulator
from .frames import (
    STREAMS,
    Outcome,
    check_report,
    frames_with_tables,
    pictures,
    read_hex,
    scaled_rates,
    starts,
    table_writes,
    write_hex,
)
from .player import wrap
from .simulator import Build

__all__ = [
    "ChainJob",
    "ChainOutcome",
    "Times",
    "build_chain",
    "compose",
    "play_chain",
    "simulate_parts",
]


@dataclass(frozen=True, kw_only=True)
class ChainJob:
    """Frames to play to a chain one behind the other, and how to disturb it.

    Parameters
    ----------
    frames
        The parts of each frame: shape (frames, engines). All parts of a frame have its tables.
    initial
        Raster that every frame starts from whose table writes ask for it; see :class:`.frames.Job`.
    rates
        Share of the cycles in which each stream is willing, as of :class:`.frames.Job`. Every
        engine's code words come at the same rate, and each at times of its own.
    seed
        Of the random gaps.
    reset_after
        Cycles after which the chain is reset and the frames started anew.
    write_tables
        ``every``, ``first`` or ``none``, as of :class:`.frames.Job`.
    most_cycles
        After so many the job counts as stuck; more than enough if not given.
    """

    frames: Sequence[Sequence[Frame]]
    initial: Raster | None = None
    rates: dict[str, float] = field(default_factory=dict)
    seed: int = 1
    reset_after: int | None = None
    write_tables: str = "every"
    most_cycles: int | None = None

    @classmethod
    def dealt(
        cls, *frames: Frame, engines: int, method: str = DEFAULT_METHOD, **options: object
    ) -> ChainJob:
        """Return a job of whole frames, each dealt to the engines."""
        parts = [deal(frame, engines, method) for frame in frames]
        return cls(frames=parts, **options)  # type: ignore[arg-type]

    def pictures(self) -> list[Raster]:
        """Return what golden makes of each frame."""
        return [
            compose(parts, start) for parts, start in zip(self.frames, self.starts, strict=True)
        ]

    @property
    def starts(self) -> list[Raster | None]:
        """What each frame starts from."""
        return starts(self.initial, len(self.frames), self.write_tables)


@dataclass(frozen=True)
class Times:
    """When what began and ended in a frame: cycles from the start of its job.

    Parameters
    ----------
    opened, closed
        Of each engine its first code word and its end word.
    first_beat, end_beat
        Of the raster; the same if nothing was drawn.
    """

    opened: tuple[int, ...]
    closed: tuple[int, ...]
    first_beat: int
    end_beat: int


@dataclass(frozen=True)
class ChainOutcome:
    """What the Verilog made of a job.

    Parameters
    ----------
    rasters
        The pictures, one a frame.
    beats
        The stream they came in: shape (n, words of 64 bits), uint64.
    cycles
        From the first code word taken to the last end beat, both included.
    times
        Of each frame.
    seconds
        Time the simulator took to build and to run, which all jobs of a run share.
    """

    rasters: list[Raster]
    beats: npt.NDArray[np.uint64]
    cycles: int
    times: list[Times]
    seconds: dict[str, float]


def compose(parts: Sequence[Frame], initial: Raster | None = None) -> Raster:
    """Return golden's picture of parts drawn one over the other, the first one first."""
    raster = initial
    for part in parts:
        raster = golden.render(part, raster)
    assert raster is not None, "a frame has at least one part"
    return raster


def build_chain(
    config: EngineConfig,
    engines: int,
    link: str = "merge",
    *,
    queue: int | None = None,
    simulator_name: str = "verilator",
) -> Build:
    """Build the player around a chain's Verilog, or find it built."""
    from ...rtl.chain import QUEUE
    from ...rtl.chain_verilog import generate_chain

    text, _ = generate_chain(config, engines, link, queue=QUEUE if queue is None else queue)
    return wrap(text, config, engines, simulator_name=simulator_name)


def play_chain(
    jobs: Sequence[ChainJob],
    *,
    link: str = "merge",
    queue: int | None = None,
    simulator_name: str = "verilator",
    built: Build | None = None,
) -> list[ChainOutcome]:
    """Play jobs one after the other, in one run of the simulator.

    Parameters
    ----------
    jobs
        At least one; all of one configuration and number of engines.
    link, queue
        Of the chain.
    simulator_name
        One of ``simulator.SIMULATORS``.
    built
        A build of ``frame_player`` to use instead of the chain's own, such as a broken one.

    Raises
    ------
    SimulationError
        If the simulator fails, a frame does not end, or a port breaks the stream rules.
    """
    shapes = {(len(parts), part.config) for job in jobs for parts in job.frames for part in parts}
    if len(shapes) != 1:
        raise ValueError("the jobs of one run share a configuration and a number of engines")
    engines, config = shapes.pop()
    begin = time.perf_counter()
    if built is None:
        built = build_chain(config, engines, link, queue=queue, simulator_name=simulator_name)
    seconds = {"build": time.perf_counter() - begin}
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        descriptions = [_write(folder, index, job, config) for index, job in enumerate(jobs)]
        (folder / "jobs.json").write_text(json.dumps(descriptions))
        begin = time.perf_counter()
        simulator.run(
            built,
            f"{__package__}.frame_bench",
            plusargs=[f"+folder={folder}"],
            environment={"SPLATLINE_FOLDER": str(folder)},
        )
        seconds["run"] = time.perf_counter() - begin
        reports = json.loads((folder / "outcomes.json").read_text())
        outcomes = []
        for index, job in enumerate(jobs):
            check_report(index, reports[index] if index < len(reports) else None)
            beats = read_hex(folder / f"{index}.raster", config.raster_end.end)
            rasters = pictures(index, beats, [parts[0] for parts in job.frames])
            times = _times(folder / f"{index}.events", len(job.frames), engines)
            outcomes.append(ChainOutcome(rasters, beats, reports[index]["cycles"], times, seconds))
    return outcomes


def simulate_parts(
    parts: Sequence[Frame], *, link: str = "merge", stall: float = 0.0, seed: int = 1
) -> Outcome:
    """Draw one frame, dealt to engines, with the generated Verilog of their chain.

    Parameters
    ----------
    parts
        What each engine draws.
    link
        Of the chain.
    stall, seed
        As of :func:`.frames.simulate_frame`.

    Raises
    ------
    SimulationError
        If the simulator fails or the chain breaks a rule of its contract.
    """
    rates = dict.fromkeys(STREAMS, 1.0 - stall)
    job = ChainJob(frames=[parts], rates=rates, seed=seed)
    outcome = play_chain([job], link=link)[0]
    return Outcome(outcome.rasters, outcome.beats, outcome.cycles, outcome.seconds)


def _write(folder: Path, index: int, job: ChainJob, config: EngineConfig) -> dict[str, object]:
    """Write the files that the player reads for a job; return what the bench needs to know."""
    for engine, parts in enumerate(zip(*job.frames, strict=True)):
        words = np.concatenate([part.codewords for part in parts])
        write_hex(folder / f"{index}.codewords_{engine:02}", words[:, np.newaxis], 64)
    written = frames_with_tables(job.write_tables, len(job.frames))
    writes = [
        table_writes(first.tables, first.width, first.height, start is not None, config)
        for (first, *_), start in zip(job.frames[:written], job.starts, strict=False)
    ]
    if writes:
        write_hex(folder / f"{index}.tables", np.concatenate(writes), config.table_address.end)
    beats = [to_beats(start) for start in job.starts if start is not None]
    if beats:
        write_hex(folder / f"{index}.initial", np.concatenate(beats), config.raster_end.end)
    rates, slowest = scaled_rates(job.rates)
    # What one engine would take for everything, which is more than a chain may.
    work = 20_000 + sum(
        4 * len(part.codewords) + 3 * part.width * part.height + 20 * part.height
        for parts in job.frames
        for part in parts
    )
    description: dict[str, object] = {
        "tables_first": len(writes[0]) if writes else 0,
        "table_frames": len(writes),
        "initial_waits": False,
        "frames": len(job.frames),
        "seed": job.seed,
        "rates": rates,
        "most_cycles": job.most_cycles or int(4 * work / max(slowest, 1 / 256)),
    }
    if job.reset_after is not None:
        description["reset_after"] = job.reset_after
    return description


def _times(path: Path, frames: int, engines: int) -> list[Times]:
    """Read when each frame's parts began and ended."""
    found: dict[tuple[str, int], list[int]] = {}
    for row in path.read_text().splitlines():
        name, engine, cycle = row.split()
        found.setdefault((name, int(engine)), []).append(int(cycle))
    return [
        Times(
            tuple(found["open", engine][frame] for engine in range(engines)),
            tuple(found["close", engine][frame] for engine in range(engines)),
            found["beat", 0][frame],
            found["end", 0][frame],
        )
        for frame in range(frames)
    ]
