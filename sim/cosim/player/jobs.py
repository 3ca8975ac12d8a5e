"""Jobs of the player, which are frames with options, and their outcomes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.fields import Register
from splatline.contract.frame import Frame, Tables
from splatline.contract.raster import Raster
from splatline.contract.raster_beats import put_field
from splatline.sim import golden

__all__ = ["STREAMS", "Outcome", "Playing", "Times", "table_writes"]

STREAMS = ("codeword", "table", "initial", "raster")
"""The streams of the player."""

SLOWEST = 1 / 256
"""Lowest rate of a stream."""


@dataclass(frozen=True, kw_only=True)
class Playing(ABC):
    """Frames that are played in succession, with initial rasters, stalls and resets.

    Parameters
    ----------
    initial
        Initial raster of the first frame and of the frames without table writes, or a list with a
        raster or None for each frame. An initial raster is offered as soon as the one before it was
        taken.
    initial_waits
        An initial raster is offered only after the picture before has left, as by a host that draws
        over its own pictures.
    rates
        Share of the cycles, 1/256..1, in which a stream may transfer; 1 for a stream that is not
        named. The engines of a chain get code words at the same rate, with independent gaps.
    seed
        Seed of the random gaps.
    reset_after
        Cycles after which the hardware is reset and the frames are started again.
    reset_edges
        Clock edges of that reset, and of the one before the first job.
    write_tables
        ``every``: all tables are written before every frame. ``first``: before the first frame
        alone, so that no frame waits for the one before to leave. ``none``: the tables of the
        previous job stay.
    most_cycles
        Cycles after which the job counts as stuck; by default more than enough.
    """

    initial: Raster | Sequence[Raster | None] | None = None
    initial_waits: bool = False
    rates: dict[str, float] = field(default_factory=dict)
    seed: int = 1
    reset_after: int | None = None
    reset_edges: int = 2
    write_tables: str = "every"
    most_cycles: int | None = None

    @property
    @abstractmethod
    def parts(self) -> Sequence[Sequence[Frame]]:
        """The part of each frame that each engine draws: shape (frames, engines)."""

    @property
    def frames_with_tables(self) -> int:
        """Number of frames that have table writes; they come first."""
        written = {"every": len(self.parts), "first": 1, "none": 0}
        if self.write_tables not in written:
            raise ValueError(f"tables are written every, first or none, not {self.write_tables!r}")
        return written[self.write_tables]

    @property
    def starts(self) -> list[Raster | None]:
        """The initial raster of each frame, or None.

        A frame without table writes keeps the load bit of the frame before.
        """
        frames = len(self.parts)
        if isinstance(self.initial, Sequence):
            if len(self.initial) != frames:
                raise ValueError(f"{len(self.initial)} initial rasters for {frames} frames")
            return list(self.initial)
        own = self.frames_with_tables > 1
        return [None if own and number else self.initial for number in range(frames)]

    def pictures(self) -> list[Raster]:
        """Return the golden renderer's picture of each frame."""
        return [
            golden.render_parts(parts, start)
            for parts, start in zip(self.parts, self.starts, strict=True)
        ]

    def scaled_rates(self) -> tuple[dict[str, int], float]:
        """Return the streams' rates as the player's inputs, 0..255, and the lowest rate, 0..1.

        Raises
        ------
        ValueError
            If there is no such stream, or a rate is out of range.
        """
        unknown = set(self.rates) - set(STREAMS)
        if unknown:
            raise ValueError(f"no streams named {sorted(unknown)}; there are {STREAMS}")
        every = {name: self.rates.get(name, 1.0) for name in STREAMS}
        for name, rate in every.items():
            if not SLOWEST <= rate <= 1.0:
                raise ValueError(f"the rate of {name} must be 1/256 to 1, not {rate}")
        return {name: max(0, round(256 * rate) - 1) for name, rate in every.items()}, min(
            every.values()
        )

    def table_writes(self) -> list[npt.NDArray[np.uint64]]:
        """Return the table writes of each frame that has any, from its first part."""
        return [
            table_writes(part.tables, part.width, part.height, start is not None, part.config)
            for (part, *_), start in zip(
                self.parts[: self.frames_with_tables], self.starts, strict=False
            )
        ]


@dataclass(frozen=True)
class Times:
    """Times of a frame's events, in cycles from the start of its job.

    Parameters
    ----------
    opened, closed
        Times of the first code word and of the end word of each engine.
    first_beat, end_beat
        Times of the raster's first beat and end beat; equal if nothing was drawn.
    """

    opened: tuple[int, ...]
    closed: tuple[int, ...]
    first_beat: int
    end_beat: int


@dataclass(frozen=True)
class Outcome:
    """The outcome of a job in the Verilog.

    Parameters
    ----------
    rasters
        The picture of each frame.
    beats
        The raster beats of all frames: shape (n, limbs of 64 bits), uint64.
    cycles
        Cycles from the first code word taken to the last end beat, both included.
    seconds
        Seconds to build and to run the simulator, for all jobs of the run together.
    times
        Times of each frame's events, if the player recorded them.
    """

    rasters: list[Raster]
    beats: npt.NDArray[np.uint64]
    cycles: int
    seconds: dict[str, float]
    times: Sequence[Times] = ()

    @property
    def raster(self) -> Raster:
        """The first frame's picture."""
        return self.rasters[0]


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
