"""The fast bench of an AXI top: registers, frames, odd packets, aborts, interrupts, resets."""

import numpy as np

from splatline.contract.config import EngineConfig

from .bus_aborts import aborts, open_frame
from .bus_frames import default_width, frames, kinds, late_counters, narrow
from .bus_packets import any_packets, control_words, odd_packets, odd_rasters
from .bus_registers import in_a_row, interrupts, refused, registers
from .program import SHY, Act

__all__ = ["axi_acts"]

FREE = ({}, {})
STALLED = (
    {
        "aw": 90,
        "w": 120,
        "b": 100,
        "ar": 140,
        "r": 90,
        "codewords": 160,
        "initial": 120,
        "raster": 110,
    },
    {},
)
BURSTS = (
    {"aw": 128, "w": 128, "codewords": 128, "raster": 100, "b": 60},
    {"aw": 5, "w": 7, "codewords": 20, "raster": 40},
)
WAITS = (dict.fromkeys(("b", "r", "raster"), SHY), {})
STALLS = (FREE, STALLED, BURSTS, WAITS)
"""Rates and bursts: none stalls, all do, in bursts, and answers that are taken late."""


def axi_acts(config: EngineConfig, seed: int = 1) -> list[Act]:
    """Return the acts of an AXI top's fast bench; the first begins with a reset."""
    rng = np.random.default_rng(seed)
    acts = [registers(config, rng).act("registers after reset", STALLED, reset_edges=1)]
    acts += [frames(config, rng, model=stalls is FREE).act("frames", stalls) for stalls in STALLS]
    acts += [
        kinds(config, rng).act("frames of every kind", stalls) for stalls in (FREE, BURSTS, WAITS)
    ]
    for stalls in (FREE, WAITS):
        script = late_counters(config, rng, shy=stalls is WAITS)
        acts.append(script.act("late counters", stalls))
    acts.append(registers(config, rng, fresh=False).act("registers"))
    acts += [in_a_row(config, rng).act("accesses in a row", stalls) for stalls in STALLS]
    acts += [refused(config, rng).act("refused accesses", stalls) for stalls in (FREE, STALLED)]
    acts += [odd_packets(config, rng).act("odd packets", stalls) for stalls in STALLS]
    acts += [any_packets(config, rng).act("any packets", stalls) for stalls in STALLS]
    acts.append(control_words(config, rng).act("control words"))
    acts += [odd_rasters(config, rng).act("odd initial rasters", stalls) for stalls in STALLS]
    acts += [open_frame(config, rng).act("an open frame", stalls) for stalls in (FREE, STALLED)]
    acts += [aborts(config, rng).act("aborted frames", stalls) for stalls in (FREE, STALLED)]
    acts += [interrupts(config, rng).act("interrupts", stalls) for stalls in (FREE, STALLED)]
    for number, cut in enumerate((900, 1300, 1700, 2100)):
        edges = int(number > 0)
        script = frames(config, rng, counters=False)
        acts.append(
            script.act("reset", STALLS[number % 4], cut=cut, reset_edges=edges, seed=number)
        )
    for cut in range(40, 48):  # a write lies in each register on its way in one of these cycles
        acts.append(narrow(config).act("reset in a write", cut=cut))
        script = default_width(config, rng)
        acts.append(script.act("width after a reset", reset_edges=1))
    acts.append(registers(config, rng).act("registers after a reset", reset_edges=2))
    acts.append(frames(config, rng, model=True).act("frames after a reset", FREE))
    return acts
