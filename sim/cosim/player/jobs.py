"""What the player plays to an engine or a chain, and what comes out: jobs and their outcomes."""

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
SLOWEST = 1 / 256
"""The least share of the cycles in which the player can be told to be willing."""


@dataclass(frozen=True, kw_only=True)
class Playing(ABC):
    """How frames are played one behind the other, and how the player disturbs them.

    Parameters
    ----------
    initial
        Raster that the first frame starts from, and those without table writes of their own; or
        one, or None, for each frame. Each is offered as soon as the one before it was taken.
    initial_waits
        No: only once the picture before is out, as by a host that draws over its own pictures.
    rates
        Share of the cycles in which each stream is willing, 1/256..1 (1 if not named): code words,
        table writes and the initial raster are offered, the result is taken. Every engine's code
        words come at the same rate, and each at times of its own.
    seed
        Of the random gaps.
    reset_after
        Cycles after which the hardware is reset and the frames are started anew.
    write_tables
        ``every``: all tables before every frame; ``first``: before the first alone, so that no
        frame waits for the one before to leave; ``none``: they are as the job before left them.
    most_cycles
        After so many the job counts as stuck; more than enough if not given.
    """

    initial: Raster | Sequence[Raster | None] | None = None
    initial_waits: bool = False
    rates: dict[str, float] = field(default_factory=dict)
    seed: int = 1
    reset_after: int | None = None
    write_tables: str = "every"
    most_cycles: int | None = None

    @property
    @abstractmethod
    def parts(self) -> Sequence[Sequence[Frame]]:
        """What each engine draws of each frame: shape (frames, engines)."""

    @property
    def frames_with_tables(self) -> int:
        """How many of the frames have table writes, the first ones."""
        written = {"every": len(self.parts), "first": 1, "none": 0}
        if self.write_tables not in written:
            raise ValueError(f"tables are written every, first or none, not {self.write_tables!r}")
        return written[self.write_tables]

    @property
    def starts(self) -> list[Raster | None]:
        """What each frame starts from: the load bit stays as it was written last."""
        frames = len(self.parts)
        if isinstance(self.initial, Sequence):
            if len(self.initial) != frames:
                raise ValueError(f"{len(self.initial)} initial rasters for {frames} frames")
            return list(self.initial)
        own = self.frames_with_tables > 1
        return [None if own and number else self.initial for number in range(frames)]

    def pictures(self) -> list[Raster]:
        """Return what golden makes of each frame."""
        return [
            golden.render_parts(parts, start)
            for parts, start in zip(self.parts, self.starts, strict=True)
        ]

    def scaled_rates(self) -> tuple[dict[str, int], float]:
        """Return the streams' rates as the player takes them, 0..255, and the slowest as it is.

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
        """Return the table writes of each frame that has any; all its parts have its tables."""
        return [
            table_writes(part.tables, part.width, part.height, start is not None, part.config)
            for (part, *_), start in zip(
                self.parts[: self.frames_with_tables], self.starts, strict=False
            )
        ]


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
class Outcome:
    """What the Verilog made of a job.

    Parameters
    ----------
    rasters
        The pictures, one a frame.
    beats
        The stream they came in: shape (n, words of 64 bits), uint64.
    cycles
        From the first code word taken to the last end beat, both included.
    seconds
        Time the simulator took to build and to run, which all jobs of a run share.
    times
        Of each frame, where the player noted them.
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
