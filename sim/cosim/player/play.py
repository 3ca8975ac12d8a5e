"""Runs of jobs on a build of ``frame_player.v``, and the files that it exchanges with Python."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.contract.raster import Raster
from splatline.contract.raster_beats import from_beats, to_beats
from splatline.sim.cosim import simulator
from splatline.sim.cosim.simulator import Build, SimulationError
from splatline.sim.cosim.watch import Progress, share_of, watched

from .hex_words import read_hex, write_hex
from .jobs import Outcome, Playing, Times

__all__ = ["play_jobs"]


def play_jobs(
    jobs: Sequence[Playing],
    build: Callable[[EngineConfig, int, Callable[[float], None] | None], Build],
    progress: Progress | None = None,
) -> list[Outcome]:
    """Play jobs one after the other, in one run of the simulator.

    Parameters
    ----------
    jobs
        At least one; all of one configuration and number of engines.
    build
        Function that returns the player's build for a configuration and a number of engines. It
        tells its third argument the share that is done.
    progress
        Called with ``build`` and with ``run``, and the share of it that is done: of a run, the
        share of the code words that were taken.

    Raises
    ------
    SimulationError
        If the simulator fails, a frame does not end, or a port breaks the stream rules.
    ValueError
        If the jobs are not of one configuration and number of engines.
    """
    shapes = {(part.config, len(parts)) for job in jobs for parts in job.parts for part in parts}
    if len(shapes) != 1:
        raise ValueError("the jobs of one run share a configuration and a number of engines")
    config, engines = shapes.pop()
    begin = time.perf_counter()
    built = build(config, engines, share_of(progress, "build"))
    seconds = {"build": time.perf_counter() - begin}
    tell = share_of(progress, "run")
    if tell is not None:
        tell(0.0)
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        described = [_write(folder, index, job, config) for index, job in enumerate(jobs)]
        (folder / "jobs.json").write_text(json.dumps(described))
        begin = time.perf_counter()
        with watched(_share(folder / "taken", jobs), tell):
            simulator.run(
                built,
                f"{__package__}.frame_bench",
                checks=False,
                plusargs=[f"+folder={folder}"],
                environment={"SPLATLINE_FOLDER": str(folder)},
            )
        seconds["run"] = time.perf_counter() - begin
        reports = json.loads((folder / "outcomes.json").read_text())
        reports += [None] * (len(jobs) - len(reports))
        return [
            _read(folder, index, job, config, report, seconds)
            for index, (job, report) in enumerate(zip(jobs, reports, strict=True))
        ]


def _share(taken: Path, jobs: Sequence[Playing]) -> Callable[[], float]:
    """Return a function for the share of some jobs' code words that were taken, by a file."""
    # The player counts cycles in which any engine takes a word.
    total = sum(max(len(part.codewords) for part in parts) for job in jobs for parts in job.parts)
    return lambda: int(taken.read_text()) / total


def _write(folder: Path, index: int, job: Playing, config: EngineConfig) -> dict[str, Any]:
    """Write the files that the player reads for a job; return the job's entry in ``jobs.json``."""
    for engine, parts in enumerate(zip(*job.parts, strict=True)):
        words = np.concatenate([part.codewords for part in parts])
        limbs = words.reshape(len(words), -1)
        write_hex(folder / f"{index}.codewords_{engine:02}", limbs, parts[0].config.codeword_bits)
    writes = job.table_writes()
    if writes:
        write_hex(folder / f"{index}.tables", np.concatenate(writes), config.table_address.end)
    beats = [to_beats(start) for start in job.starts if start is not None]
    if beats:
        write_hex(folder / f"{index}.initial", np.concatenate(beats), config.raster_end.end)
    rates, slowest = job.scaled_rates()
    # A rough upper bound of the cycles: those of all code words, and of a load and a flush of every
    # pixel. The limit below is four times this bound. A chain gets the bound of a single engine
    # that draws everything.
    work = 20_000 + sum(
        4 * len(part.codewords) + 3 * part.width * part.height + 20 * part.height
        for parts in job.parts
        for part in parts
    )
    reset = {} if job.reset_after is None else {"reset_after": job.reset_after}
    return {
        "tables_first": len(writes[0]) if writes else 0,
        "table_frames": len(writes),
        "initial_waits": job.initial_waits,
        "frames": len(job.parts),
        "seed": job.seed,
        "rates": rates,
        "reset_edges": job.reset_edges,
        "most_cycles": job.most_cycles or int(4 * work / slowest),
        **reset,
    }


def _read(
    folder: Path,
    index: int,
    job: Playing,
    config: EngineConfig,
    report: dict[str, int] | None,
    seconds: dict[str, float],
) -> Outcome:
    """Return a job's outcome; raise if a frame did not end or a port broke the stream rules."""
    if report is None or not report["finished"]:
        raise SimulationError(f"frame {index} did not end")
    if report["breaches"]:
        raise SimulationError(f"frame {index}: {report['breaches']} breaches of the stream rules")
    if report["stray"]:
        raise SimulationError(f"frame {index}: beats outside the frame in {report['stray']} cycles")
    beats = read_hex(folder / f"{index}.raster", config.raster_end.end)
    rasters = _pictures(index, beats, [part for part, *_ in job.parts])
    times = _times(folder / f"{index}.events", job.parts)
    return Outcome(rasters, beats, report["cycles"], seconds, times)


def _pictures(index: int, beats: npt.NDArray[np.uint64], frames: Sequence[Frame]) -> list[Raster]:
    """Return the pictures of a job's frames; raise if the beats do not fit the frames."""
    limb, shift = divmod(frames[0].config.raster_end.lsb, 64)
    ends = np.flatnonzero(beats[:, limb] >> np.uint64(shift) & np.uint64(1)) + 1
    parts = np.split(beats, ends[:-1])
    if len(parts) != len(frames):
        raise SimulationError(f"job {index}: {len(parts)} end beats for {len(frames)} frames")
    try:
        return [
            from_beats(part, frame.width, frame.height, frame.config)
            for part, frame in zip(parts, frames, strict=True)
        ]
    except ValueError as error:
        raise SimulationError(f"job {index}: {error}") from error


def _times(path: Path, parts: Sequence[Sequence[Frame]]) -> list[Times]:
    """Return the times of each frame's events, from the file that the player wrote."""
    found: dict[tuple[str, int], list[int]] = {}
    for row in path.read_text().splitlines():
        name, engine, cycle = row.split()
        found.setdefault((name, int(engine)), []).append(int(cycle))
    return [
        Times(
            tuple(found["open", engine][number] for engine in range(len(frame))),
            tuple(found["close", engine][number] for engine in range(len(frame))),
            found["beat", 0][number],
            found["end", 0][number],
        )
        for number, frame in enumerate(parts)
    ]
