"""The cocotb side of the player: controls ``frame_player.v`` inside the simulator.

The environment variable ``SPLATLINE_FOLDER`` names a folder. Its ``jobs.json`` describes the jobs;
the outcomes are written to ``outcomes.json`` beside it. While they are played, ``taken`` holds the
number of code words that were taken. Pictures are compared outside the
simulator, so this module does not need the golden renderer.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, First, RisingEdge

__all__ = ["play_frames"]

PERIOD_NS = 10
"""Clock period."""

TICK = 10_000
"""Cycles between two looks at a job."""


@cocotb.test()
async def play_frames(dut: Any) -> None:
    """Play every job and write its outcome."""
    folder = Path(os.environ["SPLATLINE_FOLDER"])
    jobs = json.loads((folder / "jobs.json").read_text())
    Clock(dut.clk, PERIOD_NS, unit="ns").start()
    dut.start.value = 0
    await reset(dut, jobs[0].get("reset_edges", 2))
    outcomes: list[dict[str, Any]] = []
    for index, job in enumerate(jobs):
        if "reset_after" in job:
            await start(dut, index, job)
            await ClockCycles(dut.clk, job["reset_after"])
            await reset(dut, job.get("reset_edges", 2))
        await start(dut, index, job)
        before = sum(outcome["taken"] for outcome in outcomes)
        outcomes.append(await watch(dut, job, folder / "taken", before))
        (folder / "outcomes.json").write_text(json.dumps(outcomes))
        if not outcomes[-1]["finished"]:
            break


async def reset(dut: Any, edges: int) -> None:
    """Hold the reset for some clock edges."""
    await FallingEdge(dut.clk)
    dut.rst.value = 1
    await ClockCycles(dut.clk, edges)
    await FallingEdge(dut.clk)
    dut.rst.value = 0


async def start(dut: Any, index: int, job: dict[str, Any]) -> None:
    """Set a job's options and start the player, which opens its files."""
    await FallingEdge(dut.clk)
    dut.frame.value = index
    dut.seed.value = job["seed"]
    dut.tables_first.value = job["tables_first"]
    dut.table_frames.value = job["table_frames"]
    dut.initial_waits.value = job["initial_waits"]
    dut.frames.value = job["frames"]
    for stream in ("codeword", "table", "initial", "raster"):
        getattr(dut, f"{stream}_rate").value = job["rates"][stream]
    dut.start.value = 1
    await FallingEdge(dut.clk)
    dut.start.value = 0


async def watch(dut: Any, job: dict[str, Any], taken: Path, before: int) -> dict[str, Any]:
    """Wait for the end of a job, then 20 cycles to catch beats that must not follow.

    ``taken`` is the file of the code words taken, ``before`` those of the jobs before this one.
    """
    tick = min(TICK, job["most_cycles"])
    waited = 0
    while not int(dut.finished.value) and waited < job["most_cycles"]:
        await First(RisingEdge(dut.finished), ClockCycles(dut.clk, tick))
        waited += tick
        taken.write_text(str(before + int(dut.taken.value)))
    await ClockCycles(dut.clk, 20)
    return {
        "finished": bool(int(dut.finished.value)),
        "cycles": int(dut.cycles.value),
        "taken": int(dut.taken.value),
        "stray": int(dut.stray.value),
        "breaches": int(dut.breaches.value),
    }
