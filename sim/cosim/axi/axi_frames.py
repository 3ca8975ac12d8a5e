"""Simulation of a whole frame on the AXI top, through the host's driver."""

from __future__ import annotations

import time

from splatline.contract.frame import Frame
from splatline.contract.raster_beats import from_beats
from splatline.host.device.driver import Engine, EngineError
from splatline.sim.cosim.player.jobs import Outcome
from splatline.sim.cosim.simulator import SimulationError
from splatline.sim.cosim.watch import Progress, share_of
from splatline.sim.cycles.cycles import count_cycles

from .axi_device import SimulatedDevice, build_axi

__all__ = ["simulate_on_buses"]

CYCLES_A_WORD = 64
"""Cycle limit for a code word or a pixel without stalls, far above the real number."""


def simulate_on_buses(
    frame: Frame,
    *,
    stall: float = 0.0,
    seed: int = 1,
    progress: Progress | None = None,
) -> Outcome:
    """Draw one frame with the Verilog of the AXI top, through the driver.

    Parameters
    ----------
    frame
        Frame to draw.
    stall
        Share of the cycles, 0..1 without 1, in which each channel of each bus stalls.
    seed
        Seed of the random stalls.
    progress
        Called with ``build`` and with ``run``, and the share of it that is done: of a run, the
        share of the cycles that the cycle model counts.

    Raises
    ------
    InputError
        If the simulator or cocotbext-axi is not installed.
    SimulationError
        If the simulator fails or the engine breaks a rule of its buses.
    ValueError
        If ``stall`` is out of range.
    """
    if not 0.0 <= stall < 1.0:
        raise ValueError(f"stall must be in 0..1 without 1, not {stall}")
    begin = time.perf_counter()
    built = build_axi(frame.config, progress=share_of(progress, "build"))
    seconds = {"build": time.perf_counter() - begin}
    if progress is not None:
        progress("run", 0.0)
    begin = time.perf_counter()
    most = CYCLES_A_WORD * (len(frame.codewords) + frame.width * frame.height)
    limit = int(most / (1.0 - stall) ** 2)
    counted = 0.0 if progress is None else count_cycles(frame) / (1.0 - stall) ** 2

    def waits(cycles: int) -> None:
        if progress is not None:
            progress("run", min(1.0, cycles / counted))

    with SimulatedDevice(
        frame.config, stall=stall, seed=seed, limit=limit, built=built, waits=waits
    ) as device:
        engine = Engine(device)
        try:
            engine.write_tables(frame.tables, frame.width, frame.height)
            beats = engine.draw_beats(frame.codewords)
            raster = from_beats(beats, frame.width, frame.height, frame.config)
        except (EngineError, ValueError) as error:
            raise SimulationError(str(error)) from error
        cycles = engine.counters()["cycles"]
    seconds["run"] = time.perf_counter() - begin
    return Outcome([raster], beats, cycles, seconds)
