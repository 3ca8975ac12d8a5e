"""Whole frames through the generated Verilog: code words in, rasters and cycle counts out."""

from __future__ import annotations

import json
import math
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ...host.frame import Frame, Tables
from ...rtl.format import EngineConfig, Register
from ..beats import from_beats, put_field, to_beats
from ..raster import Raster
from . import simulator
from .player import wrap
from .simulator import Build, SimulationError

__all__ = [
    "STREAMS",
    "Job",
    "Outcome",
    "build_engine",
    "check_report",
    "frames_with_tables",
    "pictures",
    "play",
    "read_hex",
    "scaled_rates",
    "simulate_frame",
    "starts",
    "table_writes",
    "write_hex",
]

STREAMS = ("codeword", "table", "initial", "raster")


@dataclass(frozen=True, kw_only=True)
class Job:
    """A frame to play, those right behind it, and how to disturb them.

    Parameters
    ----------
    frame
        Code words, tables and size.
    initial
        Raster that the first frame starts from, and those without table writes of their own; or
        one, or None, for each frame. Each is offered as soon as the one before it was taken.
    initial_waits
        No: only once the picture before is out, as by a host that draws over its own pictures.
    rates
        Share of the cycles in which each stream is willing, 1/256..1 (1 if not named): code words,
        table writes and the initial raster are offered, the result is taken.
    seed
        Of the random gaps.
    reset_after
        Cycles after which the engine is reset and the frame started anew.
    write_tables
        ``every``: all tables before every frame; ``first``: before the first alone, so that no
        frame waits for the one before to leave; ``none``: they are as the job before left them.
    followed_by
        Frames whose table writes and code words are offered right behind, while those before are
        still being drawn.
    """

    frame: Frame
    initial: Raster | Sequence[Raster | None] | None = None
    initial_waits: bool = False
    rates: dict[str, float] = field(default_factory=dict)
    seed: int = 1
    reset_after: int | None = None
    write_tables: str = "every"
    followed_by: Sequence[Frame] = ()

    @property
    def frames(self) -> list[Frame]:
        """The frames of the job."""
        return [self.frame, *self.followed_by]

    @property
    def starts(self) -> list[Raster | None]:
        """What each frame starts from."""
        return starts(self.initial, len(self.frames), self.write_tables)


@dataclass(frozen=True)
class Outcome:
    """What the Verilog made of a job.

    Parameters
    ----------
    rasters
        The pictures, one a frame.
    beats
        The stream it came in: shape (n, words of 64 bits), uint64.
    cycles
        From the first code word taken to the end beat, both included.
    seconds
        Time the simulator took to build and to run, which all jobs of a run share.
    """

    rasters: list[Raster]
    beats: npt.NDArray[np.uint64]
    cycles: int
    seconds: dict[str, float]

    @property
    def raster(self) -> Raster:
        """The first frame's picture."""
        return self.rasters[0]


def simulate_frame(
    frame: Frame, *, initial: Raster | None = None, stall: float = 0.0, seed: int = 1
) -> Outcome:
    """Draw one frame with the generated Verilog of its configuration.

    Parameters
    ----------
    frame
        What to draw.
    initial
        Raster to start from.
    stall
        Share of the cycles, 0..1, in which each port is held back at random.
    seed
        Of the random stalls.

    Raises
    ------
    SimulationError
        If the simulator fails or the engine breaks a rule of its contract.
    """
    rates = dict.fromkeys(STREAMS, 1.0 - stall)
    return play([Job(frame=frame, initial=initial, rates=rates, seed=seed)])[0]


def build_engine(config: EngineConfig, simulator_name: str = "verilator") -> Build:
    """Build the player around the engine's Verilog, or find it built."""
    from ...rtl.verilog import generate

    return wrap(generate(config)[0], config, simulator_name=simulator_name)


def play(
    jobs: Sequence[Job], *, simulator_name: str = "verilator", built: Build | None = None
) -> list[Outcome]:
    """Play frames one after the other, in one run of the simulator.

    Parameters
    ----------
    jobs
        At least one; all of one configuration.
    simulator_name
        One of ``simulator.SIMULATORS``.
    built
        A build of ``frame_player`` to use instead of the configuration's own, such as a broken one.

    Raises
    ------
    SimulationError
        If the simulator fails, a frame does not end, or a port breaks the stream rules.
    """
    configs = {job.frame.config for job in jobs}
    if len(configs) != 1:
        raise ValueError(f"the jobs of one run share a configuration; there are {len(configs)}")
    config = configs.pop()
    begin = time.perf_counter()
    if built is None:
        built = build_engine(config, simulator_name)
    seconds = {"build": time.perf_counter() - begin}
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        for index, job in enumerate(jobs):
            _write_job(folder, index, job)
        (folder / "jobs.json").write_text(json.dumps([_describe(job) for job in jobs]))
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
            rasters = pictures(index, beats, job.frames)
            outcomes.append(Outcome(rasters, beats, reports[index]["cycles"], seconds))
    return outcomes


def table_writes(
    tables: Tables, width: int, height: int, load: bool, config: EngineConfig
) -> npt.NDArray[np.uint64]:
    """Return the table writes of a frame: shape (n, limbs), uint64, lowest limb first."""
    materials = len(tables.diffuse)
    registers = {
        Register.AMBIENT_RED: int(tables.ambient[0]),
        Register.AMBIENT_GREEN: int(tables.ambient[1]),
        Register.AMBIENT_BLUE: int(tables.ambient[2]),
        Register.LAST_COLUMN: width - 1,
        Register.LAST_LINE: height - 1,
        Register.CONTROL: int(load) << Register.CONTROL_LOAD,
    }
    writes = np.zeros((materials + len(registers), -(-config.table_address.end // 64)), np.uint64)
    for kind, table in enumerate((tables.diffuse, tables.specular)):
        for channel in range(3):
            put_field(writes[:materials], config.coefficient(kind, channel), table[:, channel])
    put_field(writes[materials:], config.table_data, np.array(list(registers.values())))
    addresses = [config.register_base + offset for offset in registers]
    put_field(writes, config.table_address, np.array([*range(materials), *addresses]))
    return writes


def write_hex(path: Path, words: npt.NDArray[np.uint64], bits: int) -> None:
    """Write words of any width, one a line; ``words`` has shape (n, limbs), lowest limb first."""
    digits = math.ceil(bits / 4)
    data = np.ascontiguousarray(words[:, ::-1]).astype(">u8").tobytes().hex()
    row = 16 * words.shape[1]
    text = np.frombuffer(data.encode(), np.uint8).reshape(-1, row)[:, row - digits :]
    lines = np.full((len(text), digits + 1), ord("\n"), np.uint8)
    lines[:, :-1] = text
    path.write_bytes(lines.tobytes())


def read_hex(path: Path, bits: int) -> npt.NDArray[np.uint64]:
    """Read what a simulator wrote with ``%h``, one word of ``bits`` bits a line."""
    digits = math.ceil(bits / 4)
    limbs = math.ceil(bits / 64)
    text = np.frombuffer(path.read_bytes(), np.uint8)
    if len(text) % (digits + 1):
        raise SimulationError(f"{path.name}: not whole lines of {digits} digits")
    lines = np.full((len(text) // (digits + 1), 16 * limbs), ord("0"), np.uint8)
    lines[:, 16 * limbs - digits :] = text.reshape(-1, digits + 1)[:, :-1]
    try:
        data = bytes.fromhex(lines.tobytes().decode())
    except ValueError:
        raise SimulationError(f"{path.name}: the Verilog put out undefined bits (x)") from None
    return np.frombuffer(data, ">u8").reshape(-1, limbs)[:, ::-1].astype(np.uint64)


def _write_job(folder: Path, index: int, job: Job) -> None:
    """Write the files that the player reads for a job."""
    config = job.frame.config
    codewords = np.concatenate([frame.codewords for frame in job.frames])
    write_hex(folder / f"{index}.codewords_00", codewords[:, np.newaxis], 64)
    writes = _table_writes(job)
    if writes:
        write_hex(folder / f"{index}.tables", np.concatenate(writes), config.table_address.end)
    beats = [to_beats(start) for start in job.starts if start is not None]
    if beats:
        write_hex(folder / f"{index}.initial", np.concatenate(beats), config.raster_end.end)


def _table_writes(job: Job) -> list[npt.NDArray[np.uint64]]:
    """Return the table writes of each of a job's frames that has any."""
    return [
        table_writes(frame.tables, frame.width, frame.height, start is not None, frame.config)
        for frame, start in zip(
            job.frames[: frames_with_tables(job.write_tables, len(job.frames))],
            job.starts,
            strict=False,
        )
    ]


def frames_with_tables(write_tables: str, frames: int) -> int:
    """Return how many of a job's frames have table writes, the first ones."""
    written = {"every": frames, "first": 1, "none": 0}
    if write_tables not in written:
        raise ValueError(f"tables are written every, first or none, not {write_tables!r}")
    return written[write_tables]


def starts(
    initial: Raster | Sequence[Raster | None] | None, frames: int, write_tables: str
) -> list[Raster | None]:
    """Return what each frame of a job starts from: the load bit stays as it was written last."""
    if isinstance(initial, Sequence):
        if len(initial) != frames:
            raise ValueError(f"{len(initial)} initial rasters for {frames} frames")
        return list(initial)
    own = frames_with_tables(write_tables, frames) > 1
    return [None if own and number else initial for number in range(frames)]


def pictures(index: int, beats: npt.NDArray[np.uint64], frames: Sequence[Frame]) -> list[Raster]:
    """Return the pictures of a job's frames; raise if the beats are not theirs."""
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


def _describe(job: Job) -> dict[str, object]:
    """Return what the bench inside the simulator needs to know of a job."""
    scaled, slowest = scaled_rates(job.rates)
    # A code word takes four cycles at the most, a word of the image five with loading and flush.
    work = 20_000 + sum(
        4 * len(frame.codewords) + 2 * frame.width * frame.height + 20 * frame.height
        for frame in job.frames
    )
    writes = _table_writes(job)
    description: dict[str, object] = {
        "tables_first": len(writes[0]) if writes else 0,
        "table_frames": len(writes),
        "initial_waits": job.initial_waits,
        "frames": len(job.frames),
        "seed": job.seed,
        "rates": scaled,
        "most_cycles": int(4 * work / max(slowest, 1 / 256)),
    }
    if job.reset_after is not None:
        description["reset_after"] = job.reset_after
    return description


def scaled_rates(rates: Mapping[str, float]) -> tuple[dict[str, int], float]:
    """Return the streams' rates as the player takes them, 0..255, and the slowest as it is.

    Raises
    ------
    ValueError
        If there is no such stream, or a rate is 0.
    """
    unknown = set(rates) - set(STREAMS)
    if unknown:
        raise ValueError(f"no streams named {sorted(unknown)}; there are {STREAMS}")
    every = {name: rates.get(name, 1.0) for name in STREAMS}
    slowest = min(every.values())
    if not slowest > 0.0:
        raise ValueError("a rate of 0 would never end")
    return {name: max(0, round(256 * rate) - 1) for name, rate in every.items()}, slowest


def check_report(index: int, report: dict[str, int] | None) -> None:
    """Raise if a frame did not end or a port broke the rules."""
    if report is None or not report["finished"]:
        raise SimulationError(f"frame {index} did not end")
    if report["breaches"]:
        raise SimulationError(f"frame {index}: {report['breaches']} breaches of the stream rules")
    if report["stray"]:
        raise SimulationError(f"frame {index}: beats outside the frame in {report['stray']} cycles")
